"""Dead points as a system of polynomials: positions at which some loops can move alone.

A block of ``own`` loops and the loops it depends on, L in all, have M = 2L + 1 unknown directions
and lengths, the input among them:

    left · (U, 1) = 0,     right · (V, 1) = 0,     U_p V_q = U_p' V_q',

as in :mod:`linkwork.numerics.homotopy.bilinear`. The block locks where its own unknowns have rates
ρ ≠ 0 while all variables it depends on and the input rest. With directions t = e^{iθ} and
lengths z along them, t' = iωt and z' = i(ωz + σt), so its own loops give

    Σ left_lk ω_k t_k + Σ left_lj (ω_a z_j + σ_j t_a) = 0

and the same for V with σ negated: bilinear in ρ = (ω, σ) and U, and in ρ and V. In
P^(L+1) x P^(L+1) x P^(2 own - 1) this has at most 2 own C(2L + 1, L) isolated solutions: the
coefficient of a^(L+1) b^(L+1) r^(2 own - 1) in (a + b)^(2L+1) (a + r)^own (b + r)^own (Morgan &
Sommese 1987, Appl. Math. Comput. 24, 101).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.foundation.arrays import ComplexArray, IndexArray

__all__ = ["DeadPointSystem", "Slot", "most_dead_points", "norm_of"]

#: A term of the own loops' rates: column of the closures, factor in (U, 1), number in ρ, weights in
#: the rows of U and of V.
Slot = tuple[int, int, int, float, float]


def most_dead_points(own: int, size: int) -> int:
    """2 own C(2L + 1, L) for ``own`` loops of a block and ``size`` = 2L + 1 unknowns."""
    return 2 * own * math.comb(size, size // 2)  # eq. (53)


def norm_of(own: int) -> ComplexArray:
    """The linear form (2 own,) that is 1 for the rates ρ of every system of ``own`` loops."""
    rng = np.random.default_rng(2 * own)
    drawn: ComplexArray = rng.normal(size=2 * own) + 1j * rng.normal(size=2 * own)
    return drawn


@dataclass(frozen=True, kw_only=True, eq=False)
class DeadPointSystem:
    """One system over x = (U, V, ρ), n = 2M + 2 own; ρ is normed by a fixed linear form.

    Parameters
    ----------
    left, right : (L, M + 1) complex
        Closures; the block's own ones last.
    rows : (4, M) int
        p, q, p', q' of every product.
    own : int
        Loops of the block itself.
    slots : tuple of Slot
    """

    left: ComplexArray
    right: ComplexArray
    rows: IndexArray
    own: int
    slots: tuple[Slot, ...]

    @property
    def loops(self) -> int:
        """L."""
        return len(self.left)

    @property
    def size(self) -> int:
        """M = 2L + 1, the unknowns in U and in V."""
        return 2 * self.loops + 1

    @property
    def parts(self) -> tuple[slice, slice, slice]:
        """The slices of (U, 1), (V, 1) and ρ in the homogeneous vector X."""
        m = self.size + 1
        return slice(0, m), slice(m, 2 * m), slice(2 * m, 2 * m + 2 * self.own)

    @property
    def bound(self) -> int:
        """How many isolated solutions there are at most."""
        return most_dead_points(self.own, self.size)

    @cached_property
    def norm(self) -> ComplexArray:
        """The linear form of ρ that is 1."""
        return norm_of(self.own)

    @cached_property
    def linear(self) -> ComplexArray:
        """The closures, (2L, N), of X."""
        u, v, rates = self.parts
        k = np.zeros((2 * self.loops, rates.stop), dtype=complex)
        k[: self.loops, u], k[self.loops :, v] = self.left, self.right
        return k

    @cached_property
    def quadratic(self) -> ComplexArray:
        """Symmetric T (E, N, N): products, then rates, as ½ XᵀTX."""
        count, own = self.rows.shape[1], self.own
        u, v, rates = self.parts
        t = np.zeros((count + 2 * own, rates.stop, rates.stop), dtype=complex)
        p, q, p1, q1 = self.rows
        e = np.arange(count)
        t[e, p, v.start + q] += 1.0
        t[e, p1, v.start + q1] -= 1.0
        for column, factor, number, weight, mirrored in self.slots:
            r = rates.start + number
            # eq. (53)
            t[count : count + own, u.start + factor, r] += weight * self.left[-own:, column]
            t[count + own :, v.start + factor, r] += mirrored * self.right[-own:, column]
        both: ComplexArray = t + t.transpose(0, 2, 1)
        return both

    @cached_property
    def _affine(self) -> IndexArray:
        """The indices of the unknowns x in X."""
        one = [part.stop - 1 for part in self.parts[:2]]
        return np.delete(np.arange(self.parts[2].stop), one)

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """F, (B, n), and its derivative, (B, n, n), at x (B, n)."""
        whole = np.ones((len(x), self.parts[2].stop), dtype=complex)
        whole[:, self._affine] = x
        slopes = np.tensordot(whole, self.quadratic, axes=(1, 1))
        jacobian = np.zeros((len(x), x.shape[1], whole.shape[1]), dtype=complex)
        lines = len(self.linear)
        jacobian[:, :lines] = self.linear
        jacobian[:, lines:-1] = slopes
        jacobian[:, -1, self.parts[2]] = self.norm
        f = np.concatenate(
            [
                whole @ self.linear.T,
                0.5 * (slopes @ whole[:, :, None])[:, :, 0],
                whole[:, self.parts[2]] @ self.norm[:, None] - 1.0,
            ],
            axis=1,
        )
        return f, jacobian[:, :, self._affine]

    def points(self, whole: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """x (B, n) of homogeneous X (B, N), and (U, 1), (V, 1) of length 1 at their last place."""
        u, v, rates = (whole[:, part] for part in self.parts)
        last = [z[:, -1] / np.linalg.norm(z, axis=1) for z in (u, v)]
        with np.errstate(all="ignore"):
            halves = [z[:, :-1] / z[:, -1:] for z in (u, v)]
            x = np.concatenate([*halves, rates / (rates @ self.norm)[:, None]], axis=1)
        return x, np.stack(last)

    def whole(self, x: ComplexArray) -> ComplexArray:
        """X (B, N) of x (B, n)."""
        found = np.ones((len(x), self.parts[2].stop), dtype=complex)
        found[:, self._affine] = x
        return found
