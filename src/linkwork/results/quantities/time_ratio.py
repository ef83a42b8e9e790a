"""The time ratio of a quick return: how much longer the slow stroke takes than the quick one.

The input makes one turn at constant speed. The extremes of the quantity are zeros of its
derivative, found on the cubic through values and derivatives at the rows. The ratio is NaN for a
motion that is not one whole turn or does not return, and for a constant quantity.

References
----------
R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, section 3.4.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.quantities.definition import MotionQuantity, MotionRows, cubic

__all__ = ["TIME_RATIO"]

_HALVINGS = 52


def _ratio(rows: MotionRows, _: tuple[float, ...]) -> Array:
    up = rows.ascending()
    if up is None or not up.turn or len(up.input) < 3:
        return np.full(rows.value.shape[:-1], np.nan)
    # argmax takes NaN for the largest value; such motions are left out below
    filled = np.where(np.isfinite(up.value), up.value, 0.0)
    highest = _turning(up, filled.argmax(axis=-1), 1.0)
    lowest = _turning(up, filled.argmin(axis=-1), -1.0)
    part = np.mod(highest - lowest, up.turn)
    ratio = np.maximum(part, up.turn - part) / np.minimum(part, up.turn - part)  # eq. (63)
    found: Array = np.where(up.cycle & up.moves, ratio, np.nan)
    return found


def _turning(rows: MotionRows, row: Array, side: float) -> Array:
    """The input at the extreme next to a row (…,), where the derivative is zero."""
    last = len(rows.input) - 1  # the same position as row 0

    def at(values: Array, index: Array) -> Array:
        return np.take_along_axis(values, np.mod(index, last)[..., None], axis=-1)[..., 0]

    row = np.asarray(row)
    begin = np.where(side * at(rows.first, row) > 0.0, row, row - 1)
    step = np.diff(rows.input)[np.mod(begin, last)]
    low, high = np.zeros(row.shape), np.ones(row.shape)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        ends = at(rows.first, begin), at(rows.first, begin + 1)
        slopes = step * at(rows.second, begin), step * at(rows.second, begin + 1)
        ahead = side * cubic(middle, ends, slopes) > 0.0
        low, high = np.where(ahead, middle, low), np.where(ahead, high, middle)
    found: Array = rows.input[np.mod(begin, last)] + step * high
    return found


TIME_RATIO = (
    MotionQuantity(
        word="time_ratio",
        about="time of the slow stroke over that of the quick one",
        evaluate=_ratio,
        needs=2,
        measures="number",
    ),
)
