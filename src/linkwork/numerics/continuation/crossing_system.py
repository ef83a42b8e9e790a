"""The extended system of a crossing of two branches, and the tangents of both.

At a crossing D = [J, F_t] loses rank: a left null vector w has wᵀJ = 0 and wᵀF_t = 0. The system

    F(x, t) + β c = 0,   J(x, t)ᵀ w = 0,   wᵀF_t(x, t) = 0,   wᵀw = 1

for (x, t, β, w), with a fixed vector c near w, is regular at a simple crossing, where β = 0
(Griewank & Reddien 1984, SIAM J. Numer. Anal. 21). With a basis z1, z2 of D's null space the
crossing tangents a z1 + b z2 solve A a² + 2 B ab + C b² = 0 with A = wᵀD²F[z1, z1],
B = wᵀD²F[z1, z2], C = wᵀD²F[z2, z2].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import EPSILON
from linkwork.numerics.continuation.branch_tracking import InputPath

__all__ = ["CrossingSystem", "Equations", "KnownJet"]

_STEPS = 12


@dataclass(frozen=True)
class KnownJet:
    """The motion of the known variables of some equations: y, y', y'' by t, (p,) each."""

    at: Callable[[float], tuple[Array, Array, Array]]

    @classmethod
    def along(cls, path: InputPath) -> KnownJet:
        """The inputs on a path."""
        return cls(lambda t: (path.at(t), path.rate, np.zeros_like(path.rate)))

    @classmethod
    def resting(cls, y: Array, first: Array, second: Array) -> KnownJet:
        """The same y, y', y'' whatever t is asked for."""
        return cls(lambda t: (y, first, second))


class Equations(Protocol):
    """The part of a System that locating a crossing uses."""

    @property
    def unknowns(self) -> int: ...
    @property
    def equation_scale(self) -> Array: ...
    @property
    def variable_scale(self) -> Array: ...
    def jacobian(self, v: Array) -> Array: ...
    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]: ...
    def hessians(self, v: Array, weights: Array) -> Array: ...


class CrossingSystem:
    """The extended system of some equations, in scaled variables and equations."""

    def __init__(self, system: Equations, known: KnownJet) -> None:
        self.system, self.known = system, known
        self.n = system.unknowns
        self.weights = system.variable_scale[: self.n]
        self.scale = system.equation_scale

    def _at(self, x: Array, t: float) -> tuple[Array, Array, Array]:
        """v (1, N), scaled unit steps of the unknowns and of t, (n + 1, N), and y'' (p,)."""
        y, first, second = self.known.at(t)
        basis = np.zeros((self.n + 1, self.n + len(y)))
        basis[: self.n, : self.n] = np.diag(self.weights)
        basis[self.n, self.n :] = first
        return np.concatenate([x, y])[None, :], basis, second

    def linear(self, x: Array, t: float) -> tuple[Array, Array]:
        """F (n,) and D (n, n + 1), scaled."""
        v, basis, _ = self._at(x, t)
        f, jacobian = self.system.residual_and_jacobian(v)
        d = jacobian[0] @ basis.T / self.scale[:, None]
        return f[0] / self.scale, d

    def bend(self, x: Array, t: float, w: Array) -> Array:
        """wᵀD²F over all pairs of scaled unit steps, (n + 1, n + 1)."""
        v, basis, second = self._at(x, t)
        matrix: Array = basis @ self.system.hessians(v[0], (w / self.scale)[None, :])[0] @ basis.T
        if second.any():  # known variables that do not move at a constant rate
            slope = self.system.jacobian(v)[0, :, self.n :]
            matrix[self.n, self.n] += float(w @ (slope @ second / self.scale))
        return matrix

    def solve(self, x: Array, t: float) -> tuple[Array, float, Array, float, float] | None:
        """(x, t, w, β) and the last change of t, by Newton-Raphson."""
        n = self.n
        _, d = self.linear(x, t)
        w = np.linalg.svd(d)[0][:, -1]
        # the left singular vector of the smallest singular value is near the null vector
        c, beta, error = w.copy(), 0.0, np.inf
        for _ in range(_STEPS):
            f, d = self.linear(x, t)
            h = self.bend(x, t, w)
            matrix = np.zeros((2 * n + 2, 2 * n + 2))
            matrix[:n, : n + 1] = d  # derivatives of eq. (41): rows F + β c, columns x, t, β, w
            matrix[:n, n + 1] = c
            matrix[n : 2 * n + 1, : n + 1] = h  # rows Dᵀw
            matrix[n : 2 * n + 1, n + 2 :] = d.T
            matrix[2 * n + 1, n + 2 :] = 2.0 * w  # row wᵀw
            right = np.concatenate([f + beta * c, d.T @ w, [w @ w - 1.0]])  # eq. (41)
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
            # the change of t no longer shrinks: rounding is all that is left
            if error <= 2.0 * EPSILON * max(1.0, abs(t)) or (error >= last and last < 1e-10):
                break
        return x, t, w, beta, error

    def tangents(self, x: Array, t: float, w: Array) -> tuple[Array, ...] | None:
        """The directions of both branches in scaled unknowns and t, (n + 1,) each."""
        _, d = self.linear(x, t)
        null = np.linalg.svd(d)[2][-2:]
        h = self.bend(x, t, w)
        a, b, c = null[0] @ h @ null[0], null[0] @ h @ null[1], null[1] @ h @ null[1]  # eq. (42)
        square = b * b - a * c
        # complex tangents: an isolated point, no crossing of real branches
        if square <= 0.0:
            return None
        root = np.sqrt(square)
        # the two roots (p : q) of a p² + 2 b p q + c q², without cancellation
        q = -(b + np.copysign(root, b))
        pairs = ((q, a), (c, q)) if q != 0.0 else ((1.0, 0.0), (0.0, 1.0))
        return tuple(p * null[0] + r * null[1] for p, r in pairs)
