"""Sizes of forces that follow from other forces: friction, the tension of belts, teeth that push
apart.

All are convex and grow in proportion to the forces, apart from a constant. u are the values of the
unknowns from which a size follows, (B, m).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray, solutions


@dataclass(frozen=True, kw_only=True, eq=False)
class Size(ABC):
    """The size of a force as a function of ``unknowns``, by their numbers, m.

    Without other rules it has no edges, and is the same in all rows.
    """

    unknowns: tuple[int, ...]

    @abstractmethod
    def value(self, u: Array) -> Array:
        """The size, (B,)."""

    @abstractmethod
    def gradient(self, u: Array) -> Array:
        """Its derivatives by u, (B, m); at an edge those of one side."""

    @abstractmethod
    def bend(self, u: Array, reach: Array) -> Array:
        """The most that the gradient changes per change of u within a distance, (B,).

        Infinite where that includes an edge.
        """

    def rows(self, which: IndexArray) -> Size:
        """The size in some rows."""
        return self

    def side(self, u: Array) -> int:
        """The side of its edges on which unknowns (m,) are."""
        return 0

    def inside(self, u: Array, side: int) -> Array:
        """How far unknowns (B, m) are on a side: negative beyond its edge, (B,)."""
        return np.ones(len(u))

    def smooth(self, side: int) -> Size:
        """The size as it is on a side, continued smoothly beyond its edges."""
        return self


@dataclass(frozen=True, kw_only=True, eq=False)
class NormOf(Size):
    """``factor`` times the size of a vector of two components."""

    factor: float

    def value(self, u: Array) -> Array:
        found: Array = self.factor * np.hypot(u[:, 0], u[:, 1])
        return found

    def gradient(self, u: Array) -> Array:
        size = np.hypot(u[:, 0], u[:, 1])[:, None]
        return np.where(size > 0.0, self.factor * u / np.where(size > 0.0, size, 1.0), 0.0)

    def bend(self, u: Array, reach: Array) -> Array:
        size = np.hypot(u[:, 0], u[:, 1])
        # a unit vector turns by at most the change over the smaller of both sizes
        return np.where(reach <= size / 2.0, self.factor * 2.0 / size, np.inf)


@dataclass(frozen=True, kw_only=True, eq=False)
class Sided(Size):
    """A number times ``plus`` where it is positive, times ``minus`` where not, and a constant."""

    plus: Array | float
    minus: Array | float
    constant: float = 0.0

    def value(self, u: Array) -> Array:
        found: Array = np.maximum(u[:, 0], 0.0) * self.plus - np.minimum(u[:, 0], 0.0) * self.minus
        return found + self.constant

    def gradient(self, u: Array) -> Array:
        return np.where(u[:, 0] >= 0.0, self.plus, -np.asarray(self.minus))[:, None]

    def bend(self, u: Array, reach: Array) -> Array:
        return np.where(reach < np.abs(u[:, 0]), 0.0, np.inf)

    def rows(self, which: IndexArray) -> Sided:
        plus, minus = _in_rows(self.plus, which), _in_rows(self.minus, which)
        return replace(self, plus=plus, minus=minus)

    def side(self, u: Array) -> int:
        return 1 if u[0] >= 0.0 else -1

    def inside(self, u: Array, side: int) -> Array:
        found: Array = side * u[:, 0]
        return found

    def smooth(self, side: int) -> Linear:
        factor = self.plus if side > 0 else -np.asarray(self.minus)
        return Linear(unknowns=self.unknowns, factors=(factor,), constant=self.constant)


@dataclass(frozen=True, kw_only=True, eq=False)
class LargerOf(Size):
    """The larger of two numbers times ``factors``, without signs."""

    factors: tuple[float, float]

    def value(self, u: Array) -> Array:
        found: Array = np.max(np.abs(u) * self.factors, axis=1)
        return found

    def gradient(self, u: Array) -> Array:
        sizes = np.abs(u) * self.factors
        first = (sizes[:, 0] >= sizes[:, 1])[:, None]
        chosen = np.where(np.concatenate([first, ~first], axis=1), self.factors, 0.0)
        return chosen * np.where(u >= 0.0, 1.0, -1.0)

    def bend(self, u: Array, reach: Array) -> Array:
        sizes = np.abs(u) * self.factors
        apart = np.abs(sizes[:, 0] - sizes[:, 1])
        return np.where(reach * sum(self.factors) < apart, 0.0, np.inf)

    def side(self, u: Array) -> int:
        larger = int(np.argmax(np.abs(u) * self.factors))
        return larger + 1 if u[larger] >= 0.0 else -larger - 1

    def inside(self, u: Array, side: int) -> Array:
        larger = abs(side) - 1
        other = np.abs(u[:, 1 - larger]) * self.factors[1 - larger]
        found: Array = np.sign(side) * u[:, larger] * self.factors[larger] - other
        return found

    def smooth(self, side: int) -> Linear:
        larger = abs(side) - 1
        factors = [0.0, 0.0]
        factors[larger] = math.copysign(self.factors[larger], side)
        return Linear(unknowns=self.unknowns, factors=tuple(factors))


@dataclass(frozen=True, kw_only=True, eq=False)
class Linear(Size):
    """A sum of unknowns times ``factors`` and a constant: another size on one side of its edges."""

    factors: tuple[Array | float, ...]
    constant: float = 0.0

    def value(self, u: Array) -> Array:
        found: Array = self.constant + (u * self.gradient(u)).sum(axis=1)
        return found

    def gradient(self, u: Array) -> Array:
        found = np.empty_like(u)
        for k, factor in enumerate(self.factors):
            found[:, k] = factor
        return found

    def bend(self, u: Array, reach: Array) -> Array:
        return np.zeros(len(u))

    def rows(self, which: IndexArray) -> Linear:
        return replace(self, factors=tuple(_in_rows(factor, which) for factor in self.factors))


def _in_rows(factor: Array | float, which: IndexArray) -> Array | float:
    return factor[which] if isinstance(factor, np.ndarray) and factor.ndim else factor


# ----------------------------------------------------------------------
# Reactions and the forces that follow from them, solved together: friction acts on the reactions
# that cause it.
#
# With s the sizes of what follows, reactions are r = r₀ + Σ s_k a_k, eq. (75), and the sizes are
# s_j = λ σ_j(r), with λ = 1. Without friction, at λ = 0, the solution is known; the branch is
# followed from there to λ = 1. It ends before that where friction locks the mechanism.


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
        fine = np.isfinite(self.start).all(axis=(1, 2))
        fine &= np.isfinite(self.change).all(axis=(1, 2, 3))
        s[fine], found[fine], proved[fine] = self.rows(np.flatnonzero(fine))._solve_finite()
        return Coupled(sizes=s, found=found, proved=proved)

    def _solve_finite(self) -> tuple[Array, BoolArray, BoolArray]:
        """The columns of :class:`Coupled`; all rows have finite coefficients."""
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
        return np.where(complete[:, None], at, np.nan), complete, direct

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
