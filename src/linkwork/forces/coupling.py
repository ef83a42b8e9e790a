"""Reactions and the forces that follow from them, solved together: friction acts on the reactions
that cause it.

With s the sizes of what follows, reactions are r = r₀ + Σ s_k a_k, eq. (75), and the sizes are
s_j = λ σ_j(r), with λ = 1. Without friction, at λ = 0, the solution is known; the branch is
followed from there to λ = 1. It ends before that where friction locks the mechanism.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.forces.size import Size
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.stacked_systems import solutions

__all__ = ["Coupled", "Coupling"]

_SOLVED = 1e-14  # relative to the sizes: a few rounding errors
_MOST_ITERATIONS = 30
_SMALLEST_STEP = 1e-12  # of λ: the branch ends there
_MOST_STEPS = 400
_NEAR = 0.5  # relative distance up to which a prediction is on the branch
_MARGIN = 1e-9  # of proofs, against rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class Coupled:
    """Sizes in B rows.

    Parameters
    ----------
    sizes : (B, K)
        NaN without equilibrium.
    found : (B,)
    proved : (B,)
        Whether it is proved that the equilibrium exists, or that none does.
    """

    sizes: Array
    found: BoolArray
    proved: BoolArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Coupling:
    """The equations of K sizes in B rows.

    Parameters
    ----------
    sizes : sequence of Size
    start : (B, K, 2)
        The unknowns of every size without what follows; zeros if it has one only.
    change : (B, K, 2, K)
        Their derivatives by all sizes.
    rubs : (K,)
        Which sizes are friction.
    """

    sizes: Sequence[Size]
    start: Array
    change: Array
    rubs: BoolArray

    def solve(self) -> Coupled:
        """The equilibrium of every row, on the branch of that without friction."""
        rows, count = self.start.shape[:2]
        s, found = np.full((rows, count), np.nan), np.zeros(rows, dtype=bool)
        proved = np.zeros(rows, dtype=bool)
        fine = np.isfinite(self.start).all(axis=(1, 2)) & np.isfinite(self.change).all(
            axis=(1, 2, 3)
        )
        where = np.flatnonzero(fine)
        self.rows(where)._solve_into(s, found, proved, where)
        return Coupled(sizes=s, found=found, proved=proved)

    def _solve_into(self, s: Array, found: BoolArray, proved: BoolArray, where: IndexArray) -> None:
        """Solve all rows, and write them to their places."""
        free = self._free
        at, solved = self._newton(free, np.ones(len(free)))
        # a contraction has one fixed point only: no other branch to fall on
        direct = self._contracts & solved
        reached = np.ones(len(free))
        left = np.flatnonzero(~direct)
        if len(left):
            rest = self.rows(left)
            at[left], reached[left] = rest._follow(free[left])
            direct[left] = (reached[left] >= 1.0) & rest._exists(at[left])
        complete = reached >= 1.0
        lost = np.flatnonzero(~complete)
        if len(lost):
            direct[lost] = self.rows(lost)._excluded(at[lost])
        s[where] = np.where(complete[:, None], at, np.nan)
        found[where], proved[where] = complete, direct

    def rows(self, which: IndexArray) -> Coupling:
        """Some rows."""
        return Coupling(
            sizes=[size.rows(which) for size in self.sizes],
            start=self.start[which],
            change=self.change[which],
            rubs=self.rubs,
        )

    @cached_property
    def _free(self) -> Array:
        """Sizes without friction: what follows then does not change what it follows from."""
        return self._values(self.start) * ~self.rubs

    def _unknowns(self, s: Array) -> Array:
        # eq. (75)
        found: Array = self.start + np.einsum("bjmk,bk->bjm", self.change, s)
        return found

    def _values(self, u: Array) -> Array:
        values = [size.value(u[:, j, : len(size.unknowns)]) for j, size in enumerate(self.sizes)]
        return np.stack(values, axis=1)

    def _slopes(self, u: Array) -> Array:
        """The derivatives of all sizes by all others, (B, K, K)."""
        found = np.zeros((*self.start.shape[:2], len(self.sizes)))
        for j, size in enumerate(self.sizes):
            m = len(size.unknowns)
            gradient = size.gradient(u[:, j, :m])
            found[:, j] = np.einsum("bm,bmk->bk", gradient, self.change[:, j, :m])
        return found

    def _shares(self, share: Array) -> Array:
        """λ of friction, 1 of all others, (B, K)."""
        return np.where(self.rubs, share[:, None], 1.0)

    def _jacobian(self, u: Array, share: Array) -> Array:
        identity = np.eye(len(self.sizes))
        found: Array = identity - self._shares(share)[:, :, None] * self._slopes(u)
        return found

    def _newton(self, s: Array, share: Array) -> tuple[Array, BoolArray]:
        """Sizes by Newton-Raphson, and in which rows it converged."""
        s = s.copy()
        done = np.zeros(len(s), dtype=bool)
        for _ in range(_MOST_ITERATIONS):
            u = self._unknowns(s)
            rest = s - self._shares(share) * self._values(u)
            # what each size rounds to: moments are not compared with forces, whatever the units
            terms = np.abs(self.start) + np.einsum("bjmk,bk->bjm", np.abs(self.change), np.abs(s))
            limit = _SOLVED * (self._scale * terms.sum(axis=2) + np.abs(s))
            done = (np.abs(rest) <= limit).all(axis=1)
            if done.all():
                break
            # sizes have edges: Newton-Raphson takes the slope of one side there (semismooth)
            step = solutions(self._jacobian(u, share), rest[:, :, None])[:, :, 0]
            # NaN leaves the row where it is: it did not converge
            s = np.where(done[:, None] | ~np.isfinite(step), s, s - step)
        return s, done

    @cached_property
    def _scale(self) -> Array:
        """The largest factor of each size, (K,)."""
        unit = np.ones((len(self.start), 2))
        found = np.zeros(len(self.sizes))
        for j, size in enumerate(self.sizes):
            # one-sided forces have a factor for each side
            for way in (unit, -unit):
                gradient = np.abs(size.gradient(way[:, : len(size.unknowns)]))
                found[j] = max(found[j], np.max(gradient, initial=0.0))
        return found

    @cached_property
    def _bounds(self) -> Array:
        """The largest changes of all sizes by a unit of all others, (B, K, K)."""
        count = len(self.sizes)
        found = np.zeros((len(self.start), count, count))
        for j, size in enumerate(self.sizes):
            m = len(size.unknowns)
            constant = size.value(np.zeros((len(self.start), m)))
            for k in range(count):
                change = self.change[:, j, :m, k]
                # sizes are convex and homogeneous: none changes by more than that of the change
                both = [np.abs(size.value(way) - constant) for way in (change, -change)]
                found[:, j, k] = np.maximum(*both)
        return found

    @cached_property
    def _contracts(self) -> BoolArray:
        """Rows with one equilibrium, by Banach's theorem in a weighted maximum norm."""
        # eq. (76): weights w > 0 with C w < w exist if and only if C has a spectral radius below 1
        identity = np.eye(len(self.sizes))
        ones = np.ones((*self.start.shape[:2], 1))
        weights = solutions(identity - self._bounds, ones)[:, :, 0]
        drop = weights - np.einsum("bjk,bk->bj", self._bounds, weights)
        found: BoolArray = ((weights > 0.0) & (drop > _MARGIN * weights)).all(axis=1)
        return found

    def _follow(self, free: Array) -> tuple[Array, Array]:
        """Follow the branch from λ = 0; returns the last sizes and their λ, (B,)."""
        s, share = free.copy(), np.zeros(len(free))
        step = np.full(len(free), 0.25)
        for _ in range(_MOST_STEPS):
            on = np.flatnonzero((share < 1.0) & (step > _SMALLEST_STEP))
            if not len(on):
                break
            own = self.rows(on)
            aim = np.minimum(share[on] + step[on], 1.0)
            # Euler's prediction: ds/dλ = J⁻¹ σ
            u = own._unknowns(s[on])
            more = np.where(self.rubs, own._values(u), 0.0) * (aim - share[on])[:, None]
            guess = s[on] + solutions(own._jacobian(u, share[on]), more[:, :, None])[:, :, 0]
            at, solved = own._newton(np.nan_to_num(guess), aim)
            size = np.abs(at).max(axis=1) + np.abs(s[on]).max(axis=1)
            near = np.abs(at - guess).max(axis=1) <= _NEAR * size
            # past an infinite or a double solution the determinant has changed its sign
            there = np.linalg.det(own._jacobian(own._unknowns(at), aim)) > 0.0
            good = solved & near & there
            s[on[good]], share[on[good]] = at[good], aim[good]
            step[on] *= np.where(good, 2.0, 0.25)
            # the end of the branch need not be found where a proof excludes λ = 1
            failed = on[~good]
            step[failed[self.rows(failed)._excluded(s[failed])]] = 0.0
        return s, share

    def _exists(self, s: Array) -> BoolArray:
        """Rows whose equilibrium is proved near sizes, by the theorem of Newton and Kantorovich."""
        ones = np.ones(len(s))
        u = self._unknowns(s)
        inverse = np.linalg.inv(self._jacobian(u, ones))
        bound = np.abs(inverse).sum(axis=2).max(axis=1)
        step = np.einsum("bjk,bk->bj", inverse, s - self._values(u))
        # at least the rounding of the residual
        noise = bound * 1e-13 * (1.0 + np.abs(s).max(axis=1))
        radius = 2.0 * (np.abs(step).max(axis=1) + noise)
        bends = np.zeros(len(s))
        for j, size in enumerate(self.sizes):
            m = len(size.unknowns)
            # the most that the unknowns of this size change with a unit of all sizes
            most = np.abs(self.change[:, j, :m]).sum(axis=(1, 2))
            with np.errstate(all="ignore"):
                bend = size.bend(u[:, j, :m], radius * most) * most**2
            bends = np.fmax(bends, np.where(most > 0.0, bend, 0.0))
        found: BoolArray = bound * bends * radius <= 1.0
        return found

    def _excluded(self, s: Array) -> BoolArray:
        """Rows in which no equilibrium exists on any branch, proved.

        Convex sizes are at least their tangents: s ≥ g + H s. If a row y ≥ 0 has y H ≥ y and
        y g > 0, then y s ≥ y g + y s, which is impossible.
        """
        u = self._unknowns(s)
        slopes = self._slopes(u)
        g = self._values(u) - np.einsum("bjk,bk->bj", slopes, s)
        # y H = ρ y with ρ ≥ 1 is such a row where H has no negative entries (Perron)
        values, vectors = np.linalg.eig(np.swapaxes(slopes, 1, 2))
        found = np.zeros(len(s), dtype=bool)
        for k in range(len(self.sizes)):
            y = vectors[:, :, k].real
            y = y * np.where(y.sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
            y = np.where(np.abs(y) < 1e-12, 0.0, y)
            ahead = np.einsum("bjk,bj->bk", slopes, y)
            real = np.abs(values[:, k].imag) == 0.0
            # eq. (77)
            holds = (ahead >= y * (1.0 + _MARGIN)).all(axis=1) & (y >= 0.0).all(axis=1)
            gain = (y * g).sum(axis=1)
            found |= real & holds & (gain > _MARGIN * (np.abs(y * g).sum(axis=1)))
        return found
