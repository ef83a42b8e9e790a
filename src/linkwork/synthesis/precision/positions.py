"""The positions of a task, seen from the first one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.synthesis.precision.problem import PrecisionProblem


@dataclass(frozen=True, order=True)
class GivenLength:
    """The distance of two of A0, B0, A, B and the traced point P [length]."""

    one: str
    other: str
    length: float


@dataclass(frozen=True, kw_only=True, eq=False)
class PrecisionPositions:
    """What a four-bar has to do; the order of positions does not matter here.

    Parameters
    ----------
    start : complex
        The traced point in the first position [length].
    poses : (M, ) complex
        The point in the poses after the first position [length].
    turns : (M,)
        How far the coupler has turned there since the first position [rad].
    points : (N,) complex
        The point in the other positions [length].
    pivots : (0, 1 or 2,) complex
        Fixed pivots that are given: A0, or A0 and B0 [length].
    lengths : tuple of GivenLength
        In the order of their ends.
    order : (1 + M + N,) int
        The number that every position has in the task: the start, poses, points.
    listed : int
        How many of them the task lists; the others were drawn.
    """

    start: complex
    poses: ComplexArray
    turns: Array
    points: ComplexArray
    pivots: ComplexArray
    lengths: tuple[GivenLength, ...]
    order: IndexArray
    listed: int

    @classmethod
    def of(
        cls,
        points: ComplexArray,
        angles: Array,
        pivots: ComplexArray,
        lengths: Sequence[GivenLength] = (),
    ) -> PrecisionPositions:
        """Positions (J,) in any order, with the coupler's angles [rad], NaN where it is free.

        The first pose is the start, the first point if there are no poses.
        """
        posed = np.flatnonzero(~np.isnan(angles))
        first = int(posed[0]) if len(posed) else 0
        order = np.concatenate([[first], posed[1:], np.setdiff1d(np.arange(len(points)), posed)])
        order = order.astype(np.intp)
        if not len(posed):
            order = order[1:]
        others, count = points[order[1:]], max(len(posed) - 1, 0)
        return cls(
            start=complex(points[first]),
            poses=others[:count],
            turns=angles[order[1 : count + 1]] - angles[first],
            points=others[count:],
            pivots=pivots,
            lengths=tuple(sorted(lengths)),
            order=order,
            listed=len(order),
        )

    @property
    def problem(self) -> PrecisionProblem:
        """The family of equations."""
        return PrecisionProblem(
            poses=len(self.poses),
            points=len(self.points),
            pivots=len(self.pivots),
            lengths=tuple((entry.one, entry.other) for entry in self.lengths),
        )

    @property
    def size(self) -> float:
        """The mean distance of positions from the first one, by squares [length]."""
        moved = np.concatenate([self.poses, self.points]) - self.start
        return float(np.sqrt((np.abs(moved) ** 2).mean()))

    def parameters(self, size: float) -> ComplexArray:
        """The parameters of the equations in units of ``size``, (P,)."""
        poses, points, pivots = (
            (z - self.start) / size for z in (self.poses, self.points, self.pivots)
        )
        turned = np.exp(1j * self.turns)
        lengths = np.array([entry.length / size for entry in self.lengths])
        return np.concatenate(
            [
                np.column_stack([turned, poses, poses.conj()]).ravel(),
                np.column_stack([points, points.conj()]).ravel(),
                np.column_stack([pivots, pivots.conj()]).ravel(),
                lengths**2,
            ]
        )
