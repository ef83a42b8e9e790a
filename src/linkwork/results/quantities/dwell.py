"""Dwells: ranges of the input over which a quantity stays within a band.

The dwell is the longest range of the input over which the quantity stays within a band of the
given height, wherever this band lies. Between rows the quantity is the cubic through values and
derivatives at the rows. Eighths of their distance decide which range is the longest; its ends, and
the extreme from which the band is measured, are those of the cubic. A motion of one whole turn
continues from its end at its start. A motion adds rows at the ends and at the extreme until they
stay where they are.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.rounding import EQUAL_ROWS
from linkwork.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    Places,
    RowSlopes,
    cubic,
    cubic_weight_slopes,
    cubic_weights,
)
from linkwork.results.quantities.extreme_places import NOWHERE

__all__ = ["DWELL"]

_PARTS = 8  # of the distance between rows
_HALVINGS = 52

_Weights = tuple[tuple[Any, Any], tuple[Any, Any]]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Place:
    """A place between neighbouring eighths of D motions: its number, and the part from there on."""

    number: IndexArray
    part: Array | float = 0.0

    def or_else(self, holds: BoolArray, other: _Place) -> _Place:
        """This place where something holds, else the other."""
        return _Place(
            number=np.where(holds, self.number, other.number),
            part=np.where(holds, self.part, other.part),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _End:
    """An end of a range, the extreme a band away from it, and whether the end follows from it:
    between rows it moves, at a row it touches.
    """

    at: _Place
    extreme: _Place
    moves: BoolArray
    touches: BoolArray


@dataclass(frozen=True, eq=False)
class _Curve:
    """The cubics of D motions with R rows of increasing input."""

    rows: MotionRows

    @cached_property
    def _flat(self) -> tuple[Array, Array]:
        """Values and derivatives, (D, R) each."""
        count = len(self.rows.input)
        return self.rows.value.reshape(-1, count), self.rows.first.reshape(-1, count)

    @cached_property
    def _cubics(self) -> tuple[Array, Array, Array, Array]:
        """Values and slopes at both ends of every step, (D, R - 1) each."""
        (value, first), step = self._flat, np.diff(self.rows.input)
        ends = value[:, :-1], value[:, 1:]
        slopes = (step * x for x in (first[:, :-1], first[:, 1:]))
        begin, end = (np.where(np.isfinite(x), x, ends[1] - ends[0]) for x in slopes)
        return *ends, begin, end

    @cached_property
    def steps(self) -> int:
        """R - 1."""
        return len(self.rows.input) - 1

    @cached_property
    def eighths(self) -> tuple[Array, Array]:
        """Inputs (F,) and values (D, F) at parts of the distances between rows."""
        s, (value, _) = np.arange(_PARTS) / _PARTS, self._flat
        a, b, c, d = (x[..., None] for x in self._cubics)
        inner = cubic(s, (a, b), (c, d))
        inner[..., 0] = value[:, :-1]
        step = np.diff(self.rows.input)
        places = (self.rows.input[:-1, None] + s * step[:, None]).reshape(-1)
        fine = inner.reshape(len(value), -1)
        u = np.append(places, self.rows.input[-1])
        return u, np.concatenate([fine, value[:, -1:]], axis=1)

    def piece(self, place: _Place) -> tuple[IndexArray, Array]:
        """The step between rows in which a place lies, and the part of it."""
        piece, eighth = np.divmod(place.number, _PARTS)
        return piece % self.steps, (eighth + place.part) / _PARTS

    def _weighted(self, place: _Place, weights: Callable[[Array], _Weights]) -> Array:
        piece, s = self.piece(place)
        (p, q), (r, t) = weights(s)
        a, b, c, d = (x[np.arange(len(x)), piece] for x in self._cubics)
        found: Array = p * a + q * b + r * c + t * d
        return found

    def value(self, place: _Place) -> Array:
        """The quantity at a place, (D,)."""
        return self._weighted(place, cubic_weights)

    def slope(self, place: _Place) -> Array:
        """Its derivative by the part of a step, (D,)."""
        return self._weighted(place, cubic_weight_slopes)

    def input(self, place: _Place) -> Array:
        """The input at a place; after a turn it goes on, (D,)."""
        piece, s = self.piece(place)
        u = self.rows.input
        turns = place.number // (_PARTS * self.steps)
        found: Array = u[piece] + s * (u[piece + 1] - u[piece]) + turns * self.rows.turn
        return found

    def halved(self, number: IndexArray, before: Callable[[_Place], BoolArray]) -> _Place:
        """Where something that holds from a place on ends within an eighth."""
        low, high = np.zeros(number.shape), np.ones(number.shape)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            ahead = before(_Place(number=number, part=middle))
            low, high = np.where(ahead, middle, low), np.where(ahead, high, middle)
        return _Place(number=number, part=high)

    def crossing(self, number: IndexArray, level: Array, way: Array) -> _Place:
        """Where the quantity passes a level upwards, or with way -1 downwards."""
        return self.halved(number, lambda place: way * (self.value(place) - level) < 0.0)

    def extreme(self, number: IndexArray, side: float, inner: BoolArray) -> _Place:
        """The extreme next to the largest eighth, or it itself at an end of the range."""
        here = _Place(number=number)
        rises = side * self.slope(here) > 0.0
        near = np.where(rises, number, np.maximum(number - 1, 0))
        found = self.halved(near, lambda place: side * self.slope(place) > 0.0)
        return found.or_else(inner, here)

    def weights(self, place: _Place, factor: float) -> tuple[Array, Array]:
        """A factor times the derivatives of the only motion's value by its rows, (R,) each."""
        value, first = np.zeros((2, self.steps + 1))
        pieces, parts = self.piece(place)
        row, s = int(pieces[0]), float(parts[0])
        step = self.rows.input[row + 1] - self.rows.input[row]
        for k, end, slope in zip((row, row + 1), *cubic_weights(s), strict=True):
            value[k] += factor * end
            if np.isfinite(self._flat[1][0, k]):
                first[k] += factor * slope * step
            else:  # the chord takes the place of a slope that does not exist
                value[row + 1] += factor * slope
                value[row] -= factor * slope
        return value, first


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
    curve = _Curve(up)
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
    curve = _Curve(up)
    for own, factor in zip(_ends(curve, band), factors, strict=True):
        if not (own.moves[0] or own.touches[0]) or factor == 0.0:
            continue  # the table ends there
        row = int(curve.piece(own.at)[0][0])
        rate = float(curve.slope(own.at)[0]) / (up.input[row + 1] - up.input[row])
        # eq. (128)
        for place, sign in ((own.extreme, 1.0), (own.at, -1.0)):
            by_value, by_first = curve.weights(place, sign * factor / (rate * rows.unit))
            value, first = value + by_value, first + by_first
    return RowSlopes(value=value, first=first).in_order_of(rows)


def _places(rows: MotionRows, numbers: tuple[float, ...]) -> Places:
    """Where the longest range begins and ends, and the extremes that it is measured from."""
    up, band = rows.ascending(), numbers[0]
    if up is None or up.joined is None or not np.isfinite(up.value).any():
        return NOWHERE
    curve = _Curve(up)
    found = [place for end in _ends(curve, band) if end.moves[0] for place in (end.at, end.extreme)]
    pairs = [curve.piece(place) for place in found]
    row = np.array([int(piece[0]) for piece, _ in pairs], dtype=np.intp)
    part = np.array([float(s[0]) for _, s in pairs])
    there = up.joined[row]
    row, part = row[there], part[there]
    return (row, part) if up.input[0] == rows.input[0] else (curve.steps - 1 - row, 1.0 - part)


def _longest_eighths(curve: _Curve, band: float) -> tuple[IndexArray, IndexArray, Array]:
    """Where the longest range begins and how many eighths it has, (D,); values with a second turn,
    (D, F).
    """
    up = curve.rows
    u, f = curve.eighths
    cycle = np.broadcast_to(up.cycle, up.value.shape[:-1]).reshape(-1)
    once = len(u)
    if cycle.any():
        # a dwell may go on across the end of the turn
        u = np.concatenate([u, u[1:] + up.turn])
        again = np.where(cycle[:, None], f[:, 1:], np.nan)
        f = np.concatenate([f, again], axis=1)
    count = np.minimum(_counts(f, band), once)
    width = np.where(np.isnan(f), -1.0, u[np.arange(f.shape[1]) + count - 1] - u)
    # places of the second turn only serve ranges that begin in the first
    width[:, once:] = -1.0
    width[cycle, 0] = -1.0  # the same place as a turn later, where what is before it is known
    start = width.argmax(axis=1)
    return start, np.take_along_axis(count, start[:, None], 1)[:, 0], f


def _counts(f: Array, band: float) -> IndexArray:
    """How many values from each one on stay within a band, (D, F): by doubling, then by halving."""
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
    return count


def _ends(curve: _Curve, band: float) -> tuple[_End, _End]:
    """Where the longest range begins and ends: where the quantity leaves the band."""
    start, count, f = _longest_eighths(curve, band)
    rows, last = np.arange(len(f)), start + count - 1
    numbers = np.arange(f.shape[1])
    inside = (numbers >= start[:, None]) & (numbers <= last[:, None])
    extremes: dict[float, tuple[_Place, Array]] = {}
    for side in (1.0, -1.0):
        most = np.where(inside, side * f, -np.inf)
        number = most.argmax(axis=1)
        inner = (number > start) & (number < last)
        # a quantity that rests has its extreme everywhere
        rests = np.ptp(np.where(inside, f, f[rows, start][:, None]), axis=1)
        inner &= rests > EQUAL_ROWS * np.abs(f[rows, start])
        place = curve.extreme(number, side, inner)
        extremes[side] = place, np.where(inner, curve.value(place), f[rows, number])
    found = []
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
        at = curve.crossing(np.minimum(last_within, beside), level, np.where(rises, way, -way))
        moves: BoolArray = known & np.isfinite(there) & (here != there) & (level != there)
        # a neighbour just at the level, or none at all, is the end itself
        touches = known & (level == there) & (here != there)
        at = at.or_else(moves, _Place(number=np.where(touches, beside, last_within)))
        found.append(_End(at=at, extreme=bottom.or_else(rises, top), moves=moves, touches=touches))
        # a range that rises or falls all along is measured from this end
        passed: Array = np.where(moves, level, here)
        extremes[1.0] = top.or_else(np.asarray(high >= passed), at), np.fmax(high, passed)
        extremes[-1.0] = bottom.or_else(np.asarray(low <= passed), at), np.fmin(low, passed)
    return found[0], found[1]


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
