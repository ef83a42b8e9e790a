"""All four-bars through precision points, and through points and poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.synthesis.precision.positions import (
        GivenLength as GivenLength,
        PrecisionPositions as PrecisionPositions,
    )
    from linkwork.synthesis.precision.solving import four_bars_through as four_bars_through
else:
    __getattr__ = loader(__name__)
