"""All four-bars through precision points, and through points and poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.core.foundation.loading import loader

if TYPE_CHECKING:
    from linkwork.synthesis.precision.four_bar_positions import FourBarPositions as FourBarPositions
    from linkwork.synthesis.precision.given_lengths import (
        four_bars_with_lengths as four_bars_with_lengths,
        solved_member as solved_member,
    )
    from linkwork.synthesis.precision.positions import (
        GivenLength as GivenLength,
        PrecisionPositions as PrecisionPositions,
    )
    from linkwork.synthesis.precision.sampling import (
        positions_with_samples as positions_with_samples,
    )
    from linkwork.synthesis.precision.solving import (
        PrecisionFourBars as PrecisionFourBars,
        four_bars_through as four_bars_through,
    )
else:
    __getattr__ = loader(__name__)
