"""The cubics between the rows of motions, by eighths of the distances between rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.rounding import EQUAL_ROWS
from linkwork.results.quantities.definition import (
    MotionRows,
    cubic,
    cubic_weight_slopes,
    cubic_weights,
)

__all__ = ["PARTS", "CubicCurve"]

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
