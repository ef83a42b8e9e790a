"""Four bilinear equations in P² x P² as an eigenvalue problem.

Configurations of two loops, and dead points of one, are the common zeros of ûᵀ M_r v̂ = 0, r = 1..4:
six at most. With û = (1, s, t) and the equations times 1, s and s² the twelve monomials v̂_j s^k,
k = 0..3, satisfy twelve equations linear in t. The determinant of these is the resultant of four
forms of bidegree (1, 1) in P¹ x P² (Sturmfels & Zelevinsky 1994, J. Algebra 163, 115), so that its
zeros t are the solutions, and no others.

Nothing is claimed of the solutions: rounding may lose some. Where as many regular ones are found as
almost all members of a family have, these are all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from itertools import combinations, pairwise

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import (
    PolynomialSystem,
    Roots,
    closure_phases,
    distinct_solutions,
    normal_numbers,
    null_space,
    polish_roots,
)
from linkwork.circuits.homotopy.dead_points import (
    DeadPointSystem,
    most_dead_points,
)
from linkwork.circuits.homotopy.isolated_roots import RootFamily, isolated_roots
from linkwork.core.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.core.numerics.bilinear import BilinearSystem, columns_of

_INFINITE = 1e-7  # an eigenvalue this small belongs to an infinite t
_CLEAR = 1e6  # condition, and size: beyond them it is left to paths whether one is regular, finite
_FAR = 1e9  # size of what rounding makes of a solution at infinity


def roots_of_two_loops(system: BilinearSystem) -> ComplexArray:
    """Regular solutions (R, 8), all of them unless rounding or coincidence hides some."""
    spaces = null_space(system.left)[0], null_space(system.right)[0]
    u, v = _common_zeros(_product_forms(spaces, system.rows))
    return _regular(system, np.concatenate([_affine(u @ spaces[0].T), _affine(v @ spaces[1].T)], 1))


def dead_points_of_one_loop(system: DeadPointSystem) -> ComplexArray:
    """Regular solutions (R, 8), all of them unless rounding or coincidence hides some.

    The rates are eliminated: both rows of them are parallel.
    """
    spaces = null_space(system.left)[0], null_space(system.right)[0]
    turns = np.zeros((2, 2, 4), dtype=complex)  # of (U, 1) and (V, 1), by rate
    for column, factor, number, weight, mirrored in system.slots:
        turns[0, number, factor] += weight * system.left[-1, column]
        turns[1, number, factor] += mirrored * system.right[-1, column]
    a, b = turns[0] @ spaces[0], turns[1] @ spaces[1]
    parallel = np.outer(a[0], b[1]) - np.outer(a[1], b[0])
    u, v = _common_zeros(np.concatenate([_product_forms(spaces, system.rows), parallel[None]]))
    whole = u @ spaces[0].T, v @ spaces[1].T
    row = whole[0] @ turns[0].T
    rates = np.stack([row[:, 1], -row[:, 0]], axis=1)
    with np.errstate(all="ignore"):
        rates = rates / (rates @ system.norm)[:, None]
    return _regular(system, np.concatenate([*map(_affine, whole), rates], axis=1))


def _product_forms(spaces: tuple[ComplexArray, ComplexArray], rows: IndexArray) -> ComplexArray:
    """The products as forms (M, 3, 3) on the null spaces."""
    (nu, nv), (p, q, p1, q1) = spaces, rows
    before, behind = (nu[a][:, :, None] * nv[b][:, None, :] for a, b in ((p, q), (p1, q1)))
    forms: ComplexArray = before - behind
    return forms


def _common_zeros(forms: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """û and v̂, (K, 3), with ûᵀ M_r v̂ = 0 for the forms M (4, 3, 3); some of no solution, too."""
    turn, shift = _coordinates()
    size = np.abs(forms).max(axis=(1, 2), keepdims=True)
    m = np.einsum("ai,raj->irj", turn, forms / np.where(size > 0.0, size, 1.0))
    pencil = np.zeros((2, 3, 4, 4, 3), dtype=complex)  # power of t, times s^k, form, s^k', v̂
    for k in range(3):  # eq. (46a)
        pencil[0, k, :, k], pencil[0, k, :, k + 1], pencil[1, k, :, k] = m
    a, b = pencil.reshape(2, 12, 12)
    try:
        value, vector = np.linalg.eig(np.linalg.solve(a + shift * b, b))
    except np.linalg.LinAlgError:
        return np.zeros((0, 3), dtype=complex), np.zeros((0, 3), dtype=complex)
    finite = np.flatnonzero(np.abs(value) > _INFINITE)
    x = vector.T[finite].reshape(-1, 4, 3)
    with np.errstate(all="ignore"):
        below = x[:, :3].reshape(-1, 9)
        s = (below.conj() * x[:, 1:].reshape(-1, 9)).sum(axis=1) / (np.abs(below) ** 2).sum(axis=1)
    t = shift - 1.0 / value[finite]
    largest = np.linalg.norm(x, axis=2).argmax(axis=1)
    return np.stack([np.ones_like(s), s, t], axis=1) @ turn.T, x[np.arange(len(x)), largest]


@cache
def _coordinates() -> tuple[ComplexArray, complex]:
    """Coordinates of û in which no solution has û_0 = 0, and a t that belongs to none."""
    rng = np.random.default_rng(12)
    q, _ = np.linalg.qr(normal_numbers(rng, 3, 3))
    return np.asarray(q, dtype=complex), complex(normal_numbers(rng, 1)[0])


def _affine(whole: ComplexArray) -> ComplexArray:
    with np.errstate(all="ignore"):
        affine: ComplexArray = whole[:, :-1] / whole[:, -1:]
    return affine


def _regular(system: PolynomialSystem, x: ComplexArray) -> ComplexArray:
    """Different solutions near x (K, n) that are clearly regular and finite."""
    x = x[np.abs(x).max(axis=1) < _FAR]
    if not len(x):
        return x
    with np.errstate(all="ignore"):
        x, steps = polish_roots(system, x)
    x = x[(steps > 0) & (np.abs(x).max(axis=1) < _CLEAR)]
    x = x[np.linalg.cond(system.residual_and_jacobian(x)[1]) < _CLEAR]
    return distinct_solutions(x)


# ----------------------------------------------------------------------
# All dead points of a family of mechanisms: homotopies of :class:`DeadPointSystem`.
#
# Unknowns are the homogeneous X = ((U, 1), (V, 1), ρ), each of the three on a random patch, or
# coordinates w in which X is linear. So all equations are at most quadratic, and their coefficients
# run straight from start to goal.


@dataclass(frozen=True, kw_only=True, eq=False)
class _Straight:
    """σ (K0 w, ½ wᵀT0w) + (1 - σ) (K1 w, ½ wᵀT1w) = 0 on ``patches`` (3, n) w = 1.

    ``linear`` (2, C, n): K0, K1. ``slopes`` (2, n, E n): T0, T1, as w -> wᵀT. X = ``basis`` w with
    parts of w of their own for each of the three projective spaces.
    """

    goal: DeadPointSystem
    basis: ComplexArray
    parts: tuple[slice, ...]
    patches: ComplexArray
    linear: ComplexArray
    slopes: ComplexArray

    def points(self, w: ComplexArray) -> tuple[ComplexArray, Array]:
        """x (B, n), and the smaller homogenising coordinate of unit vectors, (B,)."""
        x, last = self.goal.points(w @ self.basis.T)
        scale: Array = np.abs(last).min(axis=0)
        return x, scale

    def on_patches(self, w: ComplexArray) -> ComplexArray:
        """w (B, n) with each part on its patch."""
        placed = w.copy()
        for patch, part in zip(self.patches, self.parts, strict=True):
            placed[:, part] /= (w[:, part] @ patch[part])[:, None]
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


def _patches(rng: np.random.Generator, parts: tuple[slice, ...]) -> ComplexArray:
    patches = np.zeros((3, parts[-1].stop), dtype=complex)
    for k, part in enumerate(parts):
        patches[k, part] = normal_numbers(rng, part.stop - part.start)
    return patches


def _as_slopes(quadratic: ComplexArray) -> ComplexArray:
    """w -> wᵀT of symmetric T (E, n, n)."""
    return quadratic.transpose(1, 0, 2).reshape(quadratic.shape[1], -1)


@dataclass(frozen=True, kw_only=True, eq=False)
class _FromProducts(_Straight):
    """With products of linear forms for the quadratic equations, in the closures' null space.

    ``forms`` (2, E, n): both factors; the first is one of (U, 1) or (V, 1), the second of (V, 1) or
    ρ.
    """

    forms: ComplexArray

    @classmethod
    def to(cls, goal: DeadPointSystem, rng: np.random.Generator) -> _FromProducts:
        """A random start."""
        own, count = goal.own, goal.size
        spaces = [null_space(goal.left)[0], null_space(goal.right)[0], np.eye(2 * own)]
        ends = np.cumsum([0, *(space.shape[1] for space in spaces)]).tolist()
        u, v, rates = parts = tuple(slice(a, b) for a, b in pairwise(ends))
        basis = np.zeros((goal.parts[2].stop, ends[-1]), dtype=complex)
        for space, there, here in zip(spaces, goal.parts, parts, strict=True):
            basis[there, here] = space
        forms = np.zeros((2, count + 2 * own, ends[-1]), dtype=complex)
        kinds = [(u, v)] * count + [(u, rates)] * own + [(v, rates)] * own
        for k, pair in enumerate(kinds):
            for side, part in enumerate(pair):
                width = part.stop - part.start
                forms[side, k, part] = normal_numbers(rng, width) / np.sqrt(width)
        turn = np.exp(2j * np.pi * rng.uniform())
        product = turn * forms[0][:, :, None] * forms[1][:, None, :]
        start = product + product.transpose(0, 2, 1)
        return cls(
            goal=goal,
            basis=basis,
            parts=parts,
            patches=_patches(rng, parts),
            linear=np.zeros((2, 0, ends[-1]), dtype=complex),
            slopes=np.stack([_as_slopes(t) for t in (start, basis.T @ goal.quadratic @ basis)]),
            forms=forms,
        )

    def starts(self) -> ComplexArray:
        """2 own C(2L + 1, L): one row of the rates vanishes at U or V, the others at ρ."""
        goal, (a, b) = self.goal, self.forms
        u, v, rates = self.parts
        count, loops, own = goal.size, goal.loops, goal.own

        def point(part: slice, forms: ComplexArray) -> ComplexArray:
            return null_space(forms[:, part])[0][:, 0]

        found = []
        for row in range(2 * own):
            others = [count + k for k in range(2 * own) if k != row]
            direction, mine = point(rates, b[others]), [count + row]
            on_u = row < own
            for some in combinations(range(count), loops if on_u else loops + 1):
                rest = [k for k in range(count) if k not in some]
                w = np.zeros(rates.stop, dtype=complex)
                w[u] = point(u, a[[*some, *mine]] if on_u else a[list(some)])
                w[v] = point(v, b[rest] if on_u else np.concatenate([b[rest], a[mine]]))
                w[rates] = direction
                found.append(w)
        return self.on_patches(np.array(found))


@dataclass(frozen=True, kw_only=True, eq=False)
class _FromRelative(_Straight):
    """From another member of the family; the closures move, so w = X."""

    @classmethod
    def between(
        cls, start: DeadPointSystem, goal: DeadPointSystem, rng: np.random.Generator
    ) -> _FromRelative:
        """With coefficients that run straight from one to the other."""
        return cls(
            goal=goal,
            basis=np.eye(goal.parts[2].stop, dtype=complex),
            parts=goal.parts,
            patches=_patches(rng, goal.parts),
            linear=np.stack([start.linear, goal.linear]),
            slopes=np.stack([_as_slopes(system.quadratic) for system in (start, goal)]),
        )

    def starts(self, x: ComplexArray) -> ComplexArray:
        """Solutions x (B, n) of the other member on the patches."""
        return self.on_patches(self.goal.whole(x))


@dataclass(frozen=True)
class DeadPointFamily(RootFamily[DeadPointSystem]):
    """Systems with the same products and rates and the same sums within columns."""

    @classmethod
    def of(cls, system: DeadPointSystem) -> DeadPointFamily:
        """The family of a system."""
        return cls(
            rows=tuple(map(tuple, system.rows.tolist())),
            columns=columns_of(system.left),
            own=system.own,
            slots=system.slots,
        )

    def complete(self, found: int) -> bool:
        """Whether this many solutions of a member are all, by Bézout's theorem."""
        return found == most_dead_points(self.own, len(self.rows[0]))

    def member(self, left: ComplexArray, right: ComplexArray) -> DeadPointSystem:
        """The member with these closures."""
        rows = np.array(self.rows)
        return DeadPointSystem(left=left, right=right, rows=rows, own=self.own, slots=self.slots)

    def from_products(self, goal: DeadPointSystem, rng: np.random.Generator) -> _FromProducts:
        """2 own C(2L + 1, L) paths to all isolated solutions of a member."""
        return _FromProducts.to(goal, rng)

    def between(
        self,
        start: DeadPointSystem,
        goal: DeadPointSystem,
        rng: np.random.Generator,
        *,
        nearest: bool = False,
    ) -> _FromRelative:
        """Paths from member to member; phases of closures change the path but no solution."""
        turns = closure_phases(start, goal, rng, nearest)
        turned = replace(start, left=turns[0] * start.left, right=turns[1] * start.right)
        return _FromRelative.between(turned, goal, rng)


def dead_point_roots(system: DeadPointSystem) -> Roots:
    """All isolated dead points, complex ones among them."""
    known = dead_points_of_one_loop(system) if system.loops == 1 else None
    return isolated_roots(system, DeadPointFamily.of(system), known)
