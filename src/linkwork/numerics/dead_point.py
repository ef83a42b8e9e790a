"""Locating the dead point at which a branch ends, to machine precision.

At a dead point x(t) turns back like a square root: F(x, t) = 0 and J(x, t) z = 0 with the rates'
direction z. The extended system (F, J z, |z| = 1) for (x, t, z) is regular there
(Moore & Spence 1980, doi:10.1137/0717048) and Newton-Raphson on it converges quadratically.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.joined import JoinedBlocks, closure_of
from linkwork.numerics.track import InputPath, Node

__all__ = ["DeadPoint", "locate_dead_point"]

_UNIT = np.finfo(float).eps
_STEPS = 12


@dataclass(frozen=True, kw_only=True, eq=False)
class DeadPoint:
    """A dead point of a path.

    ``t`` with ``bracket`` around it; ``v`` (N,) the whole position, blocks that do not take part
    at their nearest solved values; ``direction`` (N,) how the unknowns move through it (weighted
    norm 1, zero for blocks that do not take part); ``block`` the number of the block that locks;
    ``located`` tells whether the iteration converged to rounding.
    """

    t: float
    bracket: tuple[float, float]
    v: Array
    direction: Array
    block: int
    located: bool


def locate_dead_point(
    solver: BlockSolver, path: InputPath, last: Node, side: float
) -> DeadPoint | None:
    """The dead point just beyond a node whose rates grow without bound.

    Parameters
    ----------
    last : Node
        The last node of a track before it ended.
    side : float
        +1 if t was growing, -1 if it was falling.

    Returns
    -------
    DeadPoint or None
        ``None`` if the iteration leads to no dead point on that side.
    """
    block = _fastest_block(solver, last)
    system = JoinedBlocks(solver, closure_of(solver, block))
    order, n = system.order, system.unknowns
    weights = system.variable_scale[:n]
    x, first, second = (part[order[:n]] for part in (last.v, last.first, last.second))
    k = int(np.argmax(np.abs(first / weights)))
    if second[k] == 0.0:
        return None
    ahead = first[k] / (2.0 * second[k])  # x' / 2x'' of a square root is its distance
    if not np.isfinite(ahead) or ahead * side <= 0.0:
        return None
    t = last.t + ahead
    x = x + 2.0 * ahead * first
    z = first / weights
    z = z / np.linalg.norm(z)
    state = _extended_newton(system, path, x, t, z)
    if state is None:
        return None
    x, t, z, error = state
    if (t - last.t) * side <= 0.0 or abs(t - last.t) > 10.0 * abs(ahead) + 1e-9 * max(1.0, abs(t)):
        return None
    whole = last.v.copy()
    whole[order[:n]] = x
    whole[solver.unknowns :] = path.at(t)
    direction = np.zeros(solver.variables)
    largest = float(np.abs(z).max())
    direction[order[:n]] = z * weights / largest
    reach = error + 4.0 * _UNIT * max(1.0, abs(t))
    return DeadPoint(
        t=t,
        bracket=(t - reach, t + reach),
        v=whole,
        direction=direction,
        block=block,
        located=error <= 1e-11 * max(1.0, abs(t)),
    )


def _fastest_block(solver: BlockSolver, node: Node) -> int:
    """The first block whose rates are large: those behind only follow it."""
    fast = [
        float(np.abs(node.first[b.unknowns] / solver.variable_scale[b.unknowns]).max(initial=0.0))
        for b in solver.blocks
    ]
    most = max(fast)
    return next(k for k, rate in enumerate(fast) if rate >= 1e-3 * most)


def _extended_newton(
    system: JoinedBlocks, path: InputPath, x: Array, t: float, z: Array
) -> tuple[Array, float, Array, float] | None:
    """(x, t, z) and the last change of t, by Newton-Raphson on F = 0, J W z = 0, zᵀz = 1."""
    n = system.unknowns
    weights, scale = system.variable_scale[:n], system.equation_scale
    error = np.inf
    for _ in range(_STEPS):
        v = np.concatenate([x, path.at(t)])[None, :]
        f, jacobian = system.residual_and_jacobian(v)
        j = jacobian[0, :, :n] * weights / scale[:, None]
        f_t = jacobian[0, :, n:] @ path.rate / scale
        bend, bend_t = _bent(system, path, v, z * weights)
        bend, bend_t = bend * weights / scale[:, None], bend_t / scale
        matrix = np.zeros((2 * n + 1, 2 * n + 1))
        matrix[:n, :n], matrix[:n, n] = j, f_t
        matrix[n : 2 * n, :n], matrix[n : 2 * n, n] = bend, bend_t
        matrix[n : 2 * n, n + 1 :] = j
        matrix[2 * n, n + 1 :] = 2.0 * z
        right = np.concatenate([f[0] / scale, j @ z, [z @ z - 1.0]])
        if not np.isfinite(matrix).all():
            return None
        try:
            change = -np.linalg.solve(matrix, right)
        except np.linalg.LinAlgError:
            return None
        x = x + change[:n] * weights
        t = t + float(change[n])
        z = z + change[n + 1 :]
        last, error = error, abs(float(change[n]))
        if error <= 2.0 * _UNIT * max(1.0, abs(t)) or (error >= last and last < 1e-10):
            break
    return x, t, z, error


def _bent(system: JoinedBlocks, path: InputPath, v: Array, direction: Array) -> tuple[Array, Array]:
    """D²F[z, ·] by the unknowns, (n, n), and along the path, (n,)."""
    n, count = system.unknowns, v.shape[1]
    along = np.zeros((n + 1, count))
    along[:n, :n] = np.eye(n)
    along[n, n:] = path.rate
    fixed = np.zeros((n + 1, count))
    fixed[:, :n] = direction
    columns = system.mixed(np.repeat(v, n + 1, axis=0), fixed, along)
    return columns[:n].T, columns[n]
