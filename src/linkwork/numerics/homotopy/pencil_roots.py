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

from functools import cache

import numpy as np

from linkwork.foundation.arrays import ComplexArray, IndexArray
from linkwork.numerics.homotopy.bilinear import BilinearSystem
from linkwork.numerics.homotopy.bilinear_homotopy import normal_numbers, null_space
from linkwork.numerics.homotopy.dead_point_system import DeadPointSystem
from linkwork.numerics.homotopy.polynomial_system import (
    PolynomialSystem,
    distinct_solutions,
    polish_roots,
)

__all__ = ["dead_points_of_one_loop", "roots_of_two_loops"]

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
