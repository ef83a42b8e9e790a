"""Columns of closure matrices as sums of free coefficients: the structure of a family.

A link with three joints enters the loops with a, b and a + b, and loops that do not pass it
with 0. Which coefficients of a column are zero, and which are sums of others, is the same for all
mechanisms of one structure; the free coefficients are their dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import product

import numpy as np

from linkwork.core.foundation.arrays import (
    PROOF_SLACK,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
    Numbers,
    inverses,
    matrix_vector,
)
from linkwork.core.numerics.kantorovich import radii

#: For every column of a closure matrix its L coefficients as tuples of weights of free ones.
Columns = tuple[tuple[tuple[int, ...], ...], ...]

_SAME_SUM = 1e-11  # relative: two sums of coefficients are the same by construction
_LARGEST_FREE = 6  # coefficients of a column among which sums are looked for
_ROUNDING = 64 * UNIT_ROUNDOFF  # of coefficients of a column, relative to the largest


def columns_of(closures: ComplexArray) -> Columns:
    """The columns of a closure matrix (L, K) as sums of free coefficients."""
    return tuple(_sums(column.tolist()) for column in closures.T)


def random_closures(columns: Columns, rng: np.random.Generator) -> ComplexArray:
    """A closure matrix (L, K) with such columns."""
    parts = []
    for column in columns:
        weights = np.array(column, dtype=float)
        free = rng.normal(size=weights.shape[1]) + 1j * rng.normal(size=weights.shape[1])
        parts.append(weights @ free)
    return np.stack(parts, axis=1)


def sums_hold(columns: Columns, closures: ComplexArray, spread: Array) -> bool:
    """Whether all sums of a closure matrix (L, K) hold within rounding.

    Parameters
    ----------
    spread : (L, K)
        How far each coefficient may be from its true value.

    Notes
    -----
    :func:`columns_of` takes coefficients for sums that differ from them by more than that: good
    enough for a random relative, not for a proof.
    """
    made = _as_sums(columns)
    apart = np.abs((made @ closures.T[:, :, None])[:, :, 0].T - closures)
    unsure = spread + (np.abs(made) @ spread.T[:, :, None])[:, :, 0].T
    rounding = _ROUNDING * np.abs(closures).max(axis=0)
    return bool((apart <= np.minimum(unsure, rounding)).all())


@cache
def _as_sums(columns: Columns) -> Array:
    """(K, L, L): every column as sums of its own coefficients, the free ones as themselves."""
    loops = len(columns[0])
    made = np.zeros((len(columns), loops, loops))
    for matrix, column in zip(made, columns, strict=True):
        width = len(column[0])
        first = [column.index(tuple(int(j == k) for j in range(width))) for k in range(width)]
        matrix[:, first] = column
    return made


def column_ranks(columns: Columns) -> list[int]:
    """The rank of every set of columns for almost all values of the free coefficients.

    A set of columns, as a bit mask s, has rank r(s) = min over its subsets k of
    f(k) + |s| - |k|, where f is the rank of all vectors that free coefficients of k multiply (Rado
    1942, Q. J. Math. 13, 83): determinants are sums of different monomials, one for each choice of
    a vector per column. Integers, so nothing is rounded.
    """
    loops = len(columns[0])
    vectors = [tuple(zip(*column, strict=True)) for column in columns]
    spans: list[tuple[_Pivoted, ...]] = [()]
    ranks = [0]  # f(s) - |s| first, then r(s) - |s|
    for chosen in vectors:
        for span, rank in zip(spans[:], ranks[:], strict=True):
            wider = _span(span, chosen, loops)
            spans.append(wider)
            ranks.append(rank + len(wider) - len(span) - 1)
    for k in range(len(columns)):
        bit = 1 << k
        for s in range(len(ranks)):
            if s & bit:
                # minimum over subsets, one element at a time
                ranks[s] = min(ranks[s], ranks[s ^ bit])
    return [rank + s.bit_count() for s, rank in enumerate(ranks)]


def rank_together(columns: Columns) -> int:
    """The rank of all vectors that free coefficients of some columns multiply."""
    vectors = [vector for column in columns for vector in zip(*column, strict=True)]
    return len(_span((), vectors, len(columns[0])))


_Pivoted = tuple[int, tuple[int, ...]]


def _span(
    span: tuple[_Pivoted, ...], vectors: Sequence[tuple[int, ...]], most: int
) -> tuple[_Pivoted, ...]:
    """A basis in echelon form, with the pivots' places, and further vectors."""
    for vector in vectors:
        if len(span) == most:
            break
        for place, row in span:
            if vector[place]:
                a, b = row[place], vector[place]
                vector = tuple(a * x - b * y for x, y in zip(vector, row, strict=True))
        pivot = next((k for k, x in enumerate(vector) if x), None)
        if pivot is not None:
            span = (*span, (pivot, vector))
    return span


def _sums(column: list[complex]) -> tuple[tuple[int, ...], ...]:
    """Every coefficient of a column as a sum, with weights -1, 0 and 1, of earlier free ones."""
    size = max(map(abs, column))
    free: list[complex] = []
    found: list[tuple[int, ...]] = []
    for value in column:
        few = free[:_LARGEST_FREE]
        # 0 first: a sparse sum before a dense one
        for weights in product((0, 1, -1), repeat=len(few)):
            rest = value - sum(w * c for w, c in zip(weights, few, strict=True))
            if abs(rest) <= _SAME_SUM * size:
                found.append(weights)
                break
        else:
            found.append((*(0 for _ in free), 1))
            free.append(value)
    width = len(free)
    return tuple((*weights, *(0 for _ in range(width - len(weights)))) for weights in found)


# ----------------------------------------------------------------------
# Bilinear systems: the closures of a planar mechanism with its directions as unknowns.
#
# Unknowns U and V, M = 2L complex numbers each, satisfy L linear equations each and M products:
#
#     left · (U, 1) = 0,     right · (V, 1) = 0,     U_p V_q = U_p' V_q'     (index M: the 1).
#
# With U = e^{iθ} and V = e^{-iθ}: U_k V_k = 1 for an angle, U_z = V_z for a length along a fixed
# direction, U_z V_a = U_a V_z for one along a turning direction (Wampler 2001, J. Mech. Des. 123,
# 382). The system of a real mechanism has right = conj(left), and its real solutions have
# V = conj(U). On the two null spaces the M products are bilinear equations in P^L × P^L.


@dataclass(frozen=True, kw_only=True, eq=False)
class BilinearSystem:
    """One system, or B systems with the same products.

    Parameters
    ----------
    left, right : (L, M + 1) or (B, L, M + 1) complex
        Sizes of order one: lengths are divided by a length of the mechanism.
    rows : (4, M) int
        p, q, p', q' of every product.
    """

    left: ComplexArray
    right: ComplexArray
    rows: IndexArray

    @property
    def loops(self) -> int:
        """L."""
        return int(self.left.shape[-2])

    @property
    def size(self) -> int:
        """M = 2L, the unknowns in U and in V."""
        return 2 * self.loops

    @property
    def products(self) -> tuple[tuple[int, ...], ...]:
        """``rows`` as plain numbers."""
        return tuple(map(tuple, self.rows.tolist()))

    @property
    def _curvature(self) -> Array:
        """(M,) bounds of the second derivative of every product along unit directions."""
        one = self.size
        p, q, p1, q1 = self.rows
        kappa: Array = 2.0 * (((p != one) & (q != one)).astype(float))
        kappa += 2.0 * ((p1 != one) & (q1 != one))
        return kappa

    def take(self, index: IndexArray) -> BilinearSystem:
        """Some of B systems, (R,), each as often as it is named."""
        return replace(self, left=self.left[index], right=self.right[index])

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """F, (B, 2M), and its derivative, (B, 2M, 2M), at x = (U, V), (B, 2M)."""
        count, m, loops = len(x), self.size, self.loops
        u, v = _with_one(x[:, :m]), _with_one(x[:, m:])
        p, q, p1, q1 = self.rows
        # eq. (45)
        products = u[:, p] * v[:, q] - u[:, p1] * v[:, q1]
        f = np.concatenate([_rows_at(self.left, u), _rows_at(self.right, v), products], axis=1)
        wide = np.zeros((count, 2 * m, 2, m + 1), dtype=complex)
        wide[:, :loops, 0] = self.left
        wide[:, loops:m, 1] = self.right
        r = np.arange(m, 2 * m)
        wide[:, r, 0, p] += v[:, q]
        wide[:, r, 0, p1] -= v[:, q1]
        wide[:, r, 1, q] += u[:, p]
        wide[:, r, 1, q1] -= u[:, p1]
        return f, wide[:, :, :, :m].reshape(count, 2 * m, 2 * m)


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvedRoots:
    """The proofs of roots x (R, 2M): ``holds`` (R,), and ``real`` or ``unreal``.

    A root is neither if that could not be decided. ``radius`` (R,): how far it is from x at most.
    """

    x: ComplexArray
    holds: BoolArray
    real: BoolArray
    unreal: BoolArray
    radius: Array

    @property
    def apart(self) -> bool:
        """Whether no two proved roots are the same."""
        x, radius = self.x[self.holds], PROOF_SLACK * self.radius[self.holds]
        return all(
            (np.abs(x[k:] - x[k - 1]).max(axis=1) > radius[k:] + radius[k - 1]).all()
            for k in range(1, len(x))
        )

    def take(self, index: IndexArray) -> ProvedRoots:
        """Some of the roots."""
        return ProvedRoots(
            x=self.x[index],
            holds=self.holds[index],
            real=self.real[index],
            unreal=self.unreal[index],
            radius=self.radius[index],
        )


def _rows_at(rows: Numbers, u: Numbers) -> Numbers:
    """Rows (L, K), or (B, L, K), times vectors (B, K): (B, L)."""
    return u @ rows.T if rows.ndim == 2 else matrix_vector(rows, u)


def _with_one(u: ComplexArray) -> ComplexArray:
    """(U, 1), (B, M + 1)."""
    padded = np.ones((len(u), u.shape[1] + 1), dtype=complex)
    padded[:, :-1] = u
    return padded


def prove_roots(system: BilinearSystem, x: ComplexArray, spread: Array) -> ProvedRoots:
    """Newton-Kantorovich for complex roots, largest norm; for any coefficients within ``spread``.

    Parameters
    ----------
    system : BilinearSystem
        One, or that of each root.
    x : (R, 2M)
    spread : (L, M + 1) or (R, L, M + 1)
        How far each coefficient of ``left`` (and of ``right``) may be from its true value.

    Notes
    -----
    Products have constant second derivatives, so that ω does not depend on ρ. A root is real if the
    conjugate of its box meets the ball in which it is the only one, and not real if the two boxes
    are apart.
    """
    m = system.size
    f, j = system.residual_and_jacobian(x)
    a = inverses(j)
    a = np.where(np.isfinite(a).all(axis=(1, 2), keepdims=True), a, 0.0)  # then Z0 ≥ 1
    size = np.abs(a)
    u, v = np.abs(_with_one(x[:, :m])), np.abs(_with_one(x[:, m:]))
    p, q, p1, q1 = system.rows
    weight = 8.0 * (m + 6) * UNIT_ROUNDOFF
    slip = spread + weight * np.abs(system.left)
    slip_right = spread + weight * np.abs(system.right)
    products = u[:, p] * v[:, q] + u[:, p1] * v[:, q1]
    parts = [_rows_at(slip, u), _rows_at(slip_right, v), weight * products]
    error = np.concatenate(parts, axis=1)
    blur = np.zeros((*slip.shape[:-2], 2 * m, 2 * m))
    blur[..., : system.loops, :m] = slip[..., :m]
    blur[..., system.loops : m, m:] = slip_right[..., :m]
    y = np.abs(matrix_vector(a, f)) + matrix_vector(size, error + weight * np.abs(f))
    z = np.abs(np.eye(2 * m) - a @ j) + size @ (blur + weight * np.abs(j))
    y_max, z_max = PROOF_SLACK * y.max(axis=1), PROOF_SLACK * z.sum(axis=2).max(axis=1)
    omega = PROOF_SLACK * (size[:, :, m:] @ system._curvature).max(axis=1)
    holds, exists, unique, _ = radii(y_max, z_max, omega, np.zeros_like(omega))
    # a real root has V = conj(U), so it is its own mirror image
    mirrored = np.concatenate([x[:, m:], x[:, :m]], axis=1).conj()
    gap = np.abs(x - mirrored).max(axis=1, initial=0.0)
    return ProvedRoots(
        x=x,
        holds=holds,
        real=holds & (gap + exists < unique),  # eq. (52)
        unreal=holds & (gap > 2.0 * exists * PROOF_SLACK),
        radius=exists,
    )
