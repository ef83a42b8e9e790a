"""Square systems of polynomial equations, as the tracking of their solutions sees them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Protocol

import numpy as np

from linkwork.circuits.results import PathCount
from linkwork.core.foundation.arrays import Array, ComplexArray, CountArray, IndexArray, solutions
from linkwork.core.numerics.bilinear import BilinearSystem

SAME_ROOT = 1e-6  # two solutions are the same one
_POLISH = 12  # steps of Newton's method at most


class PolynomialSystem(Protocol):
    """n equations in n complex unknowns."""

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """F, (B, n), and its derivative, (B, n, n), at x (B, n)."""


class ClosureSystem(PolynomialSystem, Protocol):
    """Polynomials that follow from closures, ``left`` (L, K) of U and ``right`` of V."""

    @property
    def left(self) -> ComplexArray: ...

    @property
    def right(self) -> ComplexArray: ...


@dataclass(frozen=True, kw_only=True, eq=False)
class Roots:
    """Isolated solutions of one system, and the outcome of every path.

    Parameters
    ----------
    x : (R, n) complex
        Regular finite solutions.
    multiple : (S, n) complex
        Ends of paths at singular finite solutions, one for each cluster.
    paths, at_infinity, singular, failed : int
        Paths tracked; those that ran to infinity, ended at a singular solution, were lost.
    expected : int
        How many solutions random systems of this structure have.
    sure : bool
        Whether that number was confirmed.
    continuum : bool
        Whether a singular end belongs to a curve of solutions.
    curves : (C, n) complex
        Points on such curves, as far as they are known.
    """

    x: ComplexArray
    multiple: ComplexArray
    paths: int
    at_infinity: int
    singular: int
    failed: int
    expected: int
    sure: bool
    continuum: bool
    curves: ComplexArray

    @property
    def accounted_for(self) -> bool:
        """Whether every path has an end of its own."""
        return self.paths == len(self.x) + self.at_infinity + self.singular and not self.failed

    def counted(
        self, unknowns: tuple[str, ...], real: int, bound: int, theorem: str = ""
    ) -> PathCount:
        """The counts of all ends, and of ``real`` solutions."""
        return PathCount(
            unknowns=unknowns,
            paths=self.paths,
            finite=len(self.x),
            real=real,
            at_infinity=self.at_infinity,
            multiple=self.singular,
            failed=self.failed,
            expected=self.expected,
            bound=bound,
            theorem=theorem,
        )


def polish_roots(system: PolynomialSystem, x: ComplexArray) -> tuple[ComplexArray, CountArray]:
    """Newton's method from x (B, n) until nothing changes; the steps taken, -1 if it failed."""
    x = x.copy()
    steps = np.full(len(x), -1, dtype=np.int64)
    live = np.arange(len(x))
    last = np.full(len(x), np.inf)
    for k in range(_POLISH):
        f, j = system.residual_and_jacobian(x[live])
        change = solutions(j, f[:, :, None])[:, :, 0]
        x[live] -= change
        size = np.abs(change).max(axis=1, initial=0.0)
        size /= 1.0 + np.abs(x[live]).max(axis=1, initial=0.0)
        # no longer quadratic: what remains is rounding
        done = (size <= 1e-13) | ((size <= 1e-8) & (size > 0.25 * last))  # rounding is all
        steps[live[done]] = k + 1
        stay = ~done & np.isfinite(size)
        live, last = live[stay], size[stay]
        if not len(live):
            break
    return x, steps


def distinct_solutions(x: ComplexArray, same: float = SAME_ROOT) -> ComplexArray:
    """The rows of (B, n) without repetitions, first ones kept."""
    kept: list[int] = []
    for k in range(len(x)):
        size = 1.0 + np.abs(x[k]).max()
        if not kept or np.abs(x[kept] - x[k]).max(axis=1).min() >= same * size:
            kept.append(k)
    return x[kept]


def nearest_solution(system: PolynomialSystem, x: ComplexArray, steps: int) -> ComplexArray:
    """Gauss-Newton with the shortest corrections."""
    for _ in range(steps):
        f, jacobian = system.residual_and_jacobian(x[None])
        if not math.isfinite(float(np.abs(f).max())):
            break
        x = x - np.linalg.lstsq(jacobian[0], f[0], rcond=1e-7)[0]
    return x


# ----------------------------------------------------------------------
# The two homotopies of bilinear systems: from products of linear forms, and between parameters.
#
# Both run in null-space coordinates û, v̂ ∈ P^L with (U, 1) = N û, each on a random patch û = a + Q
# w, a the patch's nearest point to zero. Towards a system with closure matrix C1 from one with C0,
#
#     N(σ) = N1 - M1 X(σ),   ((1 - σ) C1 + σ C0) N(σ) = 0,
#
# with orthonormal N1 in the null space and M1 in the row space of C1. One eigenvalue decomposition
# of (C1 M1)⁻¹ C0 M1 gives X at every σ without solving again.


def null_space(closure: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Orthonormal bases of the null space, (K, K - L), and row space, (K, L), of (L, K)."""
    loops = len(closure)
    _, _, rows = np.linalg.svd(closure)
    return rows[loops:].conj().T, rows[:loops].conj().T


def normal_numbers(rng: np.random.Generator, *shape: int) -> ComplexArray:
    """Random complex numbers with normally distributed parts."""
    drawn: ComplexArray = rng.normal(size=shape) + 1j * rng.normal(size=shape)
    return drawn


def closure_phases(
    start: ClosureSystem, goal: ClosureSystem, rng: np.random.Generator, nearest: bool
) -> ComplexArray:
    """Phases (2,) for both closure matrices of the start.

    Solutions do not change when a closure matrix is multiplied by a phase, but the path does:
    phases are those that bring start and goal ``nearest`` together, or random ones.
    """
    turns: ComplexArray = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, 2))
    if not nearest:
        return turns
    # the phase that makes the scalar product of both matrices real and positive
    pairs = ((start.left, goal.left), (start.right, goal.right))
    return np.array([np.exp(1j * np.angle(np.vdot(a, b))) for a, b in pairs])


def _patch(rng: np.random.Generator, size: int) -> ComplexArray:
    """[a, Q]: a random unit vector and an orthonormal basis of its complement."""
    q, _ = np.linalg.qr(normal_numbers(rng, size, size))
    return np.asarray(q, dtype=complex)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Patched:
    """The common part of both homotopies: patches, null spaces, products of a bilinear system."""

    rows: IndexArray
    patches: tuple[ComplexArray, ComplexArray]
    spaces: tuple[ComplexArray, ComplexArray]

    def points(self, w: ComplexArray) -> tuple[ComplexArray, Array]:
        """(U, V), (B, 2M), and the smaller homogenising coordinate of unit vectors, (B,)."""
        halves = np.split(w, 2, axis=1)
        ends = [self.off_patch(k, halves[k]) @ self.spaces[k].T for k in range(2)]
        scale: Array = np.minimum(*(np.abs(z[:, -1]) for z in ends))
        with np.errstate(all="ignore"):
            x = np.concatenate([z[:, :-1] / z[:, -1:] for z in ends], axis=1)
        return x, scale

    def on_patch(self, which: int, z: ComplexArray) -> ComplexArray:
        """The coordinates w (B, L) of points û (B, L + 1)."""
        turned = z @ self.patches[which].conj()
        w: ComplexArray = turned[:, 1:] / turned[:, :1]
        return w

    def off_patch(self, which: int, w: ComplexArray) -> ComplexArray:
        """û of unit length, (B, L + 1)."""
        z = np.concatenate([np.ones((len(w), 1)), w], axis=1) @ self.patches[which].T
        unit: ComplexArray = z / np.linalg.norm(z, axis=1)[:, None]
        return unit


@dataclass(frozen=True, kw_only=True, eq=False)
class StartHomotopy(_Patched):
    """σ γ (a_k û)(b_k v̂) + (1 - σ) (the system's products), C(2L, L) paths.

    ``on_patches``: the null spaces in the patches' coordinates; ``forms`` (2, M, L + 1): a and b.
    """

    on_patches: tuple[ComplexArray, ComplexArray]
    forms: ComplexArray
    gamma: complex

    @classmethod
    def of(cls, system: BilinearSystem, rng: np.random.Generator) -> StartHomotopy:
        """A random start system for a bilinear system."""
        loops, m = system.loops, system.size
        patches = (_patch(rng, loops + 1), _patch(rng, loops + 1))
        spaces = (null_space(system.left)[0], null_space(system.right)[0])
        forms = normal_numbers(rng, 2, m, loops + 1) / np.sqrt(2.0 * loops)
        angle = rng.uniform(0.0, 2.0 * np.pi)
        return cls(
            rows=system.rows,
            patches=patches,
            spaces=spaces,
            on_patches=(spaces[0] @ patches[0], spaces[1] @ patches[1]),
            forms=np.stack([forms[0] @ patches[0], forms[1] @ patches[1]]),
            gamma=complex(np.exp(1j * angle)),
        )

    def starts(self) -> ComplexArray:
        """All solutions at σ = 1: L of the forms vanish at û, the others at v̂."""
        m, size = self.forms.shape[1:]
        found = []
        for chosen in combinations(range(m), size - 1):
            others = [k for k in range(m) if k not in chosen]
            half = [null_space(self.forms[0, list(chosen)])[0][:, 0]]
            half.append(null_space(self.forms[1, others])[0][:, 0])
            found.append(np.concatenate([z[1:] / z[0] for z in half]))
        return np.array(found)

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """H, ∂H/∂w and ∂H/∂σ."""
        loops = w.shape[1] // 2
        (nu, nv), (a, b) = self.on_patches, self.forms
        one = np.ones((len(w), 1))
        wu = np.concatenate([one, w[:, :loops]], axis=1)
        wv = np.concatenate([one, w[:, loops:]], axis=1)
        u, v = wu @ nu.T, wv @ nv.T
        s, t = wu @ a.T, wv @ b.T
        p, q, p1, q1 = self.rows
        g, f = self.gamma * s * t, u[:, p] * v[:, q] - u[:, p1] * v[:, q1]
        x = sigma[:, None]
        y = (1.0 - sigma)[:, None, None]
        z = (self.gamma * sigma)[:, None, None]
        left = y * (v[:, q, None] * nu[p, 1:] - v[:, q1, None] * nu[p1, 1:])
        left += z * t[:, :, None] * a[:, 1:]
        right = y * (u[:, p, None] * nv[q, 1:] - u[:, p1, None] * nv[q1, 1:])
        right += z * s[:, :, None] * b[:, 1:]
        return x * g + (1.0 - x) * f, np.concatenate([left, right], axis=2), g - f  # eq. (47)


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterHomotopy(_Patched):
    """The system itself, its closure matrices moving from generic ones to those wanted.

    N(σ) = base - wide · diag(g(σ)) · kernel with g_i = σ / (σ pole_i + 1 - σ), for both sides
    (first axis) and for the 2M rows that the products take: first factors, then second ones, those
    of the right side negated.
    """

    base: ComplexArray
    wide: ComplexArray
    kernel: ComplexArray
    pole: ComplexArray

    @classmethod
    def between(
        cls,
        start: BilinearSystem,
        goal: BilinearSystem,
        rng: np.random.Generator,
        *,
        nearest: bool = False,
    ) -> ParameterHomotopy:
        """A path of systems; see :func:`closure_phases`."""
        loops = goal.loops
        patches = (_patch(rng, loops + 1), _patch(rng, loops + 1))
        turns = closure_phases(start, goal, rng, nearest)
        pairs = ((start.left, goal.left), (start.right, goal.right))
        p, q, p1, q1 = goal.rows
        signs = np.ones((2 * goal.size, 1))
        sides = []
        for k, taken in enumerate((np.append(p, p1), np.append(q, q1))):
            c0, c1 = turns[k] * pairs[k][0], pairs[k][1]
            null, rows = null_space(c1)
            end = c1 @ rows
            pole, vectors = np.linalg.eig(np.linalg.solve(end, c0 @ rows))
            kernel = np.linalg.solve(vectors, np.linalg.solve(end, c0 @ null))
            base = signs * (null @ patches[k])[taken]
            wide = signs * (rows @ vectors)[taken]
            sides.append((null, base, wide, kernel @ patches[k], pole))
            signs[goal.size :] = -1.0
        parts = [np.stack(part) for part in zip(*sides, strict=True)]
        return cls(
            rows=goal.rows,
            patches=patches,
            spaces=(parts[0][0], parts[0][1]),
            base=parts[1],
            wide=parts[2],
            kernel=parts[3],
            pole=parts[4],
        )

    def starts(self, x: ComplexArray) -> ComplexArray:
        """w (B, M) of solutions (U, V) (B, 2M) of the start system."""
        m = x.shape[1] // 2
        one = np.ones((len(x), 1))
        halves = (x[:, :m], x[:, m:])
        return np.concatenate(
            [
                self.on_patch(k, np.concatenate([half, one], axis=1) @ self.spaces[k].conj())
                for k, half in enumerate(halves)
            ],
            axis=1,
        )

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """H, ∂H/∂w and ∂H/∂σ."""
        count, m = w.shape
        x = sigma[:, None, None]
        under = 1.0 / (x * (self.pole - 1.0) + 1.0)
        z = np.ones((count, 2, m // 2 + 1, 1), dtype=complex)
        z[:, :, 1:, 0] = w.reshape(count, 2, m // 2)
        n = self.base - (self.wide * (x * under)[:, :, None, :]) @ self.kernel  # eq. (48)
        both = n @ z  # (B, 2, 2M, 1): the factors of every product
        rate = -(self.wide @ ((under * under)[:, :, :, None] * (self.kernel @ z)))
        others = both[:, ::-1]
        slopes = others * n[:, :, :, 1:]
        jacobian = (slopes[:, :, :m] + slopes[:, :, m:]).transpose(0, 2, 1, 3)
        value = (both[:, 0] * both[:, 1])[:, :, 0]
        change = (rate * others).sum(axis=1)[:, :, 0]
        return (
            value[:, :m] + value[:, m:],
            jacobian.reshape(count, m, m),
            change[:, :m] + change[:, m:],
        )
