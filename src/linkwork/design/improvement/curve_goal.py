"""A curve that a coupler point should follow: points, timing, and bounds of the dimensions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkwork.design.improvement.coupler_curves import CouplerCurves
from linkwork.foundation.angles import FULL_TURN, arc_in_order
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.rounding import EQUAL_ROWS
from linkwork.numerics.lane_bounds import Box

__all__ = ["INPUT", "CurveGoal"]

#: The name of the angle that is added to the given inputs.
INPUT = "input"

_FREE = 1e6  # sizes of the goal: bounds of dimensions without others
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

    def names(self, kind: type[CouplerCurves]) -> tuple[str, ...]:
        """The dimensions that vary."""
        return kind.names if self.inputs is None else (*kind.names, INPUT)

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
