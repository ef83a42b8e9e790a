"""The cubics between the rows of motions, by eighths of the distances between rows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, EQUAL_ROWS, Array, BoolArray, IndexArray
from linkwork.core.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    Places,
    RowSlopes,
    cubic,
    cubic_weight_slopes,
    cubic_weights,
)
from linkwork.core.results.quantities.rows import NOWHERE, joined_places

PARTS = 8  # of the distance between rows
_HALVINGS = 52
_NEWTONS = 3

_Weights = tuple[tuple[Any, Any], tuple[Any, Any]]


@dataclass(frozen=True, eq=False)
class CubicCurve:
    """The cubics of D motions with R rows of increasing input."""

    rows: MotionRows

    @cached_property
    def _flat(self) -> tuple[Array, Array]:
        """Values and derivatives, (D, R) each."""
        count = len(self.rows.input)
        value: Array = self.rows.value.reshape(-1, count)
        first: Array = self.rows.first.reshape(-1, count)
        if self.rows.joined is None or np.isfinite(first).any():
            return value, first
        first = np.asarray(np.gradient(value, self.rows.input, axis=1))
        return value, first

    @cached_property
    def _cubics(self) -> tuple[Array, Array, Array, Array]:
        """Values and slopes at both ends of every step, (D, R - 1) each."""
        (value, first), step = self._flat, np.diff(self.rows.input)
        ends = value[:, :-1], value[:, 1:]
        slopes = (step * x for x in (first[:, :-1], first[:, 1:]))
        begin, end = (np.where(np.isfinite(x), x, ends[1] - ends[0]) for x in slopes)
        return *ends, begin, end

    @cached_property
    def cycle(self) -> BoolArray:
        """Which motions return after one turn, (D,)."""
        return np.broadcast_to(self.rows.cycle, self.rows.value.shape[:-1]).reshape(-1)

    @cached_property
    def steps(self) -> int:
        """R - 1."""
        return len(self.rows.input) - 1

    @cached_property
    def eighths(self) -> tuple[Array, Array]:
        """Inputs (F,) and values (D, F) at parts of the distances between rows."""
        s, (value, _) = np.arange(PARTS) / PARTS, self._flat
        a, b, c, d = (x[..., None] for x in self._cubics)
        inner = cubic(s, (a, b), (c, d))
        inner[..., 0] = value[:, :-1]
        step = np.diff(self.rows.input)
        places = (self.rows.input[:-1, None] + s * step[:, None]).reshape(-1)
        fine = inner.reshape(len(value), -1)
        u = np.append(places, self.rows.input[-1])
        return u, np.concatenate([fine, value[:, -1:]], axis=1)

    @property
    def missed(self) -> Array:
        """What the cubics of the only motion may miss, by the second derivatives, (R - 1,)."""
        (a, b, c, d), first = (x[0] for x in self._cubics), self._flat[1][0]
        second, step = self.rows.second, np.diff(self.rows.input)
        if not np.isfinite(second).any():
            second = np.gradient(first, self.rows.input)
        bends = 6.0 * (b - a) - 4.0 * c - 2.0 * d, 6.0 * (a - b) + 2.0 * c + 4.0 * d
        ends = second[:-1], second[1:]
        miss = sum(abs(step**2 * x - bend) for x, bend in zip(ends, bends, strict=True)) / 16.0
        found: Array = np.where(np.isfinite(miss), miss, abs(b - a) / 4.0)
        return found

    def piece(self, place: Array) -> tuple[IndexArray, Array, Array]:
        """The step between rows in which a place lies, the part of it, and the turns before."""
        turns = np.maximum(np.ceil(place / (PARTS * self.steps)) - 1.0, 0.0)
        part = place / PARTS - turns * self.steps
        piece = np.minimum(part.astype(np.intp), self.steps - 1)
        return piece, part - piece, turns

    def _weighted(self, place: Array, weights: Callable[[Array], _Weights]) -> Array:
        piece, s, _ = self.piece(place)
        (p, q), (r, t) = weights(s)
        own = np.arange(len(piece)).reshape(-1, *[1] * (piece.ndim - 1))
        a, b, c, d = (x[own, piece] for x in self._cubics)
        found: Array = p * a + q * b + r * c + t * d
        return found

    def value(self, place: Array) -> Array:
        """The quantity at places, (D, …)."""
        return self._weighted(place, cubic_weights)

    def slope(self, place: Array) -> Array:
        """Its derivative by the input, (D,)."""
        found: Array = self._weighted(place, cubic_weight_slopes)
        return found / np.diff(self.rows.input)[self.piece(place)[0]]

    def input(self, place: Array) -> Array:
        """The input at a place; after a turn it goes on, (D,)."""
        piece, s, turns = self.piece(place)
        u = self.rows.input
        found: Array = u[piece] + s * (u[piece + 1] - u[piece]) + turns * (u[-1] - u[0])
        return found

    def place(self, at: Array) -> Array:
        """The place of an input, (D,)."""
        u = self.rows.input
        turns = np.maximum(np.ceil((at - u[0]) / (u[-1] - u[0])) - 1.0, 0.0)
        at = at - turns * (u[-1] - u[0])
        row = np.clip(u.searchsorted(at) - 1, 0, self.steps - 1)
        found: Array = row + (at - u[row]) / (u[row + 1] - u[row]) + turns * self.steps
        return PARTS * found

    def crossing(self, number: Array, level: Array, way: Array) -> Array:
        """Where the quantity passes a level upwards, or with way -1 downwards."""
        return _halved(number, lambda place: way * (self.value(place) - level) < 0.0)

    def extreme(self, number: Array, side: float, inner: BoolArray) -> Array:
        """The extreme next to the largest eighth, or it itself at an end of the range."""
        rises = side * self.slope(number) > 0.0
        near = np.where(rises, number, np.maximum(number - 1.0, 0.0))
        found = _halved(near, lambda place: side * self.slope(place) > 0.0)
        return np.where(inner, found, number)

    def slid(
        self,
        eighths: tuple[Array, Array],
        band: float,
        way: Array,
        limits: tuple[Array, Array],
    ) -> tuple[Array, Array]:
        """Begin and end of ranges that rise, or with way -1 fall, by the band from the one to the
        other, about eighths, where they are longest and no extreme between leaves them.
        """
        last, u = self.input(eighths[1]), self.rows.input
        most = u[-1] + np.where(self.cycle, u[-1] - u[0], 0.0)
        low, high = (self.input(eighths[0] + side) for side in (-1.0, 1.0))
        near, end = 2.0 * (high - low) + abs(self.input(eighths[1] - 1.0) - last), last
        top = way * self.value(self.place(most))
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            place = self.place(middle)
            level = way * self.value(place)
            for _ in range(_NEWTONS):  # from the last end: it changes half as much every time
                there = self.place(end)
                ahead = (level + band - way * self.value(there)) / (way * self.slope(there))
                end = np.clip(
                    end + np.nan_to_num(ahead), last - near, np.minimum(last + near, most)
                )
            flatter = way * self.slope(place) > way * self.slope(self.place(end))
            right = (level + band < limits[1]) | (
                (level <= limits[0]) & flatter & (level + band < top)
            )
            low, high = np.where(right, middle, low), np.where(right, high, middle)
        found = self.place(high)
        # at the end of the table Newton's steps may stay before it
        closed = (end > last - near) & (way * self.value(found) + band >= top - EQUAL_ROWS * band)
        return found, self.place(np.where(closed & (most <= last + near), most, end))

    def weights(self, place: Array, factor: float) -> tuple[Array, Array]:
        """A factor times the derivatives of the only motion's value by its rows, (R,) each."""
        value, first = np.zeros((2, self.steps + 1))
        pieces, parts, _ = self.piece(place)
        row, s = int(pieces[0]), float(parts[0])
        step = self.rows.input[row + 1] - self.rows.input[row]
        for k, end, slope in zip((row, row + 1), *cubic_weights(s), strict=True):
            value[k] += factor * end
            if np.isfinite(self.rows.first[k]):
                first[k] += factor * slope * step
            else:  # the chord takes the place of a slope that does not exist
                value[row + 1] += factor * slope
                value[row] -= factor * slope
        return value, first


def _halved(low: Array, before: Callable[[Array], BoolArray]) -> Array:
    """Where something that holds from a place on ends within an eighth."""
    high: Array = low + 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        ahead = before(middle)
        low, high = np.where(ahead, middle, low), np.where(ahead, high, middle)
    return high


# ----------------------------------------------------------------------
# Dwells: ranges of the input over which a quantity stays within a band.
#
# The dwell is the longest range of the input over which the quantity stays within a band of the
# given height, wherever this band lies; of ranges equally long, the first one. Between rows the
# quantity is the cubic through values and derivatives at the rows. Eighths of their distance show
# which ranges may be the longest; their ends, and the extremes from which the band is measured, are
# those of the cubic. A range over which the quantity rises or falls may slide along it: it is
# longest where it begins and ends equally steep. A motion of one whole turn continues from its end
# at its start. A motion adds rows where cubics are no guide, and at the ends and extremes of all
# ranges that may be the longest, until these stay where they are.


_RIVALS = 8  # ranges that may be the longest
_RIVAL = 0.03  # of the longest range: so much shorter ones are located, too
_BESIDE = 1e-3  # of its length: a range that begins so near to another is the same one
_WIDER = 1.03  # bands: what they hold shows extremes that only just leave the band, or do not
_POOR = 1e-2  # of the band, or of the change over a step: cubics that miss so much are no guide
_MOST_PARTS = 32  # of a step of which the cubic is no guide


@dataclass(frozen=True, kw_only=True, eq=False)
class _End:
    """An end of a range, the extreme a band away from it, and whether the end follows from it:
    between rows it moves, at a row it touches.

    Places are numbers of eighths of D motions.
    """

    at: Array
    extreme: Array
    moves: BoolArray
    touches: BoolArray

    def or_else(self, holds: BoolArray, other: _End) -> _End:
        """This end where something holds, else the other."""
        return _End(**{k: np.where(holds, own, vars(other)[k]) for k, own in vars(self).items()})


def _longest(rows: MotionRows, numbers: tuple[float, ...]) -> Array:
    """How long it is, in the unit of the input in files."""
    begin, end = _range(rows, numbers[0])
    found: Array = (end - begin) / rows.unit
    return found


def _start(rows: MotionRows, numbers: tuple[float, ...]) -> Array:
    """Where it begins, in the unit of the input in files."""
    return _range(rows, numbers[0])[0] / rows.unit


def _range(rows: MotionRows, band: float) -> tuple[Array, Array]:
    """Between which inputs the quantity stays within the band for longest, (…,) each."""
    shape = rows.value.shape[:-1]
    up = rows.ascending()
    if up is None or len(up.input) < 2:
        return np.full(shape, np.nan), np.full(shape, np.nan)
    curve = CubicCurve(up)
    begin, end = (curve.input(each.at) for each in _ends(curve, band))
    full = end - begin >= up.input[-1] - up.input[0]
    begin, end = np.where(full, up.input[0], begin), np.where(full, up.input[-1], end)
    lost = np.isnan(curve.eighths[1]).all(axis=1)
    begin, end = (np.where(lost, np.nan, x).reshape(shape) for x in (begin, end))
    return begin, end


def _longest_slopes(rows: MotionRows, numbers: tuple[float, ...]) -> RowSlopes:
    return _range_slopes(rows, numbers[0], (-1.0, 1.0))


def _start_slopes(rows: MotionRows, numbers: tuple[float, ...]) -> RowSlopes:
    return _range_slopes(rows, numbers[0], (1.0, 0.0))


def _range_slopes(rows: MotionRows, band: float, factors: tuple[float, float]) -> RowSlopes:
    """The derivatives of a sum of begin and end by the rows: ends move as the crossings that they
    are.
    """
    count, up = len(rows.input), rows.ascending()
    begin, end = _range(rows, band)
    if up is None or not np.isfinite(begin):
        return RowSlopes(value=np.full(count, np.nan))
    value, first = np.zeros((2, count))
    if end - begin >= up.input[-1] - up.input[0]:
        return RowSlopes(value=value)
    curve = CubicCurve(up)
    for own, factor in zip(_ends(curve, band), factors, strict=True):
        if not (own.moves[0] or own.touches[0]) or factor == 0.0:
            continue  # the table ends there
        if own.at[0] == own.extreme[0] and sum(factors):
            # where a range that slides begins depends on derivatives of a higher order
            return RowSlopes(value=np.full(count, np.nan))
        rate = float(curve.slope(own.at)[0])
        # eq. (128)
        for place, sign in ((own.extreme, 1.0), (own.at, -1.0)):
            by_value, by_first = curve.weights(place, sign * factor / (rate * rows.unit))
            value, first = value + by_value, first + by_first
    return RowSlopes(value=value, first=first).in_order_of(rows)


def _places(rows: MotionRows, numbers: tuple[float, ...]) -> Places:
    """Where cubics are no guide; else where ranges that may be the longest begin and end, and the
    extremes that they are measured from.
    """
    up, band = rows.ascending(), numbers[0]
    if up is None or up.joined is None or not np.isfinite(up.value).any():
        return NOWHERE
    with np.errstate(all="ignore"):
        row, part = _wanted(CubicCurve(up), up.joined, band)
    there = up.joined[row]
    row, part = row[there], part[there]
    steps = len(up.input) - 1
    return (row, part) if up.input[0] == rows.input[0] else (steps - 1 - row, 1.0 - part)


def _wanted(curve: CubicCurve, joined: BoolArray, band: float) -> Places:
    step, missed = np.diff(curve.rows.input), curve.missed
    span, f = np.ptp(curve.rows.input), curve.eighths[1][0]
    rounding = 64.0 * EPSILON * np.nanmax(np.abs(f))
    allowed = np.full(len(step), _POOR * band + rounding)
    poor = (missed > allowed) & (step > EQUAL_ROWS * span)
    poor &= joined
    found = NOWHERE
    if not poor.any():
        rivals = [x for height in (band, _WIDER * band) for x in _rivals(curve, height, _RIVAL)]
        ends = [end for pair in rivals for end in pair if end.moves[0]]
        if ends:
            places = np.concatenate([x for end in ends for x in (end.at, end.extreme)])
            found = curve.piece(places)[:2]
        change = np.ptp(np.append(f[:-1].reshape(-1, PARTS), f[PARTS::PARTS, None], 1), axis=1)
        poor[found[0]] = (missed > _POOR * change + rounding)[found[0]]
        allowed[:] = rounding
    more = np.clip(np.ceil(2.0 * (missed / allowed) ** 0.25), 2, _MOST_PARTS)
    parts = np.where(poor, more, 1).astype(np.intp)
    split = np.repeat(np.arange(len(step)), parts - 1)
    first = np.repeat(np.cumsum(parts - 1) - (parts - 1), parts - 1)
    return joined_places(found, (split, (np.arange(len(split)) - first + 1) / parts[split]))


def _rivals(curve: CubicCurve, band: float, shorter: float) -> Iterator[tuple[_End, _End]]:
    """The ends of ranges that may be the longest, those of the longest by eighths first.

    ``shorter``: up to which part of the longest range they may seem to be shorter.
    """
    u, f = curve.eighths
    cycle, once = curve.cycle, len(u)
    if cycle.any():
        # a dwell may go on across the end of the turn
        u = np.concatenate([u, u[1:] + u[-1] - u[0]])
        again = np.where(cycle[:, None], f[:, 1:], np.nan)
        f = np.concatenate([f, again], axis=1)
    count, width = _counts(curve, u, f, band)
    # places of the second turn only serve ranges that begin in the first
    width[:, once:] = -1.0
    width[cycle, 0] = -1.0  # the same place as a turn later, where what is before it is known
    best = first = width.argmax(axis=1)
    every, most = np.arange(len(f)), width.max(axis=1)
    peak = np.ones(width.shape, dtype=bool)
    peak[:, 1:] &= width[:, 1:] >= width[:, :-1]
    peak[:, :-1] &= width[:, :-1] >= width[:, 1:]
    width[~peak] = -1.0
    # the eighths before and after a range are not counted
    least = most - np.maximum(shorter * most, 2.0 * np.diff(u).max())
    for _ in range(_RIVALS):
        yield _ends_from(curve, band, f, best, count[every, best])
        near = _BESIDE * width[every, best]
        width[abs(u - u[best][:, None]) <= near[:, None]] = -1.0
        best = width.argmax(axis=1)
        rival = width[every, best] >= np.maximum(least, 0.0)
        if not rival.any():
            break
        best = np.where(rival, best, first)


def _counts(curve: CubicCurve, u: Array, f: Array, band: float) -> tuple[IndexArray, Array]:
    """How many values from each one on stay within a band, and over which range of the input the
    cubics do, (D, F): by doubling, then by halving.
    """
    highs, lows = [f], [f]
    while 2 ** len(highs) <= f.shape[1]:
        half = 2 ** (len(highs) - 1)
        highs.append(np.maximum(highs[-1][:, :-half], highs[-1][:, half:]))
        lows.append(np.minimum(lows[-1][:, :-half], lows[-1][:, half:]))
    here = np.arange(f.shape[1])
    count = np.ones(f.shape, dtype=np.intp)
    high, low = f, f
    for k in reversed(range(len(highs))):
        ahead = here + count
        inside = ahead < highs[k].shape[1]
        ahead = np.where(inside, ahead, 0)
        more_high = np.maximum(high, np.take_along_axis(highs[k], ahead, axis=1))
        more_low = np.minimum(low, np.take_along_axis(lows[k], ahead, axis=1))
        longer = inside & (more_high - more_low <= band)
        count = np.where(longer, count + 2**k, count)
        high, low = np.where(longer, more_high, high), np.where(longer, more_low, low)
    count = np.minimum(count, len(curve.eighths[0]))
    last = here + count - 1
    beside = np.minimum(last + 1, f.shape[1] - 1)
    at, there = (np.take_along_axis(f, k, axis=1) for k in (last, beside))
    with np.errstate(all="ignore"):
        level = np.where(there > at, low + band, high - band)
        on = np.clip(np.nan_to_num((level - at) / (there - at)), 0.0, 1.0)
        on = on + (level - curve.value(last + on)) / (there - at)
    on = np.where(np.isfinite(on) & (count < curve.eighths[1].shape[1]), np.clip(on, 0.0, 1.0), 0.0)
    return count, np.where(np.isnan(f), -1.0, u[last] - u + on * (u[beside] - u[last]))


def _ends(curve: CubicCurve, band: float) -> tuple[_End, _End]:
    """Where the longest range begins and ends."""
    pairs = _rivals(curve, band, 0.0)
    begin, end = next(pairs)
    for other in pairs:
        (a, b), (c, d) = ([curve.input(x.at) for x in pair] for pair in ((begin, end), other))
        equal = EQUAL_ROWS * (b - a)
        first: BoolArray = (d - c > b - a + equal) | ((d - c >= b - a - equal) & (c < a))
        begin, end = other[0].or_else(first, begin), other[1].or_else(first, end)
    return begin, end


def _ends_from(
    curve: CubicCurve, band: float, f: Array, start: IndexArray, count: IndexArray
) -> tuple[_End, _End]:
    """Where a range about so many eighths begins and ends: where the quantity leaves the band."""
    rows, last = np.arange(len(f)), start + count - 1
    inner = {side: _inner(curve, f, side, start, last) for side in (1.0, -1.0)}
    extremes: dict[float, tuple[Array, Array]] = {}
    for side, (place, value) in inner.items():
        edge = np.where(side * f[rows, last] > side * f[rows, start], last, start)
        beyond = side * f[rows, edge] > side * value
        extremes[side] = np.where(beyond, edge, place), np.where(beyond, f[rows, edge], value)
    found, outward = [], []
    for last_within, way in ((start, -1), (last, 1)):
        beside = last_within + way
        known = (beside >= 0) & (beside < f.shape[1])
        beside = np.where(known, beside, last_within)
        here, there = f[rows, last_within], f[rows, beside]
        rises: BoolArray = there > here
        (top, high), (bottom, low) = extremes[1.0], extremes[-1.0]
        level: Array = np.clip(
            np.where(rises, low + band, high - band), np.fmin(here, there), np.fmax(here, there)
        )
        # from the smaller number on the values are still, or not yet, within the band
        at = curve.crossing(
            np.minimum(last_within, beside).astype(float), level, np.where(rises, way, -way)
        )
        moves: BoolArray = known & np.isfinite(there) & (here != there) & (level != there)
        # a neighbour just at the level, or none at all, is the end itself
        touches = known & (level == there) & (here != there)
        at = np.where(moves, at, np.where(touches, beside, last_within))
        extreme = np.where(rises, bottom, top)
        found.append(_End(at=at, extreme=extreme, moves=moves, touches=touches))
        outward.append(np.where(rises, 1.0, -1.0))
        # a range that rises or falls all along is measured from this end
        passed: Array = np.where(moves, level, here)
        extremes[1.0] = np.where(high >= passed, top, at), np.fmax(high, passed)
        extremes[-1.0] = np.where(low <= passed, bottom, at), np.fmin(low, passed)
    slides = (outward[0] != outward[1]) & np.all([x.moves | x.touches for x in found], axis=0)
    if not slides.any():
        return found[0], found[1]
    slid = _slid(curve, band, (start.astype(float), last.astype(float)), outward[1], inner)
    return slid[0].or_else(slides, found[0]), slid[1].or_else(slides, found[1])


def _inner(
    curve: CubicCurve, f: Array, side: float, start: IndexArray, last: IndexArray
) -> tuple[Array, Array]:
    """The largest extreme, or with side -1 the smallest, between begin and end, and its value."""
    numbers, rows = np.arange(1, f.shape[1] - 1), np.arange(len(f))
    inside = (numbers > start[:, None]) & (numbers < last[:, None])
    here = side * f[:, 1:-1]
    turns = inside & (here >= side * f[:, :-2]) & (here >= side * f[:, 2:])
    most = np.where(turns, here, -np.inf)
    number = most.argmax(axis=1)
    found = np.isfinite(most[rows, number])
    number += 1
    # a quantity that rests has its extreme everywhere
    rests = np.fmax.reduce(np.where(inside, abs(f[:, 1:-1] - f[rows, number, None]), 0.0), axis=1)
    moves = found & (rests > EQUAL_ROWS * np.abs(f[rows, number]))
    place = curve.extreme(number.astype(float), side, moves)
    value = np.where(moves, curve.value(place), f[rows, number])
    return place, np.where(found, value, -side * np.inf)


def _slid(
    curve: CubicCurve,
    band: float,
    eighths: tuple[Array, Array],
    way: Array,
    inner: dict[float, tuple[Array, Array]],
) -> tuple[_End, _End]:
    """The ends of a range that rises or falls from the one to the other, where it is longest."""
    (top, high), (bottom, low) = inner[1.0], inner[-1.0]
    rises = way > 0.0
    limits = np.where(rises, low, -high), np.where(rises, high, -low)
    begin, end = curve.slid(eighths, band, way, limits)
    level, near = way * curve.value(begin), EQUAL_ROWS * band
    # an extreme between begin and end may hold both, else they hold each other
    held = [abs(level - limits[0]) <= near, abs(level + band - limits[1]) <= near]
    places = [np.where(rises, bottom, top), np.where(rises, top, bottom)]
    last = PARTS * curve.steps * np.where(curve.cycle, 2.0, 1.0)
    # the table ends there
    free = begin > _BESIDE, end < last - _BESIDE
    held, places = [*held, ~free[1]], [*places, end]
    extreme = np.select(held, places, begin)
    return (
        _End(at=begin, extreme=extreme, moves=free[0], touches=np.zeros_like(rises)),
        _End(at=end, extreme=extreme, moves=free[1], touches=np.zeros_like(rises)),
    )


DWELL = (
    MotionQuantity(
        word="dwell",
        about="longest range of input within a band of this height",
        evaluate=_longest,
        slopes=_longest_slopes,
        numbers=("band",),
        needs=1,
        measures="input",
        places=_places,
    ),
    MotionQuantity(
        word="dwell_start",
        about="input at which the longest dwell begins",
        evaluate=_start,
        slopes=_start_slopes,
        numbers=("band",),
        needs=1,
        measures="input",
        places=_places,
    ),
)
