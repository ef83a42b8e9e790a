"""The smallest and largest value of a quantity over a motion, and its mean over the rows."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    EQUAL_ROWS,
    REST,
    AnyArray,
    Array,
    BoolArray,
    IndexArray,
)
from linkwork.core.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    Places,
    RowSlopes,
    at_extreme,
    cubic,
    cubic_weight_slopes,
    cubic_weights,
)
from linkwork.core.results.quantities.rows import (
    NOWHERE,
    extreme_places,
    joined_places,
    roots_of_cubics,
)

#: Factors of extremes by their sides: 1 for the largest value, -1 for the smallest.
_Factors = Mapping[float, float]


def _sum_of_extremes(factors: _Factors, rows: MotionRows, _: tuple[float, ...]) -> Array:
    parts = (
        factor * (np.fmax if side > 0.0 else np.fmin).reduce(rows.value, axis=-1)
        for side, factor in factors.items()
    )
    return np.asarray(sum(parts))


def _slopes_of_extremes(factors: _Factors, rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    parts = (factor * at_extreme(rows, side) for side, factor in factors.items())
    return RowSlopes(value=np.asarray(sum(parts)))


def _places_of_extremes(factors: _Factors, rows: MotionRows, _: tuple[float, ...]) -> Places:
    return joined_places(*(extreme_places(rows, side) for side in factors))


def _extremes(word: str, about: str, factors: _Factors) -> MotionQuantity:
    return MotionQuantity(
        word=word,
        about=about,
        evaluate=partial(_sum_of_extremes, factors),
        slopes=partial(_slopes_of_extremes, factors),
        places=partial(_places_of_extremes, factors),
        sides=tuple(factors),
    )


def _mean(rows: MotionRows, _: tuple[float, ...]) -> Array:
    there = ~np.isnan(rows.value)
    with np.errstate(invalid="ignore"):
        mean: Array = np.where(there, rows.value, 0.0).sum(axis=-1) / there.sum(axis=-1)
    return mean


def _mean_slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    there = ~np.isnan(rows.value)
    return RowSlopes(value=there / max(int(there.sum()), 1))


EXTREMES = (
    _extremes("min", "smallest value", {-1.0: 1.0}),
    _extremes("max", "largest value", {1.0: 1.0}),
    MotionQuantity(
        word="mean",
        about="mean of the values at the rows found",
        evaluate=_mean,
        slopes=_mean_slopes,
    ),
)

STROKE = (_extremes("stroke", "largest less smallest value", {1.0: 1.0, -1.0: -1.0}),)


# ----------------------------------------------------------------------
# The time ratio of a quick return: how much longer the slow stroke takes than the quick one.
#
# The input makes one turn at constant speed. The extremes of the quantity are zeros of its
# derivative, found on the cubic through its values and slopes at the rows next to them; a motion
# adds rows there, a family has those of its table. Where the quantity rests at an extreme, the
# stroke before it ends where the longest rest begins, and the stroke behind it begins where the
# rest ends:
# a rest is part of neither. A motion divides the steps in which a rest ends until its end is known,
# a family takes the rows. The ratio is NaN for a motion that is not one whole turn or does not
# return, and for a constant quantity.
#
# References
# ----------
# R. L. Norton, Design of Machinery, 6th ed., McGraw-Hill 2020, section 3.4.


_Extremes = tuple[tuple[Array, Array, Array], ...]

_SHORT = 1e-4  # of the turn: a rest that is shorter is an extreme
_KNOWN = 1e-11  # of the turn: the step in which a rest ends
_SIXTEENTHS = np.arange(1, 16) / 16.0


def _ratio(rows: MotionRows, _: tuple[float, ...]) -> Array:
    up = rows.ascending()
    if up is None or not up.turn or len(up.input) < 3:
        return np.full(rows.value.shape[:-1], np.nan)
    rise, fall = _strokes(up, _turnings(up))
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


def _time_ratio_slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    """The derivatives of eq. (63): the extremes move as zeros of the derivative do."""
    up, count = rows.ascending(), rows.value.shape[-1]
    value, first, second = np.zeros(count), np.zeros(count), np.zeros(count)
    if up is None or not up.turn or len(up.input) < 3 or not (up.cycle & up.moves):
        return RowSlopes(value=np.full(count, np.nan))
    extremes = _turnings(up)
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


def _turnings(rows: MotionRows) -> _Extremes:
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


def _time_ratio_places(rows: MotionRows, _: tuple[float, ...]) -> Places:
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
        slopes=_time_ratio_slopes,
        needs=2,
        measures="number",
        places=_time_ratio_places,
    ),
)


# ----------------------------------------------------------------------
# The length of the path of a point over a motion.
#
# L = ∫ |F'| du, by Gauss' rule with five points between neighbouring rows, where F is the quintic
# through places and both derivatives there. A motion adds rows until its steps are short enough.
# Where a derivative is missing, as at a dead point, the chord is used; a missing row adds nothing.


_POINTS = 5  # of Gauss' rule
_EXACT = 1e-13  # of the length
_ORDERS = 7.0 / 5.0  # of the error of a step by the quintic, to that by the cubic of the derivative
_ROUNDING = 64.0  # of places, in the length of a step
_AT_ONCE = 48  # steps that are halved, the worst ones: next to dead points there are more and more


def _length(rows: MotionRows, _: tuple[float, ...]) -> Array:
    chord = np.abs(np.diff(rows.value, axis=-1))
    total = _parts(rows)[0]
    parts = np.where(np.isfinite(total), total, chord)
    found: Array = np.where(np.isfinite(chord).any(axis=-1), np.nansum(parts, axis=-1), np.nan)
    return found


def _ends(rows: MotionRows) -> tuple[AnyArray, ...]:
    """Rise, slopes and bends at both ends of steps, by the part of a step, (…, R - 1) each."""
    step = np.diff(rows.input)
    first, second = step * rows.first[..., :-1], step * rows.first[..., 1:]
    bends = step**2 * rows.second[..., :-1], step**2 * rows.second[..., 1:]
    return (np.diff(rows.value, axis=-1), first, second, *bends)


def _weights(s: float) -> tuple[float, ...]:
    """What :func:`_ends` add to the derivative of the quintic at a part of a step, eq. (20)."""
    return (
        30.0 * s**2 * (1.0 - s) ** 2,
        1.0 + s**2 * (-18.0 + s * (32.0 - 15.0 * s)),
        s**2 * (-12.0 + s * (28.0 - 15.0 * s)),
        s * (1.0 + s * (-4.5 + s * (6.0 - 2.5 * s))),
        s**2 * (1.5 + s * (-4.0 + 2.5 * s)),
    )


def _gauss(points: int = _POINTS) -> Any:
    places, weights = np.polynomial.legendre.leggauss(points)
    return zip(0.5 * (1.0 + places), 0.5 * weights, strict=True)


def _parts(rows: MotionRows) -> tuple[Array, Array]:
    """The lengths of steps, and how far those by a point less and the cubic of F' are."""
    # eq. (62), by Gauss points in each step
    ends = _ends(rows)
    total, other = np.zeros(ends[0].shape), np.zeros(ends[0].shape)
    for s, weight in _gauss():
        total += weight * np.abs(sum(w * x for w, x in zip(_weights(s), ends, strict=True)))
    for s, weight in _gauss(_POINTS - 1):
        other += weight * np.abs(cubic(s, (ends[1], ends[2]), (ends[3], ends[4])))
    return total, np.abs(total - other)


def _path_length_slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    """Derivatives of the length, row by row."""
    step, ends = np.diff(rows.input), _ends(rows)
    value, first, second = (np.zeros(len(rows.value), dtype=complex) for _ in range(3))
    smooth = np.isfinite(sum(ends))
    for s, weight in _gauss():
        weights = _weights(s)
        rate = sum(w * x for w, x in zip(weights, ends, strict=True))
        unit = weight * np.where(smooth, rate / np.abs(rate), 0.0)
        value[1:] += weights[0] * unit
        value[:-1] -= weights[0] * unit
        for shift in (0, 1):
            at = slice(shift, len(first) - 1 + shift)
            first[at] += weights[1 + shift] * step * unit
            second[at] += weights[3 + shift] * step**2 * unit
    chord = np.diff(rows.value)
    away = np.where(smooth | np.isnan(chord), 0.0, chord / np.abs(chord))
    value[1:] += away
    value[:-1] -= away
    return RowSlopes(value=value, first=first, second=second)


def _path_length_places(rows: MotionRows, _: tuple[float, ...]) -> Places:
    """The middles of steps that are too long, and places close to dead points."""
    if rows.joined is None:
        return NOWHERE
    part, missed = _parts(rows)
    chord = np.abs(np.diff(rows.value))
    whole = np.nansum(chord)
    with np.errstate(all="ignore"):
        # where the path turns back neither rule is of its order
        back = (rows.first[:-1] * rows.first[1:].conj()).real <= 0.0
        error = np.where(back, part, part * (missed / part) ** _ORDERS)
        rounding = _ROUNDING * EPSILON * np.nanmax(np.abs(rows.value))
        inexact = (error * len(part) > _EXACT * whole) & (back | (missed > rounding))
        worst = np.where(rows.joined & inexact, error, 0.0)
        long = np.argsort(-worst, kind="stable")[: min(_AT_ONCE, np.count_nonzero(worst))]
        near = rows.joined & ~np.isfinite(part) & (chord > _SHORT * whole)
    row = np.flatnonzero(near)
    # the end without rates is the dead point
    ahead = np.where(np.isfinite(rows.first[row]), 0.875, 0.125)
    return joined_places((long, np.full(len(long), 0.5)), (row, ahead))


PATH_LENGTH = (
    MotionQuantity(
        word="path_length",
        about="length of the point's path",
        evaluate=_length,
        of_point=True,
        needs=2,
        slopes=_path_length_slopes,
        places=_path_length_places,
    ),
)
