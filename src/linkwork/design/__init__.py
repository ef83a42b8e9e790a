"""Questions of designers about a mechanism: which dimension matters, and by how much."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.design.counterweights import (
        balanced as balanced,
        counterweights as counterweights,
    )
    from linkwork.design.machine import (
        flywheel as flywheel,
        harmonics as harmonics,
        inflection_circle as inflection_circle,
        motor_check as motor_check,
    )
    from linkwork.design.sensitivity import (
        is_of_motion as is_of_motion,
        sensitivity_of_motion as sensitivity_of_motion,
        sensitivity_of_position as sensitivity_of_position,
        sensitivity_of_rows as sensitivity_of_rows,
    )
    from linkwork.design.tolerance import (
        deviations as deviations,
        tolerance_of as tolerance_of,
    )
    from linkwork.synthesis.improvement.improving import improved_designs as improved_designs
    from linkwork.synthesis.improvement.settings import (
        Improvement as Improvement,
        read_goal as read_goal,
    )
else:
    __getattr__ = loader(__name__)
