"""Quantities that can be asked for, one module each; ``registry`` finds them by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.core.results.quantities.registry import (
        MOTION_QUANTITIES as MOTION_QUANTITIES,
        ROW_QUANTITIES as ROW_QUANTITIES,
        row_quantity as row_quantity,
    )
else:  # one position needs none of them
    __getattr__ = loader(__name__)
