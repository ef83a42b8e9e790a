"""Positions and steps proved by printed functions: few on floats, the rows of a table at once.

A step is proved from either end, or halved at a position in between, from which both halves are.
Rows of a table and the nodes of their track are sorted along the path; interpolated positions are
corrected and proved, and each step is proved from its left end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, BoolArray, CountArray, IndexArray
from linkwork.core.foundation.statuses import CONVERGED, Certification
from linkwork.core.numerics.block_solver import FEW, BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Node, interpolate, rows_of_nodes
from linkwork.core.numerics.newton import BlockFunctions, NewtonOptions, SolvedRows, unlimited

_WIDER = 1.0 + 8.0 * UNIT_ROUNDOFF  # covers the rounding of a difference

# ----------------------------------------------------------------------
# Few steps, one after the other, on floats.


_HALVINGS = 8  # of one step, at most


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


# ----------------------------------------------------------------------
# The rows of a table, all at once, with arrays.


_ROUNDS = 6  # corrections of an interpolated position, at most
_FAR = 0.1  # weighted: a position so far from its interpolation may lie on another branch


class Points(NamedTuple):
    """P points of a path; arrays of variables are (N, P), with lanes of designs as a last axis.

    ``sound``: whether all are solved and proved, for each lane.
    """

    v: Array
    first: Array
    second: Array
    errors: Array
    iterations: CountArray
    residual: Array
    condition: Array
    radius: Array
    unique: Array
    connected: BoolArray
    sound: BoolArray


def proved_rows(
    solver: BlockSolver,
    path: InputPath,
    nodes: Sequence[Node],
    joined: IndexArray,
    t: Array,
    inputs: Array,
    input_radius: Array,
) -> SolvedRows | None:
    """Proved rows at rising values t (B,) within the nodes of a track.

    ``None`` where a position or step is not proved so.

    Parameters
    ----------
    joined : (K,)
        The nodes to which all rows are joined.
    inputs, input_radius : (B, p)
        The path's inputs at t, and how far the intended ones may be from them.
    """
    whole = rows_of_nodes(nodes)
    own = whole.take(joined)
    times = np.concatenate([own.t, t])
    order = np.argsort(times, kind="stable")
    times = times[order]
    place = np.empty(len(order), dtype=np.intp)
    place[order] = np.arange(len(order))
    n, v = solver.unknowns, np.empty((solver.variables, len(order)))
    v[:n, place[: len(own)]] = own.v[:, :n].T
    rows = place[len(own) :]
    v[:n, rows] = interpolate(whole, t)[0][:, :n].T
    radius = np.empty((solver.variables - n, len(order)))
    for there, values, wide in (
        (place[: len(own)], own.v[:, n:], 2.0 * UNIT_ROUNDOFF * np.abs(own.v[:, n:])),
        (rows, inputs, input_radius),
    ):
        v[n:, there], radius[:, there] = values.T, wide.T
    parts = parts_of(solver, [block.record.of_arrays for block in solver.blocks if block.record])
    with np.errstate(all="ignore"):
        found = solve_points(parts, v, radius, path.rates)
        if not found.sound:
            return None
        if not found.connected.all() and not _closer(solver, path, times, found):
            return None
    count = len(t)
    return SolvedRows(
        t=t,
        v=np.ascontiguousarray(found.v[:, rows].T),
        first=np.ascontiguousarray(found.first[:, rows].T),
        second=np.ascontiguousarray(found.second[:, rows].T),
        status=np.full(count, CONVERGED, dtype=np.int8),
        iterations=found.iterations[rows],
        residual=found.residual[rows],
        condition=found.condition[rows],
        certification=np.full(count, Certification.CERTIFIED.code, dtype=np.int8),
        radius=found.radius[rows],
        uniqueness_radius=found.unique[rows],
    )


class Part(NamedTuple):
    """A block: its functions of arrays, its unknowns, what it knows, weights of its unknowns."""

    functions: BlockFunctions
    unknowns: IndexArray
    known: IndexArray
    weights: Sequence[Any]


def parts_of(
    solver: BlockSolver, functions: Sequence[BlockFunctions], scale: Any = None
) -> list[Part]:
    """The blocks of a solver with functions; ``scale`` (D,): weights of lengths of designs."""
    found = []
    for block, own in zip(solver.blocks, functions, strict=True):
        n = len(block.unknowns)
        turns, weights = block.system.is_angle[:n], block.system.variable_scale[:n]
        if scale is None:
            each: list[Any] = weights.tolist()
        else:
            each = [1.0 if angle else scale for angle in turns]
        found.append(Part(own, block.unknowns, block.variables[n:], each))
    return found


def solve_points(
    parts: Sequence[Part], start: Array, radius: Array, rates: Sequence[float]
) -> Points:
    """Points corrected and proved block by block, and which steps between them are proved.

    Parameters
    ----------
    start : (N, P) or (N, P, D)
        Interpolated unknowns, and inputs.
    radius : (p, P) or (p, P, D)
        How far the intended inputs may be from these.
    """
    n, shape = len(start) - len(radius), start.shape[1:]
    v = start.copy()
    first, second, errors, far = np.zeros((4, *v.shape))
    for k, rate in enumerate(rates, n):
        first[k] = rate
    errors[n:] = radius
    far[n:, :-1] = np.abs(v[n:, 1:] - v[n:, :-1]) * _WIDER + radius[:, 1:] + radius[:, :-1]
    iterations = np.zeros(shape, dtype=np.int64)
    residual, condition = np.zeros(shape), np.ones(shape)
    worst, least = np.zeros(shape), np.full(shape, np.inf)
    connected, sound = np.ones((shape[0] - 1, *shape[1:]), dtype=bool), np.ones(shape, dtype=bool)
    for functions, mine, known, weights in parts:
        m = len(mine)
        here = [*v[mine], *v[known]]
        error, done = _corrected(functions.correct, here, m, iterations)
        found = functions.rates_and_proofs(
            *here, *first[known], *second[known], *errors[known], *far[known]
        )
        bends, own, proofs = found[: 2 * m], found[2 * m], found[2 * m + 2 :]
        holds, near, unique, *bounds = proofs[: 3 + 2 * m]
        reached, _, _, *wide = proofs[3 + 2 * m :]
        sound &= done & holds
        connected &= np.broadcast_to(reached, shape)[:-1]
        for i, (k, weight) in enumerate(zip(mine, weights, strict=True)):
            v[k] = here[i]
            sound &= np.abs(v[k] - start[k]) <= _FAR * weight
            first[k], second[k] = bends[i], bends[m + i]
            errors[k], far[k] = bounds[i], wide[i]
            gap = np.abs(v[k, 1:] - v[k, :-1]) + np.maximum(errors[k, 1:], errors[k, :-1])
            connected &= gap < np.broadcast_to(wide[m + i], shape)[:-1]  # eq. (33)
        residual, condition = np.maximum(residual, error), np.maximum(condition, own)
        worst, least = np.maximum(worst, near), np.minimum(least, unique)
    return Points(
        v, first, second, errors, iterations, residual, condition, worst, least, connected,
        np.asarray(sound.all(axis=0)),
    )  # fmt: skip


def _corrected(
    correct: Callable[..., Any], values: list[Array], unknowns: int, iterations: CountArray
) -> tuple[Array, BoolArray]:
    """Variables of a block, in place, corrected down to rounding: residuals, and where they are."""
    options, last = NewtonOptions(), None
    for k in range(_ROUNDS + 1):
        error, size, _, *change = correct(*values)
        done = error <= options.equation_tolerance  # eq. (8)
        if last is not None:
            done |= last <= options.solution_tolerance
        if k == _ROUNDS or done.all():
            break
        values[:unknowns] = [x - y for x, y in zip(values, change, strict=False)]  # eq. (6)
        np.maximum(iterations, (k + 1) * ~done, out=iterations)
        last = size
    return error, done


def _closer(solver: BlockSolver, path: InputPath, t: Array, found: Points) -> bool:
    """Whether the few steps that are open are proved on floats."""
    open_: IndexArray = np.flatnonzero(~found.connected)
    if len(open_) > FEW:
        return False
    points = SolvedRows(
        t=t,
        v=found.v.T,
        first=found.first.T,
        second=found.second.T,
        input_radius=found.errors[solver.unknowns :].T,
    )
    prover = StepProver(solver, path)
    for k in open_:
        one, other = prover.places(points, (k, k + 1))
        if one is None or other is None or not prover.joins(one, other):
            return False
    return True
