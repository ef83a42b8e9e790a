"""Coupler points of many four-bars and slider-cranks, with derivatives by their dimensions.

Each lane has its own dimensions (P,) and crank angles (N,). The loop A + c e^{iψ} - B closes by a
triangle; its derivatives follow from the loop differentiated once, eq. (153).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from linkwork.core.foundation.arrays import EQUAL_ROWS, Array, ComplexArray, IndexArray
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import find_spelling
from linkwork.core.foundation.units import FULL_TURN, arc_in_order
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.synthesis.improvement.goals import PathGoal
from linkwork.synthesis.improvement.settings import Points
from linkwork.synthesis.lane_least_squares import Box, RowVariables


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopPoints:
    """Moving pivots and the coupler point, (D, N) each; NaN where the loop is open."""

    moving_a: ComplexArray
    moving_b: ComplexArray
    guided: ComplexArray


class CouplerCurves(ABC):
    """One kind of mechanism with a crank at A0; the last two dimensions are P in the coupler.

    Parameters
    ----------
    side : (D,)
        The signs of the loops, 1 or -1.
    """

    #: Dimensions in their order; A0 first.
    names: ClassVar[tuple[str, ...]]
    #: The dimensions that are lengths of links.
    lengths: ClassVar[tuple[int, ...]]

    def __init__(self, side: Array) -> None:
        self.side = side

    def take(self, index: IndexArray) -> Self:
        """Some of the lanes."""
        return type(self)(self.side[index])

    def points(self, x: Array, t: Array) -> LoopPoints:
        """The loop for dimensions (D, P) at crank angles (D, N)."""
        moving, e, _ = self._closed(x, np.exp(1j * t))
        z, c = (x[:, -2] + 1j * x[:, -1])[:, None], x[:, self.lengths[1], None]
        return LoopPoints(moving_a=moving, moving_b=moving + c * e, guided=moving + z * e)

    @np.errstate(all="ignore")  # there are no numbers where the loop is open
    def with_derivatives(
        self, x: Array, t: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """P (D, N), its derivatives by the dimensions (D, N, P) and by the angle (D, N)."""
        u = np.exp(1j * t)
        moving, e, normal = self._closed(x, u)
        a, c = (x[:, k, None] for k in self.lengths[:2])
        z = (x[:, -2] + 1j * x[:, -1])[:, None]
        # eq. (153): the coupler turns so that B stays on its circle or line
        turned = 1j * z * e / (c * (normal.imag * e.real - normal.real * e.imag))
        by_x = np.empty((*t.shape, len(self.names)), dtype=complex)
        by_x[..., 0], by_x[..., 1] = 1.0, 1j
        for k, shift in self._shifts(x, a * u + c * e, normal).items():
            by_x[..., k] = turned * shift + {0: 1.0, 1: 1j}.get(k, 0.0)
        by_x[..., self.lengths[0]] = u - turned * _dot(normal, u)
        by_x[..., self.lengths[1]] = -turned * _dot(normal, e)
        by_x[..., -2], by_x[..., -1] = e, 1j * e
        swing = 1j * a * u
        return moving + z * e, by_x, swing - turned * _dot(normal, swing)

    @abstractmethod
    def _closed(self, x: Array, u: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """A and the direction of the coupler for directions of the crank, and across the way of B:
        the rocker, or the normal of the line.
        """

    @abstractmethod
    def _shifts(self, x: Array, reach: ComplexArray, normal: ComplexArray) -> dict[int, Any]:
        """How far the way of B moves along its normal by each dimension but those in common, as
        seen from A0; ``reach``: B - A0.
        """

    @abstractmethod
    def cosines(self, x: Array, t: Array) -> tuple[Array, Array, Array]:
        """The cosine of the transmission angle (D, N), by x (D, N, P) and by the angle (D, N)."""

    @abstractmethod
    def extreme(self, x: Array) -> Array:
        """A crank angle, (D,), at which the cosine of the transmission angle is largest or
        smallest; it is the other one half a turn away, and monotone between both.
        """

    @abstractmethod
    def limits(self, x: Array) -> tuple[Array, Array]:
        """What is positive while the crank cannot turn fully, (D, K), and by x, (D, K, P)."""

    @abstractmethod
    def moved(self, x: Array, shift: ComplexArray, factor: ComplexArray) -> Array:
        """Dimensions turned and enlarged by factors (D,) about 0, then moved; the crank angle
        grows by the angle of the factor.
        """

    @abstractmethod
    def shapes(self, x: Array) -> tuple[Array, ComplexArray]:
        """Lengths (D, K) and directions (D, M) that are the same for the same mechanism with P,
        however its dimensions (D, P) describe it.
        """


class FourBarCurves(CouplerCurves):
    """A0, B0, crank a, coupler c, rocker b, P = A + (p + iq) e^{iψ}."""

    names = ("A0.x", "A0.y", "B0.x", "B0.y", "crank", "coupler", "rocker", "p", "q")
    lengths = (4, 5, 6)

    def _closed(self, x: Array, u: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """A, the direction of the coupler, and B - B0."""
        a0, b0 = (x[:, 0] + 1j * x[:, 1])[:, None], (x[:, 2] + 1j * x[:, 3])[:, None]
        c, b = x[:, 5, None], x[:, 6, None]
        moving = a0 + x[:, 4, None] * u
        base = b0 - moving
        square = base.real**2 + base.imag**2
        along = 0.5 * (square + c**2 - b**2)
        with np.errstate(all="ignore"):
            across = np.sqrt(square * c**2 - along**2)
            e = base * (along + 1j * self.side[:, None] * across) / (square * c)
        return moving, e, c * e - base

    def _shifts(self, x: Array, reach: ComplexArray, normal: ComplexArray) -> dict[int, Any]:
        """By both pivots and the rocker."""
        n, m = normal.real, normal.imag
        return {0: -n, 1: -m, 2: n, 3: m, 6: x[:, 6, None]}

    @np.errstate(all="ignore")
    def cosines(self, x: Array, t: Array) -> tuple[Array, Array, Array]:
        """(b² + c² - |A - B0|²) / 2bc."""
        u = np.exp(1j * t)
        a, c, b = (x[:, k, None] for k in (4, 5, 6))
        base = (x[:, 2] - x[:, 0] + 1j * (x[:, 3] - x[:, 1]))[:, None] - a * u
        square = base.real**2 + base.imag**2
        cosine = (b**2 + c**2 - square) / (2.0 * b * c)
        by_x = np.zeros((*t.shape, 9))
        by_x[..., 0], by_x[..., 1] = base.real / (b * c), base.imag / (b * c)
        by_x[..., 2], by_x[..., 3] = -by_x[..., 0], -by_x[..., 1]
        by_x[..., 4] = _dot(base, u) / (b * c)
        by_x[..., 5], by_x[..., 6] = 1.0 / b - cosine / c, 1.0 / c - cosine / b
        return cosine, by_x, a * _dot(base, 1j * u) / (b * c)

    def extreme(self, x: Array) -> Array:
        """The direction from A0 to B0."""
        return np.asarray(np.arctan2(x[:, 3] - x[:, 1], x[:, 2] - x[:, 0]))

    @staticmethod
    def ground(x: Array) -> tuple[Array, Array]:
        """The distance of the fixed pivots, (D,), and the direction from A0 to B0, (D, 2)."""
        ground = x[:, 2:4] - x[:, :2]
        length = np.hypot(ground[:, 0], ground[:, 1])
        with np.errstate(all="ignore"):
            return length, np.nan_to_num(ground / length[:, None])

    def limits(self, x: Array) -> tuple[Array, Array]:
        """g + a - (b + c) and |b - c| - |g - a|, which end the branch, and by x."""
        g, along = self.ground(x)
        a, c, b = x[:, 4], x[:, 5], x[:, 6]
        limits = np.stack([g + a - (b + c), np.abs(b - c) - np.abs(g - a)], axis=1)
        by_x = np.zeros((*limits.shape, 9))
        far, near = np.sign(b - c), np.sign(g - a)
        by_x[:, 0, :2], by_x[:, 0, 2:4] = -along, along
        by_x[:, 0, 4], by_x[:, 0, 5], by_x[:, 0, 6] = 1.0, -1.0, -1.0
        by_x[:, 1, :2], by_x[:, 1, 2:4] = near[:, None] * along, -near[:, None] * along
        by_x[:, 1, 4], by_x[:, 1, 5], by_x[:, 1, 6] = near, -far, far
        return limits, by_x

    def moved(self, x: Array, shift: ComplexArray, factor: ComplexArray) -> Array:
        """Dimensions turned and enlarged by factors (D,) about 0, then moved."""
        moved = np.array(x)
        for k in (0, 2):
            place = shift + factor * (x[:, k] + 1j * x[:, k + 1])
            moved[:, k], moved[:, k + 1] = place.real, place.imag
        moved[:, 4:] *= np.abs(factor)[:, None]
        return moved

    def shapes(self, x: Array) -> tuple[Array, ComplexArray]:
        """All dimensions, and the side."""
        return x, self.side[:, None].astype(complex)


class SliderCrankCurves(CouplerCurves):
    """A0, crank a, rod c, offset h and direction φ of B's line, P = A + (p + iq) e^{iψ}."""

    names = ("A0.x", "A0.y", "crank", "coupler", "offset", "direction", "p", "q")
    lengths = (2, 3)

    def _closed(self, x: Array, u: ComplexArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """A, the direction of the rod, and the normal of the line."""
        a, c, h = (x[:, k, None] for k in (2, 3, 4))
        line = np.exp(1j * x[:, 5])[:, None]
        with np.errstate(all="ignore"):
            height = (h - a * (u * line.conj()).imag) / c
            e = line * (self.side[:, None] * np.sqrt(1.0 - height**2) + 1j * height)
        return (x[:, 0] + 1j * x[:, 1])[:, None] + a * u, e, 1j * line

    def _shifts(self, x: Array, reach: ComplexArray, normal: ComplexArray) -> dict[int, Any]:
        """By offset and direction of the line."""
        return {4: 1.0, 5: _dot(-1j * normal, reach)}

    @np.errstate(all="ignore")
    def cosines(self, x: Array, t: Array) -> tuple[Array, Array, Array]:
        """The height of the rod over its length."""
        u = np.exp(1j * t)
        a, c, h = (x[:, k, None] for k in (2, 3, 4))
        across = u * np.exp(-1j * x[:, 5])[:, None]
        cosine = (h - a * across.imag) / c
        by_x = np.zeros((*t.shape, 8))
        by_x[..., 2], by_x[..., 3] = -across.imag / c, -cosine / c
        by_x[..., 4], by_x[..., 5] = 1.0 / c, a * across.real / c
        return cosine, by_x, -a * across.real / c

    def extreme(self, x: Array) -> Array:
        """The normal of the line."""
        return np.asarray(x[:, 5] + 0.25 * FULL_TURN)

    def limits(self, x: Array) -> tuple[Array, Array]:
        """a ± h - c, which end the branch, and by x."""
        a, c, h = x[:, 2], x[:, 3], x[:, 4]
        limits = np.stack([a + h - c, a - h - c], axis=1)
        by_x = np.zeros((*limits.shape, 8))
        by_x[:, :, 2], by_x[:, :, 3] = 1.0, -1.0
        by_x[:, 0, 4], by_x[:, 1, 4] = 1.0, -1.0
        return limits, by_x

    def moved(self, x: Array, shift: ComplexArray, factor: ComplexArray) -> Array:
        """Dimensions turned and enlarged by factors (D,) about 0, then moved."""
        moved, size = np.array(x), np.abs(factor)
        place = shift + factor * (x[:, 0] + 1j * x[:, 1])
        moved[:, 0], moved[:, 1] = place.real, place.imag
        for k in (2, 3, 4, 6, 7):
            moved[:, k] *= size
        moved[:, 5] += np.angle(factor)
        return moved

    def shapes(self, x: Array) -> tuple[Array, ComplexArray]:
        """All lengths, the foot of A0 on the line, and the line's direction from it towards B.

        A line that is turned by 180° with -h and the other side is the same one.
        """
        line = np.exp(1j * x[:, 5])
        foot = 1j * x[:, 4] * line
        lengths = np.column_stack([x[:, [0, 1, 2, 3, 6, 7]], foot.real, foot.imag])
        return lengths, (self.side * line)[:, None]


def _dot(v: ComplexArray, w: ComplexArray) -> Array:
    return np.asarray(v.real * w.real + v.imag * w.imag)


# ----------------------------------------------------------------------
# A curve that a coupler point should follow: points, timing, and bounds of the dimensions.


#: The name of the angle that is added to the given inputs.
INPUT = "input"

_FREE = 1e6  # sizes of the goal: default bounds of dimensions
_PLACES = ("A0.x", "A0.y", "B0.x", "B0.y", INPUT, "direction")


@dataclass(frozen=True, kw_only=True, eq=False)
class CurveGoal:
    """What the coupler point should do.

    Parameters
    ----------
    points : (N,) complex
        In order of travel [length].
    inputs : (N,), optional
        Angles of the crank at the points, up to a common one [rad]; ``None``: free timing.
    ordered : bool
        Whether a free crank passes the points in their order.
    closed : bool
        Whether the points go around the whole curve.
    turns_fully : bool
        Whether the crank has to turn fully; on closed curves it has to.
    range : (float, float), optional
        The driven range of the crank, from the smaller angle to the larger one [rad]: all points
        are passed in it.
    transmission : float
        The least transmission angle [rad]: over a whole turn if the crank turns fully, else over
        its range, or without one at the points.
    bounds : Mapping[str, (float, float)]
        Bounds of dimensions by name [length], of ``input`` and ``direction`` [rad].
    shortest, longest, ratio : float
        Bounds of all lengths of links, ground included, and of their ratio.
    reach : (N,), optional
        The largest distances from the points that are allowed [length].
    """

    points: ComplexArray
    inputs: Array | None = None
    ordered: bool = True
    closed: bool = True
    turns_fully: bool = False
    range: tuple[float, float] | None = None
    transmission: float = 0.0
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    shortest: float = 0.0
    longest: float = np.inf
    ratio: float = np.inf
    reach: Array | None = None

    @property
    def must_turn(self) -> bool:
        """Whether the crank has to turn fully."""
        return self.turns_fully or self.closed

    @property
    def limited_range(self) -> tuple[float, float] | None:
        """The driven range of a crank that need not turn fully."""
        return None if self.must_turn else self.range

    def turned_inside(self, least: Array, most: Array) -> tuple[Array, Array]:
        """The whole turns that bring angles from ``least`` to ``most`` nearest to the driven range
        [rad], and how far they are outside of it then.
        """
        if self.range is None:
            return np.zeros_like(least), np.zeros_like(least)
        start, stop = self.range
        turns = np.round(0.5 * ((start + stop) - (least + most)) / FULL_TURN) * FULL_TURN
        outside = np.maximum(0.0, start - least - turns) + np.maximum(0.0, most + turns - stop)
        return turns, outside

    @cached_property
    def input_bounds(self) -> tuple[float, float]:
        """Bounds of the angle that is added to given inputs [rad]; none if the first is larger."""
        low, high = self.bounds.get(INPUT, (-np.inf, np.inf))
        if self.range is None or self.inputs is None:
            return low, high
        begin, extent = arc_in_order(self.inputs)
        first, last = self.range[0] - begin, self.range[1] - begin - extent
        middle = 0.5 * (low + high) if np.isfinite(low + high) else 0.0
        turns = np.round((middle - 0.5 * (first + last)) / FULL_TURN) * FULL_TURN
        first, last = first + turns, last + turns
        # a range that the inputs just fill leaves one angle, to rounding
        last = max(first, last) if last > first - EQUAL_ROWS else last
        return max(low, float(first)), min(high, float(last))

    @property
    def ways(self) -> tuple[float, ...]:
        """The senses in which the crank may turn."""
        return (1.0,) if self.inputs is not None else (1.0, -1.0)

    @cached_property
    def size(self) -> float:
        """The largest distance of a point from their centre [length]."""
        return float(np.abs(self.points - self.points.mean()).max()) or 1.0

    @property
    def is_placed_freely(self) -> bool:
        """Whether no bound holds the mechanism's place or direction."""
        return not any(name in self.bounds for name in _PLACES)

    @cached_property
    def arc_shares(self) -> Array:
        """The shares of the arc length at which the points lie, (N,); all of it ends at 1."""
        ends = np.append(self.points, self.points[0]) if self.closed else self.points
        length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(ends)))])
        return np.asarray(length[: len(self.points)] / length[-1])

    def box(self, kind: type[CouplerCurves]) -> Box:
        """The bounds of all dimensions."""
        far = _FREE * (self.size + abs(self.points.mean()))
        least, most = [], []
        for k, name in enumerate(kind.names):
            low, high = (-far, far)
            if k in kind.lengths:
                low, high = max(self.shortest, self.size / _FREE), min(self.longest, far)
            low, high = self.bounds.get(name, (low, high))
            least.append(low)
            most.append(high)
        if self.inputs is not None:
            low, high = self.input_bounds
            least.append(low)
            most.append(high)
        return Box(least=np.array(least), most=np.array(most))


# ----------------------------------------------------------------------
# Points without inputs: where a fit begins along the path of a mechanism.


_SHARES = (0.1, 0.25, 0.5, 0.75, 1.0)  # of the path's length, for points along a part of it
_SHIFTS = 36  # of the first point along the path
_GAP = 1e-7  # between inputs of positions in order [rad or length]


def row_inputs(path: PathGoal | None, model: Model, table: Array) -> RowVariables:
    """Where inputs of points with free timing may be: in the table, unless it is a turn."""
    if path is None or path.timed:
        return RowVariables()
    turns = model.equations.inputs[0].kind == Kind.ANGLE.value
    least, most = float(table.min()), float(table.max())
    if turns and most - least >= FULL_TURN * (1.0 - EQUAL_ROWS):
        least, most = -np.inf, np.inf
    if not path.ordered:
        return RowVariables(least=least, most=most)
    gap = min(_GAP, 0.5 * (most - least) / len(path.places))
    span = (FULL_TURN if turns else np.inf) - gap
    return RowVariables(least=least, most=most, in_order=True, gap=gap, span=span)


def _freely_timed(
    model: Model, motion: Motion, point: str, places: ComplexArray, ordered: bool
) -> tuple[PathGoal, ...]:
    """Goals with free timing, with inputs at which the mechanism as it is comes near the points.

    In any order each point takes the nearest row. In order there is one goal for each sense of the
    input: points at the same shares of arc length on a part of the path. The part and where it
    begins are those of least squares.
    """
    lead = next(iter(motion.inputs))
    rows = np.flatnonzero(motion.found)
    at = np.asarray(motion.inputs[lead])[rows] * float(model.input_scale[0])
    path = np.asarray(motion[f"{point}.x"])[rows] + 1j * np.asarray(motion[f"{point}.y"])[rows]
    goal = PathGoal(point=point, places=places, inputs=at[:0], timed=False, ordered=ordered)
    if not ordered:
        nearest = np.abs(places[:, None] - path).argmin(axis=1)
        return (replace(goal, inputs=at[nearest]),)
    around = model.equations.inputs[0].kind == Kind.ANGLE.value and bool(
        abs(abs(at[-1] - at[0]) - FULL_TURN) <= EQUAL_ROWS * FULL_TURN
    )
    goals = []
    for falling in (False, True):
        listed = places[::-1] if falling else places
        matches = _matches(at, path, listed, around)
        best = min(matches, key=lambda match: float(np.sum(np.abs(match[1] - listed) ** 2)))
        goals.append(replace(goal, places=listed, inputs=best[0], falling=falling))
    return tuple(goals)


def _matches(
    at: Array, path: ComplexArray, places: ComplexArray, around: bool
) -> Iterator[tuple[Array, ComplexArray]]:
    """Rising inputs for the points, and where the mechanism is then, for each part and begin."""
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path)))])
    steps = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(places)))])
    along = steps / steps[-1] if steps[-1] > 0.0 else np.linspace(0.0, 1.0, len(places))
    total, turn = length[-1], at[-1] - at[0]
    # the last of N points on a whole closed path is one step before its end
    shares = (*_SHARES[:-1], 1.0 - 1.0 / len(places)) if around else _SHARES
    for share in shares:
        free = 1.0 if around else 1.0 - share
        for first in np.linspace(0.0, free, _SHIFTS, endpoint=not around):
            s = first + share * along
            laps, inside = np.divmod(s, 1.0) if around else (0.0 * s, s)
            where = np.interp(inside * total, length, np.arange(len(at)))
            inputs = np.interp(where, np.arange(len(at)), at) + laps * turn
            low = where.astype(int)
            high = np.minimum(low + 1, len(at) - 1)
            yield inputs, path[low] + (where - low) * (path[high] - path[low])


def point_named(model: Model, name: str) -> str:
    """A point as the mechanism spells it.

    Raises
    ------
    UnknownNameError
        If there is none.
    """
    spelled = find_spelling(name, model.equations.points)
    if spelled not in model.equations.points:
        known = choices("points", model.equations.points, name)
        raise UnknownNameError(f'there is no point "{name}" {known}')
    return spelled


def paths_of(model: Model, motion: Motion, goal: Points) -> tuple[PathGoal, ...]:
    """The path through points, one for each way to time them."""
    description = model.description
    name = goal.point or next(iter(description.trace), None)
    if name is None:
        raise InputError(f'"{description.name}" traces no point: name one, point = "P"')
    spelled = point_named(model, name)
    places = np.array([complex(*place) for place in goal.points])
    if goal.inputs is None:
        return _freely_timed(model, motion, spelled, places, goal.order != "any")
    inputs = np.asarray(goal.inputs, dtype=float) * float(model.input_scale[0])
    return (PathGoal(point=spelled, places=places, inputs=inputs, timed=True, ordered=True),)
