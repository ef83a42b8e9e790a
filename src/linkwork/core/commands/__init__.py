"""The commands of the core, and what all commands share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.commands.files import (
        examples_command as examples_command,
        new_command as new_command,
        schema_command as schema_command,
    )
    from linkwork.core.commands.solve import (
        check_command as check_command,
        equations_command as equations_command,
        quantities_command as quantities_command,
        solve_command as solve_command,
    )
    from linkwork.core.commands.sweep import (
        draw_command as draw_command,
        sweep_command as sweep_command,
    )
else:
    __getattr__ = loader(__name__)
