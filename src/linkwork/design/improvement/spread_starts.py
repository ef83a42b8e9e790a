"""Where fits begin: numbers around those of a mechanism."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.design.improvement.settings import Improvement
from linkwork.foundation.arrays import Array
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.motion.model import Model

__all__ = ["STARTS", "spread_starts"]

STARTS = 16


def spread_starts(model: Model, numbers: Sequence[VariedNumber], settings: Improvement) -> Array:
    """Numbers (D, P) around those of the mechanism, its own first."""
    x = np.array([float(q.of(model.description)) for q in numbers])
    rng = np.random.default_rng(settings.seed)
    count = settings.starts or STARTS
    # a number of 0 spreads by the size of what it measures
    sizes = np.where(x == 0.0, _sizes(model, numbers, x), x)
    starts = x + settings.spread * sizes * rng.uniform(-1.0, 1.0, (count, len(x)))
    starts[0] = x
    return starts


def _sizes(model: Model, numbers: Sequence[VariedNumber], x: Array) -> Array:
    """Sizes of what numbers (P,) measure: a radian, or the longest link or distance of points."""
    description = model.description
    # of dimensions the kind is not known
    largest = float(np.abs(x[[q.table != "angles" for q in numbers]]).max(initial=0.0))
    size = largest or 1.0
    if isinstance(description, Draft):
        lengths = [float(description.numbers(length)) for length in description.lengths.values()]
        places = [[float(description.numbers(c)) for c in p] for p in description.points.values()]
        spans = np.ptp(places, axis=0) if places else np.zeros(2)
        size = max(lengths, default=0.0) or float(spans.max()) or size
    radian = description.angle.from_radians(1.0)
    return np.array([radian if q.table == "angles" else size for q in numbers])
