"""Locating the change point at which two branches cross, and the tangents of both.

There D = [J, F_t] loses rank: a left null vector w has wᵀJ = 0 and wᵀF_t = 0. The extended system

    F(x, t) + β c = 0,   J(x, t)ᵀ w = 0,   wᵀF_t(x, t) = 0,   wᵀw = 1

for (x, t, β, w), with a fixed vector c near w, is regular at a simple crossing, where β = 0
(Griewank & Reddien 1984, doi:10.1137/0721010). With a basis z1, z2 of D's null space the crossing
tangents a z1 + b z2 solve A a² + 2 B ab + C b² = 0 with A = wᵀD²F[z1, z1], B = wᵀD²F[z1, z2],
C = wᵀD²F[z2, z2].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.joined import JoinedBlocks, closure_of
from linkwork.numerics.system import System
from linkwork.numerics.track import InputPath, Node

__all__ = [
    "ChangePoint",
    "Crossing",
    "crossing_near",
    "locate_change_point",
    "most_singular",
]

_UNIT = np.finfo(float).eps
_STEPS = 12
_UNFOLDED = 1e-13  # |β| beyond which the branches pass each other without touching


@dataclass(frozen=True, kw_only=True, eq=False)
class ChangePoint:
    """A crossing of two branches on a path.

    ``t`` with ``bracket``; ``v`` (N,) the position; ``onward`` and ``other`` (N,): derivative by t
    of the branch that was followed and of the one that crosses it (NaN if that one keeps t);
    ``directions`` (2, N): both as weighted unit vectors, zero where a block takes no part;
    ``block`` the number of the block that becomes singular; ``located`` whether it was found to
    rounding.
    """

    t: float
    bracket: tuple[float, float]
    v: Array
    onward: Array
    other: Array
    directions: Array
    block: int
    located: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Crossing:
    """A change point: parameter with bracket, position (N,), directions of both curves (2, N)."""

    t: float
    v: Array
    directions: Array
    bracket: tuple[float, float]
    located: bool


def locate_change_point(
    solver: BlockSolver, path: InputPath, last: Node, side: float
) -> ChangePoint | None:
    """The change point just beyond a node at which the Jacobian has become nearly singular.

    Parameters
    ----------
    last : Node
        The last node of a track before it ended.
    side : float
        +1 if t was growing, -1 if it was falling.

    Returns
    -------
    ChangePoint or None
        ``None`` if the branches only come near each other, or there is none on that side.
    """
    block = most_singular(solver, last.v)
    if block is None:
        return None
    system = JoinedBlocks(solver, closure_of(solver, block))
    n, order = system.unknowns, system.order
    crossing = _Crossing(system, path)
    found = crossing.solve(last.v[order[:n]], last.t)
    if found is None:
        return None
    x, t, w, beta, error = found
    inputs = solver.variable_scale[solver.unknowns :]
    near = 1e-3 * float(np.min(inputs[path.rate != 0.0] / np.abs(path.rate[path.rate != 0.0])))
    if abs(beta) > _UNFOLDED or (t - last.t) * side < -1e-3 * near or abs(t - last.t) > near:
        return None
    tangents = crossing.tangents(x, t, w)
    if tangents is None:
        return None
    own = last.first[order[:n]] / system.variable_scale[:n]
    rates = [_rate(z) for z in tangents]
    if _distance(rates[1], own) < _distance(rates[0], own):
        rates, tangents = rates[::-1], tangents[::-1]
    onward, other = rates
    whole = last.v + (t - last.t) * last.first
    whole[order[:n]] = x
    whole[solver.unknowns :] = path.at(t)
    reach = error + 4.0 * _UNIT * max(1.0, abs(t))
    weights = system.variable_scale[:n]
    return ChangePoint(
        t=t,
        bracket=(t - reach, t + reach),
        v=whole,
        onward=_placed(solver, order[:n], onward * weights),
        other=_placed(solver, order[:n], other * weights),
        directions=np.stack([_direction(solver, path, order[:n], z, weights) for z in tangents]),
        block=block,
        located=error <= 1e-9 * max(1.0, abs(t)),
    )


def crossing_near(solver: BlockSolver, path: InputPath, block: int, v: Array) -> float | None:
    """The path's parameter at the change point of a block next to a position v (N,).

    ``None`` if there is none within a hundredth of the natural size of the inputs.
    """
    system = JoinedBlocks(solver, closure_of(solver, block))
    moving = int(np.argmax(np.abs(path.rate)))
    t = float((v[solver.unknowns + moving] - path.origin[moving]) / path.rate[moving])
    found = _Crossing(system, path).solve(v[system.order[: system.unknowns]], t)
    if found is None or abs(found[3]) > _UNFOLDED:
        return None
    near = 1e-2 * float(solver.variable_scale[solver.unknowns + moving] / abs(path.rate[moving]))
    return found[1] if abs(found[1] - t) <= near else None


def _distance(rate: Array, own: Array) -> float:
    gap = float(np.abs(rate - own).max())
    return gap if np.isfinite(gap) else np.inf


def _rate(z: Array) -> Array:
    """The derivative by t along a direction (n + 1,) whose last entry is t's; NaN if t rests."""
    if abs(z[-1]) <= 1e-9 * np.abs(z).max():
        return np.full(len(z) - 1, np.nan)
    rate: Array = z[:-1] / z[-1]
    return rate


def _direction(
    solver: BlockSolver, path: InputPath, where: IndexArray, z: Array, weights: Array
) -> Array:
    whole = np.zeros(solver.variables)
    whole[where] = z[:-1] * weights
    whole[solver.unknowns :] = z[-1] * path.rate
    unit: Array = whole / np.abs(whole / solver.variable_scale).max()
    return unit


def _placed(solver: BlockSolver, where: IndexArray, values: Array) -> Array:
    whole = np.full(solver.variables, np.nan)
    whole[where] = values
    return whole


def most_singular(solver: BlockSolver, v: Array) -> int | None:
    """The block with the smallest singular value, relative to its largest; ``None`` if all are far
    from singular at v (N,).

    Columns of J are divided by their sizes near by: those of lengths that differ much are no sign
    of a singular position, one that is about to vanish is.
    """
    ratios = []
    for block in solver.blocks:
        n = len(block.unknowns)
        system, here = block.system, v[block.variables]
        j = system.jacobian(here[None, :])[0, :, :n]
        sizes = np.maximum(
            np.abs(j / system.equation_scale[:, None]).max(axis=0), _near(system, here)
        )
        scaled = j / system.equation_scale[:, None] / np.where(sizes > 0.0, sizes, 1.0)
        values = np.linalg.svd(scaled, compute_uv=False)
        ratios.append(float(values[-1] / values[0]) if values[0] > 0 else 0.0)
    if not ratios or min(ratios) > 1e-3:
        return None
    return int(np.argmin(ratios))


def _near(system: System, v: Array) -> Array:
    """How long the columns of J become near v (N,): the largest change by a natural step, (n,)."""
    n, count = len(system.equation_scale), len(v)
    i, j = (index.ravel() for index in np.indices((n, count)))
    column, step = np.eye(count)[i], np.diag(system.variable_scale)[j]
    lanes = np.repeat(v[None, :], n * count, axis=0)
    mixed = 0.25 * (system.second(lanes, column + step) - system.second(lanes, column - step))
    changes: Array = np.abs(mixed / system.equation_scale).max(axis=1).reshape(n, count)
    largest: Array = changes.max(axis=1)
    return largest


class _Crossing:
    """The extended system of one set of blocks, in scaled variables and equations."""

    def __init__(self, system: JoinedBlocks, path: InputPath) -> None:
        self.system, self.path = system, path
        self.n = system.unknowns
        self.weights = system.variable_scale[: self.n]
        self.scale = system.equation_scale
        count = len(system.variable_scale)
        self.basis = np.zeros((self.n + 1, count))  # scaled unit steps of the unknowns, and of t
        self.basis[: self.n, : self.n] = np.diag(self.weights)
        self.basis[self.n, self.n :] = path.rate

    def _at(self, x: Array, t: float) -> Array:
        return np.concatenate([x, self.path.at(t)])[None, :]

    def linear(self, x: Array, t: float) -> tuple[Array, Array]:
        """F (n,) and D (n, n + 1), scaled."""
        f, jacobian = self.system.residual_and_jacobian(self._at(x, t))
        d = jacobian[0] @ self.basis.T / self.scale[:, None]
        return f[0] / self.scale, d

    def bend(self, x: Array, t: float, w: Array) -> Array:
        """wᵀD²F over all pairs of scaled unit steps, (n + 1, n + 1)."""
        size = self.n + 1
        i, j = (index.ravel() for index in np.indices((size, size)))
        v = np.repeat(self._at(x, t), size * size, axis=0)
        values = self.system.mixed(v, self.basis[i], self.basis[j]) / self.scale
        matrix: Array = (values @ w).reshape(size, size)
        return matrix

    def solve(self, x: Array, t: float) -> tuple[Array, float, Array, float, float] | None:
        """(x, t, w, β) and the last change of t, by Newton-Raphson."""
        n = self.n
        _, d = self.linear(x, t)
        w = np.linalg.svd(d)[0][:, -1]
        c, beta, error = w.copy(), 0.0, np.inf
        for _ in range(_STEPS):
            f, d = self.linear(x, t)
            h = self.bend(x, t, w)
            matrix = np.zeros((2 * n + 2, 2 * n + 2))
            matrix[:n, : n + 1] = d
            matrix[:n, n + 1] = c
            matrix[n : 2 * n + 1, : n + 1] = h
            matrix[n : 2 * n + 1, n + 2 :] = d.T
            matrix[2 * n + 1, n + 2 :] = 2.0 * w
            right = np.concatenate([f + beta * c, d.T @ w, [w @ w - 1.0]])
            try:
                change = -np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return None
            if not np.isfinite(change).all():
                return None
            x = x + change[:n] * self.weights
            t = t + float(change[n])
            beta += float(change[n + 1])
            w = w + change[n + 2 :]
            last, error = error, abs(float(change[n]))
            if error <= 2.0 * _UNIT * max(1.0, abs(t)) or (error >= last and last < 1e-10):
                break
        return x, t, w, beta, error

    def tangents(self, x: Array, t: float, w: Array) -> tuple[Array, ...] | None:
        """The directions of both branches in scaled unknowns and t, (n + 1,) each."""
        _, d = self.linear(x, t)
        null = np.linalg.svd(d)[2][-2:]
        h = self.bend(x, t, w)
        a, b, c = null[0] @ h @ null[0], null[0] @ h @ null[1], null[1] @ h @ null[1]
        square = b * b - a * c
        if square <= 0.0:
            return None
        root = np.sqrt(square)
        # the two roots (p : q) of a p² + 2 b p q + c q², without cancellation
        q = -(b + np.copysign(root, b))
        pairs = ((q, a), (c, q)) if q != 0.0 else ((1.0, 0.0), (0.0, 1.0))
        return tuple(p * null[0] + r * null[1] for p, r in pairs)
