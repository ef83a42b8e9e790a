"""Bilinear systems of one loop in closed form, many at once.

On the null spaces û, v̂ ∈ C² the two products are ûᵀ M_r v̂ = 0, so ûᵀM_1 and ûᵀM_2 are parallel:
a quadratic form in û.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import BoolArray, ComplexArray, IndexArray
from linkwork.numerics.homotopy.bilinear import BilinearSystem
from linkwork.numerics.homotopy.bilinear_homotopy import null_space
from linkwork.numerics.homotopy.polynomial_system import Roots
from linkwork.numerics.homotopy.solution_bound import bound_by_products

__all__ = ["quadratic_roots"]

_DOUBLE = 1e-14  # discriminant, relative to its parts, that is zero within rounding
_NOTHING = 1e-13  # coefficients, relative to the products they come from, that are
_FINITE = 1e-9  # smallest homogenising coordinate, of vectors of length 1, of a finite solution


def quadratic_roots(system: BilinearSystem) -> Roots:
    """All solutions of a system with one loop: two at most, unless there is a curve of them."""
    spaces = (null_space(system.left)[0], null_space(system.right)[0])
    forms, size = _forms(spaces, system.rows)
    (a, b), (c, d) = forms
    quadratic = np.array([_det(a, c), _det(a, d) + _det(b, c), _det(b, d)])  # eq. (46)
    everywhere = np.abs(quadratic).max() <= _NOTHING * size
    if everywhere:  # any û has its v̂: one of them shows whether the curve is finite
        ways, double = [np.array([0.6, 0.8j])], False
    else:
        ways, double = _zeros(quadratic)
    ends = np.zeros((len(ways), 2, 3), dtype=complex)
    curve = everywhere
    for k, u in enumerate(ways):
        w1, w2 = u[0] * a + u[1] * b, u[0] * c + u[1] * d
        # both are parallel; the longer one is rounded less
        w = w1 if np.linalg.norm(w1) >= np.linalg.norm(w2) else w2
        length = float(np.linalg.norm(w))
        free = length <= _NOTHING * np.sqrt(size)  # any v̂ will do
        v = np.array([0.8, 0.6j]) if free else np.array([-w[1], w[0]]) / length
        ends[k, 0], ends[k, 1] = spaces[0] @ u, spaces[1] @ v
        curve |= free and bool(abs(ends[k, 0, -1]) > _FINITE)
    finite = np.abs(ends[:, :, -1]).min(axis=1) > _FINITE
    if everywhere and not finite.any():
        curve = False
    return _roots_of_forms(system, ends, finite, double, curve)


def _forms(
    spaces: tuple[ComplexArray, ComplexArray], rows: IndexArray
) -> tuple[list[tuple[ComplexArray, ComplexArray]], float]:
    """Per product the two linear forms in v̂ that belong to û_0 and û_1; the size of their dets."""
    nu, nv = spaces
    found = []
    for p, q, p1, q1 in rows.T:
        matrix = np.outer(nu[p], nv[q]) - np.outer(nu[p1], nv[q1])
        found.append((matrix[0], matrix[1]))
    size = 1.0
    for p, q, p1, q1 in rows.T:
        size *= float(
            np.linalg.norm(nu[p]) * np.linalg.norm(nv[q])
            + np.linalg.norm(nu[p1]) * np.linalg.norm(nv[q1])
        )
    return found, size


def _det(a: ComplexArray, b: ComplexArray) -> complex:
    return complex(a[0] * b[1] - a[1] * b[0])


def _zeros(quadratic: ComplexArray) -> tuple[list[ComplexArray], bool]:
    """Zeros (û_0, û_1), of length 1, of q0 û_0² + q1 û_0 û_1 + q2 û_1²; whether they coincide."""
    q0, q1, q2 = (complex(q) for q in quadratic)
    square = q1 * q1 - 4.0 * q0 * q2
    if abs(square) <= _DOUBLE * (abs(q1) ** 2 + 4.0 * abs(q0 * q2)):
        pair = [np.array([-q1, 2.0 * q0]) if abs(q0) >= abs(q2) else np.array([2.0 * q2, -q1])]
    else:
        root = complex(np.sqrt(square))
        # the root without cancellation; the other one follows from their product
        far = q1 + root if abs(q1 + root) >= abs(q1 - root) else q1 - root
        pair = [np.array([-far, 2.0 * q0]), np.array([-2.0 * q2, far])]
    return [z / np.linalg.norm(z) for z in pair], len(pair) == 1


def _roots_of_forms(
    system: BilinearSystem, ends: ComplexArray, finite: BoolArray, double: bool, curve: bool
) -> Roots:
    m = system.size
    with np.errstate(all="ignore"):
        x = (ends[:, :, :m] / ends[:, :, m:]).reshape(len(ends), 2 * m)[finite]
    nothing = x[:0]
    count = (2 if double else 1) * len(x)
    return Roots(
        x=nothing if double or curve else x,
        multiple=x if double and not curve else nothing,
        paths=2,
        at_infinity=0 if curve else 2 - count,
        singular=2 if curve else count if double else 0,
        failed=0,
        expected=bound_by_products(system.products).number,
        sure=True,
        continuum=curve,
        curves=x if curve else nothing,
    )
