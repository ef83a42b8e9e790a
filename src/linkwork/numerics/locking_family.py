"""All dead points of a family of mechanisms: homotopies of :class:`LockingSystem`.

Unknowns are the homogeneous X = ((U, 1), (V, 1), ρ), each of the three on a random patch, so all
equations are at most quadratic in X and their coefficients run straight from start to goal.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.numerics.bilinear_family import Columns, columns_of, random_closures
from linkwork.numerics.bilinear_homotopy import null_space
from linkwork.numerics.generic_roots import SEED, isolated_roots
from linkwork.numerics.locking_system import LockingSystem, Slot
from linkwork.numerics.polynomial_system import Roots

__all__ = ["LockingFamily", "locking_roots"]


def _normal(rng: np.random.Generator, *shape: int) -> ComplexArray:
    drawn: ComplexArray = rng.normal(size=shape) + 1j * rng.normal(size=shape)
    return drawn


@dataclass(frozen=True, kw_only=True, eq=False)
class _Straight:
    """σ (K0 X, ½ XᵀT0X) + (1 - σ) (K1 X, ½ XᵀT1X) = 0 on ``patches`` (3, N) X = 1.

    ``linear`` (2, C, N): K0, K1. ``slopes`` (2, N, E N): T0, T1, as X -> XᵀT.
    """

    goal: LockingSystem
    patches: ComplexArray
    linear: ComplexArray
    slopes: ComplexArray

    @classmethod
    def of(
        cls,
        goal: LockingSystem,
        rng: np.random.Generator,
        linear: ComplexArray,
        quadratic: ComplexArray,
    ) -> _Straight:
        """From a start with these closures and products."""
        size = goal.parts[2].stop
        patches = np.zeros((3, size), dtype=complex)
        for k, part in enumerate(goal.parts):
            patches[k, part] = _normal(rng, part.stop - part.start)
        both = [t.transpose(1, 0, 2).reshape(size, -1) for t in (quadratic, goal.quadratic)]
        return cls(
            goal=goal,
            patches=patches,
            linear=np.stack([linear, goal.linear]),
            slopes=np.stack(both),
        )

    def points(self, w: ComplexArray) -> tuple[ComplexArray, Array]:
        """x (B, n), and the smaller homogenising coordinate of unit vectors, (B,)."""
        x, last = self.goal.points(w)
        scale: Array = np.abs(last).min(axis=0)
        return x, scale

    def on_patches(self, whole: ComplexArray) -> ComplexArray:
        """X (B, N), each part on its patch."""
        placed = whole.copy()
        for patch, part in zip(self.patches, self.goal.parts, strict=True):
            placed[:, part] /= (whole[:, part] @ patch[part])[:, None]
        return placed

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """H, ∂H/∂w and ∂H/∂σ."""
        count, size = w.shape
        (k0, k1), (t0, t1) = self.linear, self.slopes
        s0, s1 = ((w @ t).reshape(count, t.shape[1] // size, size) for t in (t0, t1))
        f0, f1 = (
            np.concatenate([w @ k.T, 0.5 * (s @ w[:, :, None])[:, :, 0]], axis=1)
            for k, s in ((k0, s0), (k1, s1))
        )
        x = sigma[:, None]
        y = sigma[:, None, None]
        jacobian = np.empty((count, size, size), dtype=complex)
        lines = len(k0)
        jacobian[:, :lines] = y * k0 + (1.0 - y) * k1
        jacobian[:, lines:-3] = y * s0 + (1.0 - y) * s1
        jacobian[:, -3:] = self.patches
        value = np.concatenate([x * f0 + (1.0 - x) * f1, w @ self.patches.T - 1.0], axis=1)
        change = np.concatenate([f0 - f1, np.zeros((count, 3))], axis=1)
        return value, jacobian, change


@dataclass(frozen=True, kw_only=True, eq=False)
class _FromProducts(_Straight):
    """With products of linear forms instead of the quadratic equations.

    ``forms`` (2, E, N): both factors; the first is one of (U, 1) or (V, 1), the second of (V, 1) or
    ρ.
    """

    forms: ComplexArray

    @classmethod
    def to(cls, goal: LockingSystem, rng: np.random.Generator) -> _FromProducts:
        """A random start."""
        u, v, rates = goal.parts
        own, count = goal.own, goal.size
        forms = np.zeros((2, count + 2 * own, rates.stop), dtype=complex)
        kinds = [(u, v)] * count + [(u, rates)] * own + [(v, rates)] * own
        for k, pair in enumerate(kinds):
            for side, part in enumerate(pair):
                width = part.stop - part.start
                forms[side, k, part] = _normal(rng, width) / np.sqrt(width)
        turn = np.exp(2j * np.pi * rng.uniform())
        product = turn * forms[0][:, :, None] * forms[1][:, None, :]
        quadratic = product + product.transpose(0, 2, 1)
        straight = _Straight.of(goal, rng, goal.linear, quadratic)
        return cls(
            goal=goal,
            patches=straight.patches,
            linear=straight.linear,
            slopes=straight.slopes,
            forms=forms,
        )

    def starts(self) -> ComplexArray:
        """2 own C(2L + 1, L): one row of the rates vanishes at U or V, the others at ρ."""
        goal = self.goal
        u, v, rates = goal.parts
        count, loops, own = goal.size, goal.loops, goal.own
        a, b = self.forms

        def point(part: slice, *rows: ComplexArray) -> ComplexArray:
            return null_space(np.concatenate(rows)[:, part])[0][:, 0]

        directions = []
        for row in range(2 * own):
            others = [count + k for k in range(2 * own) if k != row]
            directions.append(point(rates, b[others]))
        found = []
        for row in range(2 * own):
            on_u = row < own
            for some in combinations(range(count), loops if on_u else loops + 1):
                rest = [k for k in range(count) if k not in some]
                at_u = [*some, count + row] if on_u else list(some)
                x = np.zeros(rates.stop, dtype=complex)
                x[u] = point(u, self.linear[0, :loops], a[at_u])
                on_v = [b[rest]] if on_u else [b[rest], a[[count + row]]]
                x[v] = point(v, self.linear[0, loops:], *on_v)
                x[rates] = directions[row]
                found.append(x)
        return self.on_patches(np.array(found))


@dataclass(frozen=True, kw_only=True, eq=False)
class _FromRelative(_Straight):
    """From another member of the family."""

    def starts(self, x: ComplexArray) -> ComplexArray:
        """Solutions x (B, n) of the other member on the patches."""
        return self.on_patches(self.goal.whole(x))


@dataclass(frozen=True)
class LockingFamily:
    """Systems with the same products and rates and the same sums within columns."""

    rows: tuple[tuple[int, ...], ...]
    columns: Columns
    own: int
    slots: tuple[Slot, ...]

    @classmethod
    def of(cls, system: LockingSystem) -> LockingFamily:
        """The family of a system."""
        return cls(
            rows=tuple(map(tuple, system.rows.tolist())),
            columns=columns_of(system.left),
            own=system.own,
            slots=system.slots,
        )

    def random(self, rng: np.random.Generator) -> LockingSystem:
        """A member with random complex free coefficients."""
        left, right = (random_closures(self.columns, rng) for _ in range(2))
        return LockingSystem(
            left=left, right=right, rows=np.array(self.rows), own=self.own, slots=self.slots
        )

    def generator(self, purpose: int) -> np.random.Generator:
        """Random numbers of the family's own, the same in every run and in any order of calls."""
        flat = [self.own, *(k for row in self.rows for k in row)]
        flat += [w + 1 for column in self.columns for entry in column for w in (*entry, 2)]
        flat += [abs(round(w)) for slot in self.slots for w in slot]
        return np.random.default_rng([SEED, 1, purpose, *flat])

    def from_products(self, goal: LockingSystem, rng: np.random.Generator) -> _FromProducts:
        """2 own C(2L + 1, L) paths to all isolated solutions of a member."""
        return _FromProducts.to(goal, rng)

    def between(
        self,
        start: LockingSystem,
        goal: LockingSystem,
        rng: np.random.Generator,
        *,
        nearest: bool = False,
    ) -> _FromRelative:
        """Paths from member to member; phases of closures change the path but no solution."""
        turns = np.exp(2j * np.pi * rng.uniform(size=2))
        if nearest:
            pairs = ((start.left, goal.left), (start.right, goal.right))
            turns = np.array([np.exp(1j * np.angle(np.vdot(a, b))) for a, b in pairs])
        turned = replace(start, left=turns[0] * start.left, right=turns[1] * start.right)
        straight = _Straight.of(goal, rng, turned.linear, turned.quadratic)
        return _FromRelative(
            goal=goal,
            patches=straight.patches,
            linear=straight.linear,
            slopes=straight.slopes,
        )


def locking_roots(system: LockingSystem) -> Roots:
    """All isolated dead points, complex ones among them."""
    return isolated_roots(system, LockingFamily.of(system))
