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
from linkwork.core.numerics.system import SolvedRows

_PIECE = 4096  # points worked on together: arrays that fit the cache
_ROUNDS = 6  # corrections of an interpolated position, at most
_FAR = 0.1  # weighted: a position so far from its interpolation may lie on another branch
_WIDER = 1.0 + 8.0 * UNIT_ROUNDOFF  # covers the rounding of a difference


class _Points(NamedTuple):
    """P points of a path; arrays of variables are (N, P)."""

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
    pieces = []
    with np.errstate(all="ignore"):
        for begin in range(0, max(len(order) - 1, 1), _PIECE):
            end = begin + _PIECE + 1
            piece = _piece(solver, path, v[:, begin:end], radius[:, begin:end])
            if piece is None:
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


def _without_last(points: _Points) -> _Points:
    """All points but the last, which is the first of the next piece."""
    return _Points._make(x[..., :-1] for x in points)


def _together(pieces: Sequence[_Points]) -> _Points:
    return _Points._make(np.concatenate(x, axis=-1) for x in zip(*pieces, strict=True))


def _piece(solver: BlockSolver, path: InputPath, start: Array, radius: Array) -> _Points | None:
    """Points corrected and proved block by block, and which steps between them are proved."""
    n, count = solver.unknowns, start.shape[1]
    v = start.copy()
    first, second, errors, far = np.zeros((4, *v.shape))
    first[n:] = path.rate[:, None]
    errors[n:] = radius
    far[n:, :-1] = np.abs(v[n:, 1:] - v[n:, :-1]) * _WIDER + radius[:, 1:] + radius[:, :-1]
    iterations = np.zeros(count, dtype=np.int64)
    residual, condition = np.zeros(count), np.ones(count)
    worst, least = np.zeros(count), np.full(count, np.inf)
    connected = np.ones(count - 1, dtype=bool)
    for block in solver.blocks:
        assert block.record is not None
        functions, m = block.record.of_arrays, len(block.unknowns)
        mine, known = block.unknowns, block.variables[m:]
        done = _corrected(solver, functions.correct, list(v[block.variables]), m, iterations)
        if done is None:
            return None
        error, here = done
        v[mine] = here[:m]
        moved = np.abs(v[mine] - start[mine]) / solver.variable_scale[mine, None]
        found = functions.rates_and_proofs(
            *here, *first[known], *second[known], *errors[known], *far[known]
        )
        rates, own, proofs = found[: 2 * m], found[2 * m], found[2 * m + 2 :]
        holds, near, unique, *bounds = proofs[: 3 + 2 * m]
        reached, _, _, *wide = proofs[3 + 2 * m :]
        if not (np.all(holds) and (moved <= _FAR).all()):
            return None
        connected &= np.broadcast_to(reached, count)[:-1]
        for i, k in enumerate(mine):
            first[k], second[k] = rates[i], rates[m + i]
            errors[k], far[k] = bounds[i], wide[i]
            gap = np.abs(v[k, 1:] - v[k, :-1]) + np.maximum(errors[k, 1:], errors[k, :-1])
            connected &= gap < np.broadcast_to(wide[m + i], count)[:-1]  # eq. (33)
        residual, condition = np.maximum(residual, error), np.maximum(condition, own)
        worst, least = np.maximum(worst, near), np.minimum(least, unique)
    return _Points(
        v, first, second, errors, iterations, residual, condition, worst, least, connected
    )


def _corrected(
    solver: BlockSolver,
    correct: Callable[..., Any],
    values: list[Array],
    unknowns: int,
    iterations: CountArray,
) -> tuple[Array, list[Array]] | None:
    """Residuals and variables of a block, corrected down to rounding; ``None`` if not all are."""
    options, last = solver.options, None
    for k in range(_ROUNDS):
        error, size, _, *change = correct(*values)
        done = error <= options.equation_tolerance  # eq. (8)
        if last is not None:
            done |= last <= options.solution_tolerance
        if done.all():
            return error, values
        if not (size < (_FAR if last is None else 0.5 * last + _FAR**8)).all():
            return None
        values[:unknowns] = [x - y for x, y in zip(values, change, strict=False)]  # eq. (6)
        np.maximum(iterations, (k + 1) * ~done, out=iterations)
        last = size
    return None


def _closer(solver: BlockSolver, path: InputPath, t: Array, piece: _Points) -> bool:
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
