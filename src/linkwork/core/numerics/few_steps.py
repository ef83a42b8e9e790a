"""Steps proved on floats, one after the other: faster than arrays where there are few.

A step is proved from either end, or halved at a position in between, from which both halves are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath
from linkwork.core.numerics.newton import unlimited
from linkwork.core.numerics.system import SolvedRows

_HALVINGS = 8  # of one step, at most
_WIDER = 1.0 + 8.0 * UNIT_ROUNDOFF  # covers the rounding of a difference


@dataclass(slots=True)
class ProvedPlace:
    """A proved position: variables (N,) with their rates, and how far each may be off.

    ``data``: what proofs need of each block; ``radius``, ``unique``: of each block, weighted.
    """

    t: float
    v: list[float]
    first: list[float]
    second: list[float]
    errors: list[float]
    data: list[tuple[float, ...]]
    radius: list[float]
    unique: list[float]


class StepProver:
    """Proves steps along a path of inputs; all blocks have to be recorded.

    ``inserted``: how many positions in between were solved.
    """

    def __init__(self, solver: BlockSolver, path: InputPath) -> None:
        self.solver, self.path, self.inserted = solver, path, 0
        self.options = unlimited(solver.options, 12, solver.options.solution_tolerance)
        self.blocks = [
            (
                block.record.of_floats.place,
                block.record.of_floats.within,
                block.places,
                len(block.unknowns),
            )
            for block in solver.blocks
            if block.record is not None
        ]

    def places(self, points: SolvedRows, index: Sequence[int]) -> list[ProvedPlace | None]:
        """Some points of a path; ``None`` where the position is not proved."""
        rows = (points.v, points.first, points.second, points.input_radius)
        return [self._place(float(points.t[k]), *(row[k].tolist() for row in rows)) for k in index]

    def _place(
        self,
        t: float,
        v: list[float],
        first: list[float],
        second: list[float],
        input_radius: list[float],
    ) -> ProvedPlace | None:
        errors = [0.0] * self.solver.unknowns + input_radius
        place = ProvedPlace(t, v, first, second, errors, [], [], [])
        try:
            for prepare, within, places, n in self.blocks:
                data = prepare(*[v[k] for k in places])
                known = [errors[k] for k in places[n:]]
                holds, radius, unique, *own = within(*data, *known)
                if not holds:
                    return None
                for k, error in zip(places, own[:n], strict=False):
                    errors[k] = error
                place.data.append(data)
                place.radius.append(radius)
                place.unique.append(unique)
        except (ArithmeticError, ValueError):  # a singular Jacobian
            return None
        return place

    def joins(self, a: ProvedPlace, b: ProvedPlace, halvings: int = _HALVINGS) -> bool:
        """Whether the step between two positions is proved to stay on one branch."""
        n = self.solver.unknowns
        far = [
            abs(y - x) * _WIDER + e + f
            for x, y, e, f in zip(a.v[n:], b.v[n:], a.errors[n:], b.errors[n:], strict=True)
        ]
        moved = [
            abs(y - x) + max(e, f)
            for x, y, e, f in zip(a.v[:n], b.v[:n], a.errors, b.errors, strict=False)
        ]
        if self._reaches(a, far, moved) or self._reaches(b, far, moved):
            return True
        if not halvings:
            return False
        middle = self._between(a, b)
        return (
            middle is not None
            and self.joins(a, middle, halvings - 1)
            and self.joins(middle, b, halvings - 1)
        )

    def _reaches(self, place: ProvedPlace, far: list[float], moved: list[float]) -> bool:
        """Whether there is one solution for all inputs so ``far`` in a box that ``moved`` fits."""
        errors = [0.0] * self.solver.unknowns + far
        try:
            for (_, within, places, n), data in zip(self.blocks, place.data, strict=True):
                known = [errors[k] for k in places[n:]]
                holds, _, _, *own = within(*data, *known)
                if not holds:
                    return False
                for k, error, isolation in zip(places, own, own[n:], strict=False):
                    if not moved[k] < isolation:  # eq. (33)
                        return False
                    errors[k] = error
        except (ArithmeticError, ValueError):
            return False
        return True

    def _between(self, a: ProvedPlace, b: ProvedPlace) -> ProvedPlace | None:
        """A proved position half-way, from the quintic through both ends."""
        n, t, h = self.solver.unknowns, 0.5 * (a.t + b.t), b.t - a.t
        if t in (a.t, b.t):
            return None
        q, r = 5.0 / 32.0 * h, h * h / 64.0
        v = [
            0.5 * (x + y) + q * (dx - dy) + r * (ex + ey)  # eq. (20) at the middle
            for x, y, dx, dy, ex, ey in zip(
                a.v[:n], b.v, a.first, b.first, a.second, b.second, strict=False
            )
        ]
        rates = self.path.rates
        v += [o + t * rate for o, rate in zip(self.path.origins, rates, strict=True)]
        self.inserted += 1
        if self.solver.solve_row(v, self.options).status:
            return None
        unknown = [0.0] * n
        first, second = unknown + rates, unknown + [0.0] * len(rates)
        self.solver.rates_row(v, first, second)
        radius = [2.0 * UNIT_ROUNDOFF * abs(x) for x in v[n:]]
        return self._place(t, v, first, second, radius)


def radii_of(places: Sequence[ProvedPlace]) -> tuple[Array, Array, Array]:
    """Radii and radii of uniqueness, block by block, and errors (K, N), of proved positions."""
    return (
        np.array([place.radius for place in places]),
        np.array([place.unique for place in places]),
        np.array([place.errors for place in places]),
    )
