"""All four-bars through precision points, and through points and poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.foundation.lazy import loader

if TYPE_CHECKING:
    from linkwork.design.precision.four_bar_positions import FourBarPositions as FourBarPositions
    from linkwork.design.precision.given_lengths import (
        four_bars_with_lengths as four_bars_with_lengths,
    )
    from linkwork.design.precision.own_start_sets import own_member as own_member
    from linkwork.design.precision.positions import (
        GivenLength as GivenLength,
        PrecisionPositions as PrecisionPositions,
    )
    from linkwork.design.precision.sampling import positions_with_samples as positions_with_samples
    from linkwork.design.precision.solving import (
        PrecisionFourBars as PrecisionFourBars,
        four_bars_through as four_bars_through,
    )
else:
    __getattr__ = loader(__name__)
