"""Bilinear systems of one loop in closed form, many at once.

On the null spaces û, v̂ ∈ C² the two products are ûᵀ M_r v̂ = 0, so ûᵀM_1 and ûᵀM_2 are parallel:
a quadratic form in û.
"""

from __future__ import annotations

import numpy as np

from linkwork.circuits.homotopy.counts import bound_by_products
from linkwork.circuits.homotopy.polynomial_system import Roots
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.numerics.bilinear import BilinearSystem

_DOUBLE = 1e-14  # discriminant, relative to its parts, that is zero within rounding
_NOTHING = 1e-13  # coefficients, relative to the products they come from, that are
_FINITE = 1e-9  # smallest homogenising coordinate, of vectors of length 1, of a finite solution
_ANY_U, _ANY_V = np.array([0.6, 0.8j]), np.array([0.8, 0.6j])


def quadratic_roots(systems: BilinearSystem) -> list[Roots]:
    """All solutions of each of B systems with one loop: two, unless there is a curve of them."""
    nu, nv = _null_spaces(systems.left), _null_spaces(systems.right)
    forms, size = _forms(nu, nv, systems.rows)
    a, b, c, d = (forms[:, r, k] for r in (0, 1) for k in (0, 1))
    quadratic = np.stack([_det(a, c), _det(a, d) + _det(b, c), _det(b, d)], axis=1)  # eq. (46)
    everywhere = np.abs(quadratic).max(axis=1) <= _NOTHING * size
    u, double = _zeros(quadratic)
    # any û has its v̂: one of them shows whether the curve is finite
    u[everywhere], double = _ANY_U, double & ~everywhere
    with np.errstate(all="ignore"):  # of zeros that do not count
        w = u[:, :, None, :1] * forms[:, None, :, 0] + u[:, :, None, 1:] * forms[:, None, :, 1]
    # both are parallel; the longer one is rounded less
    lengths = np.linalg.norm(w, axis=3)
    longer = lengths.argmax(axis=2)[:, :, None]
    length = np.take_along_axis(lengths, longer, axis=2)
    w = np.take_along_axis(w, longer[..., None], axis=2)[:, :, 0]
    free = length <= _NOTHING * np.sqrt(size)[:, None, None]  # any v̂ will do
    with np.errstate(all="ignore"):
        v = np.where(free, _ANY_V, np.stack([-w[..., 1], w[..., 0]], axis=2) / length)
        # (B, 2, 2, 3): of every zero, (U, 1) and (V, 1) but for their factors
        ends = np.stack([u @ nu.swapaxes(1, 2), v @ nv.swapaxes(1, 2)], axis=2)
        x = (ends[..., :2] / ends[..., 2:]).reshape(len(u), 2, 4)
    once = np.stack([np.ones_like(double), ~(double | everywhere)], axis=1)
    finite = once & (np.abs(ends[..., 2]).min(axis=2) > _FINITE)
    beyond = once & free[..., 0] & (np.abs(ends[:, :, 0, 2]) > _FINITE)
    curve = np.where(everywhere, finite.any(axis=1), beyond.any(axis=1))
    expected = bound_by_products(systems.products).number
    return [
        _roots(x[k, finite[k]], bool(double[k]), bool(curve[k]), expected) for k in range(len(x))
    ]


def _null_spaces(closures: ComplexArray) -> ComplexArray:
    """Orthonormal bases (B, 3, 2) of the null spaces of closures (B, 1, 3)."""
    _, _, rows = np.linalg.svd(closures)
    return np.asarray(rows[:, 1:].conj().swapaxes(1, 2))


def _forms(nu: ComplexArray, nv: ComplexArray, rows: IndexArray) -> tuple[ComplexArray, Array]:
    """Linear forms in v̂, (B, 2, 2, 2): per product those that belong to û_0 and û_1; the size of
    their determinants, (B,).
    """
    p, q, p1, q1 = rows
    forms = nu[:, p, :, None] * nv[:, q, None, :] - nu[:, p1, :, None] * nv[:, q1, None, :]
    u, v = np.linalg.norm(nu, axis=2), np.linalg.norm(nv, axis=2)
    return forms, (u[:, p] * v[:, q] + u[:, p1] * v[:, q1]).prod(axis=1)


def _det(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _zeros(quadratic: ComplexArray) -> tuple[ComplexArray, BoolArray]:
    """Zeros (û_0, û_1), (B, 2, 2), of length 1, of q0 û_0² + q1 û_0 û_1 + q2 û_1²; whether both
    coincide, and only the first one counts.
    """
    q0, q1, q2 = quadratic.T
    square = q1 * q1 - 4.0 * q0 * q2
    double = np.abs(square) <= _DOUBLE * (np.abs(q1) ** 2 + 4.0 * np.abs(q0 * q2))
    root = np.where(double, 0.0, np.sqrt(square))
    # the root without cancellation; the other one follows from their product
    far = np.where(np.abs(q1 + root) >= np.abs(q1 - root), q1 + root, q1 - root)
    pair = np.array([[-far, 2.0 * q0], [-2.0 * q2, far]]).transpose(2, 0, 1)
    # where both coincide one of them may be zero: the other one comes first
    shorter = double & (np.abs(q0) < np.abs(q2))
    pair[shorter, 0] = np.stack([2.0 * q2, -q1], axis=1)[shorter]
    with np.errstate(all="ignore"):  # zeros that do not count may have no length
        return pair / np.linalg.norm(pair, axis=2)[..., None], double


def _roots(x: ComplexArray, double: bool, curve: bool, expected: int) -> Roots:
    count = (2 if double else 1) * len(x)
    nothing = x[:0]
    return Roots(
        x=nothing if double or curve else x,
        multiple=x if double and not curve else nothing,
        paths=2,
        at_infinity=0 if curve else 2 - count,
        singular=2 if curve else count if double else 0,
        failed=0,
        expected=expected,
        sure=True,
        continuum=curve,
        curves=x if curve else nothing,
    )
