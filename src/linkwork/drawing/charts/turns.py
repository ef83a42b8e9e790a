"""Angles reduced to one turn: lines leave at one edge of the panel and continue at the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from linkwork.drawing.charts.chart import Axis
from linkwork.drawing.charts.scales import angle_ends
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.arrays import Array

__all__ = ["ROUNDING", "Window", "origin", "rounded", "turn_axis"]

#: In turns: tolerance of whole turns.
ROUNDING = 1e-9

_ORIGINS = (0.0, -0.5, -0.25, -0.75)  # in turns: possible starts of the turn shown


def rounded(values: Array, turn: float) -> Array:
    """Values (K,) rounded to quarter turns if very near, so that rounding does not break a line."""
    if not turn:
        return values
    quarter = turn / 4
    whole = np.round(values / quarter) * quarter
    return np.where(np.abs(values - whole) < ROUNDING * turn, whole, values)


def origin(lines: Sequence[Array], turn: float) -> float:
    """The start of the turn that cuts the fewest lines of angles; 0 if no other cuts fewer.

    Among equal ones, that with the fewest positions on its edges.
    """
    if not turn:
        return 0.0
    return turn * min(
        _ORIGINS, key=lambda low: _cuts([np.round(line / turn - low, 9) for line in lines])
    )


def _cuts(lines: Sequence[Array]) -> tuple[int, int]:
    """Numbers of crossings of whole turns by lines of angles [turns], and of positions there."""
    ends = [(np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:])) for y in lines]
    passed = sum(int(np.maximum(np.ceil(b) - np.floor(a) - 1, 0).sum()) for a, b in ends)
    return passed, sum(int((y == np.round(y)).sum()) for y in lines)


def turn_axis(axis: Axis, lines: Sequence[Array], low: float, unit: AngleUnit) -> Axis:
    """The axis over the turn from ``low``, or less if all angles lie within half of it."""
    turn = unit.turn
    values = np.concatenate(lines)
    if np.nanmax(values) - np.nanmin(values) <= turn / 2:
        ends, step = angle_ends(values, unit)
        return replace(axis, ends=ends, step=step)
    return replace(axis, ends=(low, low + turn), step=turn / 4)


@dataclass(frozen=True, kw_only=True)
class Window:
    """The shown turn of both coordinates, 0 for one that is not an angle; y begins at ``low``."""

    x_turn: float
    y_turn: float
    low: float

    def folded(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Both coordinates inside the turn; the line continues at the other side of the panel."""
        x_turn, y_turn = self.x_turn, self.y_turn
        y = rounded(y - self.low, y_turn)
        cuts = [(x[0], y[0])] if len(x) else []
        for k in range(len(x) - 1):
            places = {1.0}
            for here, there, turn in ((x[k], x[k + 1], x_turn), (y[k], y[k + 1], y_turn)):
                if turn:
                    low, high = sorted((here / turn, there / turn))
                    edges = np.arange(np.floor(low) + 1.0, np.ceil(high))
                    places |= {float((e * turn - here) / (there - here)) for e in edges}
            cuts += [
                (x[k] + s * (x[k + 1] - x[k]), y[k] + s * (y[k + 1] - y[k])) for s in sorted(places)
            ]
        pieces: list[tuple[float, float]] = []
        last: tuple[float, float] | None = None
        for (x0, y0), (x1, y1) in pairwise(cuts):
            shift_x = x_turn * np.floor(0.5 * (x0 + x1) / x_turn) if x_turn else 0.0
            shift_y = y_turn * np.floor(0.5 * (y0 + y1) / y_turn) if y_turn else 0.0
            start = (float(x0 - shift_x), float(y0 - shift_y))
            if last is None or max(abs(start[0] - last[0]), abs(start[1] - last[1])) > 1e-9:
                pieces += [(np.nan, np.nan), start] if last is not None else [start]
            last = (float(x1 - shift_x), float(y1 - shift_y))
            pieces.append(last)
        line = np.array(pieces).reshape(-1, 2)
        return line[:, 0], line[:, 1] + self.low

    def places(self, x: float, y: float) -> list[tuple[float, float]]:
        """The positions of a point in the panel: whole turns are at both edges."""
        return [
            (at_x, at_y + self.low)
            for at_x in _edges(x, self.x_turn)
            for at_y in _edges(y - self.low, self.y_turn)
        ]

    def tolerance(self, line: Array) -> Array:
        """The distance below which a point equals a point of a line (K, 2) up to rounding."""
        reach = np.array([self.x_turn, self.y_turn])
        size = np.maximum(1.0, np.nanmax(np.abs(line), 0))
        near: Array = ROUNDING * np.where(reach > 0.0, reach, size)
        return near

    def shown_on(self, line: Array, x: float, y: float) -> list[tuple[float, float]]:
        """The positions of a point that are points of a folded line (K, 2)."""
        near = self.tolerance(line)
        places = self.places(x, y)
        return [place for place in places if (np.abs(line - place) < near).all(axis=1).any()]


def _edges(value: float, turn: float) -> tuple[float, ...]:
    """The positions of a value inside one turn: a whole turn is at both edges."""
    if not turn:
        return (value,)
    folded = float(np.mod(rounded(np.array(value), turn), turn))
    return (folded,) if folded else (0.0, turn)
