"""The time ratio of a quick return: how much longer the slow stroke takes than the quick one.

The input makes one turn at constant speed. The extremes of the quantity are zeros of its
derivative, found on the cubic through its values and slopes at the rows next to them; a motion
adds rows there, a family has those of its table. The ratio is NaN for a
motion that is not one whole turn or does not return, and for a constant quantity.

References
----------
R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, section 3.4.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    Places,
    RowSlopes,
    cubic_weight_slopes,
    cubic_weights,
)
from linkwork.results.quantities.extreme_places import (
    extreme_places,
    joined_places,
    roots_of_cubics,
)

__all__ = ["TIME_RATIO"]

_Extremes = tuple[tuple[Array, Array, Array], ...]


def _ratio(rows: MotionRows, _: tuple[float, ...]) -> Array:
    up = rows.ascending()
    if up is None or not up.turn or len(up.input) < 3:
        return np.full(rows.value.shape[:-1], np.nan)
    slow, quick = _strokes(up, _extremes(up))
    ratio = np.maximum(slow, quick) / np.minimum(slow, quick)  # eq. (63)
    found: Array = np.where(up.cycle & up.moves, ratio, np.nan)
    return found


def _strokes(rows: MotionRows, extremes: _Extremes) -> tuple[Array, Array]:
    """The parts of the turn from the smallest value to the largest one, and back."""
    highest, lowest = (rows.input[at] + step * part for at, step, part in extremes)
    part = np.mod(highest - lowest, rows.turn)
    return part, rows.turn - part


def _slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    """The derivatives of eq. (63): the extremes move as zeros of the derivative do."""
    up, count = rows.ascending(), rows.value.shape[-1]
    value, first, second = np.zeros(count), np.zeros(count), np.zeros(count)
    if up is None or not up.turn or len(up.input) < 3 or not (up.cycle & up.moves):
        return RowSlopes(value=np.full(count, np.nan))
    extremes = _extremes(up)
    slow, quick = _strokes(up, extremes)
    if not (slow and quick and np.isfinite(slow)):
        return RowSlopes(value=np.full(count, np.nan))
    # of two equal strokes either may be the slow one after a change
    by_part = np.nan if slow == quick else (
        up.turn / quick**2 if slow > quick else -up.turn / slow**2)  # fmt: skip
    for side, (at, step, part) in zip((1.0, -1.0), extremes, strict=True):
        pair = [int(at), (int(at) + 1) % (count - 1)]
        ends, bends = cubic_weights(float(part))
        # eq. (127): du = -dq'/q'', on the cubic of q' whose slope is that of its weights
        steps = cubic_weight_slopes(float(part))
        bend = sum(
            ends_by * up.first[k] + bends_by * step * up.second[k]
            for k, ends_by, bends_by in zip(pair, *steps, strict=True)
        )
        for k, end, slope in zip(pair, ends, bends, strict=True):
            first[k] -= side * by_part * step * end / bend
            second[k] -= side * by_part * step * slope * step / bend
    return RowSlopes(value=value, first=first, second=second).in_order_of(rows)


def _extremes(rows: MotionRows) -> _Extremes:
    """Row, step and part of the step of the largest and the smallest value, (…,) each."""
    # argmax takes NaN for the largest value; such motions are left out
    filled = np.where(np.isfinite(rows.value), rows.value, 0.0)
    highest = _turning(rows, filled.argmax(axis=-1), 1.0)
    return highest, _turning(rows, filled.argmin(axis=-1), -1.0)


def _turning(rows: MotionRows, row: Array, side: float) -> tuple[Array, Array, Array]:
    """The extreme next to a row (…,), where the derivative is zero: row, step, part of the step."""
    last = len(rows.input) - 1  # the same position as row 0

    def at(values: Array, index: Array) -> Array:
        return np.take_along_axis(values, np.mod(index, last)[..., None], axis=-1)[..., 0]

    row = np.asarray(row)
    begin = np.where(side * at(rows.first, row) > 0.0, row, row - 1)
    step = np.diff(rows.input)[np.mod(begin, last)]
    ends = at(rows.first, begin), at(rows.first, begin + 1)
    slopes = step * at(rows.second, begin), step * at(rows.second, begin + 1)
    first, second = ((side * begin, side * end) for begin, end in (ends, slopes))
    part = roots_of_cubics(first, second, np.zeros(row.shape), np.ones(row.shape))
    return np.mod(begin, last), step, part


def _places(rows: MotionRows, _: tuple[float, ...]) -> Places:
    return joined_places(extreme_places(rows, 1.0), extreme_places(rows, -1.0))


TIME_RATIO = (
    MotionQuantity(
        word="time_ratio",
        about="time of the slow stroke over that of the quick one",
        evaluate=_ratio,
        slopes=_slopes,
        needs=2,
        measures="number",
        places=_places,
    ),
)
