"""The time ratio of a quick return: how much longer the slow stroke takes than the quick one.

The input makes one turn at constant speed. The extremes of the quantity are zeros of its
derivative, found on the cubic through its values and slopes at the rows next to them; a motion
adds rows there, a family has those of its table. Where the quantity rests at an extreme, the stroke
before it ends where the longest rest begins, and the stroke behind it begins where the rest ends: a
rest is part of neither. A motion divides the steps in which a rest ends until its end is known, a
family takes the rows. The ratio is NaN for a motion that is not one whole turn or does not return,
and for a constant quantity.

References
----------
R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, section 3.4.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.rounding import EQUAL_ROWS, REST
from linkwork.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    Places,
    RowSlopes,
    cubic_weight_slopes,
    cubic_weights,
)
from linkwork.results.quantities.extreme_places import (
    NOWHERE,
    extreme_places,
    joined_places,
    roots_of_cubics,
)

__all__ = ["TIME_RATIO"]

_Extremes = tuple[tuple[Array, Array, Array], ...]

_SHORT = 1e-4  # of the turn: a rest that is shorter is an extreme
_KNOWN = 1e-11  # of the turn: the step in which a rest ends
_SIXTEENTHS = np.arange(1, 16) / 16.0


def _ratio(rows: MotionRows, _: tuple[float, ...]) -> Array:
    up = rows.ascending()
    if up is None or not up.turn or len(up.input) < 3:
        return np.full(rows.value.shape[:-1], np.nan)
    rise, fall = _strokes(up, _extremes(up))
    ratio = np.maximum(rise, fall) / np.minimum(rise, fall)  # eq. (63)
    found: Array = np.where(up.cycle & up.moves, ratio, np.nan)
    return found


def _strokes(rows: MotionRows, extremes: _Extremes) -> tuple[Array, Array]:
    """The parts of the turn from the smallest value to the largest one, and back."""
    (up, down), (out, back) = (
        _between(rows, _rest(rows, side), *extreme)
        for side, extreme in zip((1.0, -1.0), extremes, strict=True)
    )
    return np.mod(up - back, rows.turn), np.mod(out - down, rows.turn)


def _between(
    rows: MotionRows,
    rest: tuple[BoolArray, IndexArray, IndexArray],
    at: Array,
    step: Array,
    part: Array,
) -> tuple[Array, Array]:
    """Where the quantity comes to an extreme, and where it leaves it, (…,)."""
    begin, end = (rows.input[np.mod(row, len(rows.input) - 1)] for row in rest[1:])
    long = rest[0] & (np.mod(end - begin, rows.turn) > _SHORT * rows.turn)
    alone = rows.input[at] + step * part
    return np.where(long, begin, alone), np.where(long, end, alone)


def _rest(rows: MotionRows, side: float) -> tuple[BoolArray, IndexArray, IndexArray]:
    """Whether the quantity rests at its largest value, with side -1 the smallest, and the first and
    the last row of the longest rest. Rows are counted on over the ends of the turn, (…,).
    """
    value = side * np.where(np.isfinite(rows.value), rows.value, -np.inf * side)[..., :-1]
    last = value.shape[-1]
    best, least = value.max(axis=-1, keepdims=True), np.fmin.reduce(value, axis=-1, keepdims=True)
    still: BoolArray = value >= best - EQUAL_ROWS * (best - least)
    for rate in (rows.first[..., :-1], rows.second[..., :-1]):
        still = still & (np.abs(rate) <= REST * np.fmax.reduce(np.abs(rate), -1, keepdims=True))
    twice = np.concatenate([still, still], axis=-1)
    here = np.arange(2 * last)
    begin = 1 + np.maximum.accumulate(np.where(twice, -1, here), axis=-1)
    u = np.abs(rows.input[:-1] - rows.input[0])
    u = np.append(u, u + rows.turn)
    long = np.where(twice, u - u[np.minimum(begin, 2 * last - 1)], -1.0)
    final = np.asarray(long.argmax(axis=-1))
    first = np.take_along_axis(begin, final[..., None], axis=-1)[..., 0]
    return np.asarray(still.any(axis=-1)), first, final


def _slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    """The derivatives of eq. (63): the extremes move as zeros of the derivative do."""
    up, count = rows.ascending(), rows.value.shape[-1]
    value, first, second = np.zeros(count), np.zeros(count), np.zeros(count)
    if up is None or not up.turn or len(up.input) < 3 or not (up.cycle & up.moves):
        return RowSlopes(value=np.full(count, np.nan))
    extremes = _extremes(up)
    rise, fall = _strokes(up, extremes)
    if not (rise and fall and np.isfinite(rise)) or abs(rise + fall - up.turn) > _SHORT * up.turn:
        return RowSlopes(value=np.full(count, np.nan))  # the end of a rest is no zero of q'
    # of two equal strokes either may be the slow one after a change
    by_part = np.nan if rise == fall else (
        up.turn / fall**2 if rise > fall else -up.turn / rise**2)  # fmt: skip
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
    step, last = np.abs(np.diff(rows.input)), len(rows.input) - 1
    if rows.joined is None or not rows.turn or not rows.cycle:
        return NOWHERE
    found = [extreme_places(rows, side) for side in (1.0, -1.0)]
    for side in (1.0, -1.0):
        rests, first, final = _rest(rows, side)
        ends = np.unique(np.mod([int(first) - 1, int(final)], last))
        ends = ends[rows.joined[ends] & (step[ends] > _KNOWN * rows.turn)]
        if rests:
            found.append((np.repeat(ends, 15), np.tile(_SIXTEENTHS, len(ends))))
    return joined_places(*found)


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
