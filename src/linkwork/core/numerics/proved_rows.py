"""The rows of a table on a track, solved and proved all at once.

Nodes of the track and rows are sorted along the path. Interpolated positions are corrected, proved,
and each step is proved from its left end. Where something does not hold, others look closer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, CountArray, IndexArray
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.foundation.statuses import CONVERGED, Certification
from linkwork.core.numerics.block_solver import FEW, BlockSolver
from linkwork.core.numerics.branch_tracking import InputPath, Node, interpolate, rows_of_nodes
from linkwork.core.numerics.few_steps import StepProver
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.numerics.system import BlockFunctions, SolvedRows

_PIECE = 4096  # points worked on together: arrays that fit the cache
_ROUNDS = 6  # corrections of an interpolated position, at most
_FAR = 0.1  # weighted: a position so far from its interpolation may lie on another branch
_WIDER = 1.0 + 8.0 * UNIT_ROUNDOFF  # covers the rounding of a difference


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
    pieces = []
    with np.errstate(all="ignore"):
        for begin in range(0, max(len(order) - 1, 1), _PIECE):
            end = begin + _PIECE + 1
            piece = solve_points(parts, v[:, begin:end], radius[:, begin:end], path.rates)
            if not piece.sound:
                return None
            if not piece.connected.all() and not _closer(solver, path, times[begin:], piece):
                return None
            pieces.append(piece if end >= len(order) else _without_last(piece))
    found = pieces[0] if len(pieces) == 1 else _together(pieces)
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


def _without_last(points: Points) -> Points:
    """All points but the last, which is the first of the next piece."""
    return Points._make([*(x[..., :-1] for x in points[:-1]), points.sound])


def _together(pieces: Sequence[Points]) -> Points:
    columns = zip(*(piece[:-1] for piece in pieces), strict=True)
    return Points._make([*(np.concatenate(x, axis=-1) for x in columns), pieces[0].sound])


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


def _closer(solver: BlockSolver, path: InputPath, t: Array, piece: Points) -> bool:
    """Whether the few steps of a piece that are open are proved on floats."""
    open_: IndexArray = np.flatnonzero(~piece.connected)
    if len(open_) > FEW:
        return False
    points = SolvedRows(
        t=t,
        v=piece.v.T,
        first=piece.first.T,
        second=piece.second.T,
        input_radius=piece.errors[solver.unknowns :].T,
    )
    prover = StepProver(solver, path)
    for k in open_:
        one, other = prover.places(points, (k, k + 1))
        if one is None or other is None or not prover.joins(one, other):
            return False
    return True
