"""Mechanism files of other programs: read as linkages, with a list of omitted parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.readers.assembly import Exported as Exported, LeftOut as LeftOut
    from linkwork.readers.importing import (
        Imported as Imported,
        exported as exported,
        imported as imported,
    )
else:
    __getattr__ = loader(__name__)
