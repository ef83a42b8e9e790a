"""Taylor series of all variables of a mechanism along a motion of its inputs, to any order.

The closure equations F(x(s), u(s)) = 0 hold for every power of s. With the coefficients below order
k known, that of order k is linear: J x_k = -F_k, where F_k is computed with x_k = 0. Phasors
z = c e^{iψ} follow from z' = i ψ' z (Neidinger 2010, doi:10.1137/080743627).
"""

from __future__ import annotations

from math import comb

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, ComplexArray, solutions
from linkwork.core.foundation.errors import InputError
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LawRow, PhasorRows, Piecewise


def variable_series(table: LoopTable, v: Array, inputs: Array) -> Array:
    """The coefficients of all variables, (K + 1, B, N); NaN at singular positions.

    Parameters
    ----------
    v : (B, N)
        Converged positions.
    inputs : (K + 1, p) or (K + 1, B, p)
        The coefficients of the inputs; the first ones are not used.

    Raises
    ------
    InputError
        For equations that are formulas.
    """
    if not table.has_curvature_bound:
        raise InputError("plain equations have derivatives up to the second order only")
    n, orders = table.unknowns, len(inputs)
    x = np.zeros((orders, *v.shape))
    x[0] = v
    matrix = (table.jacobian(v) * table.variable_scale / table.equation_scale[:, None])[:, :, :n]
    for k in range(1, orders):
        x[k, :, n:] = inputs[k]
        right = _coefficient(table, x[: k + 1]) / table.equation_scale
        # eq. (91)
        x[k, :, :n] = -solutions(matrix, right[:, :, None])[:, :, 0] * table.variable_scale[:n]
    return x


def _coefficient(table: LoopTable, x: Array) -> Array:
    """The last coefficient of all equations, (B, m)."""
    loops = phasor_series(table.loops, x)[-1]
    parts = [loops.real, loops.imag]
    lines = np.zeros((x.shape[1], len(table.linear.constant)))
    for row, variable, weight in zip(
        table.linear.row, table.linear.variable, table.linear.weight, strict=True
    ):
        lines[:, row] += weight * x[-1, :, variable]
    parts.append(lines)
    parts += [_law(row, x)[:, None] for row in table.functions if isinstance(row, LawRow)]
    return np.concatenate(parts, axis=1)


def phasor_series(rows: PhasorRows, x: Array) -> ComplexArray:
    """The coefficients of rows of phasor terms, (K + 1, B, R), from those of the variables."""
    orders, count = x.shape[:2]
    psi = np.zeros((orders, count, len(rows.row)))
    for term, variable, weight in zip(
        rows.phase_term, rows.phase_variable, rows.phase_weight, strict=True
    ):
        psi[:, :, term] += weight * x[:, :, variable]
    z = np.empty((orders, count, len(rows.row)), dtype=complex)
    z[0] = rows.coefficient * np.exp(1j * psi[0])
    for k in range(1, orders):
        # eq. (90)
        z[k] = 1j / k * sum(j * psi[j] * z[k - j] for j in range(1, k + 1))
    for term in np.flatnonzero(rows.length >= 0):
        z[:, :, term] = _product(z[:, :, term], x[:, :, rows.length[term]])
    found = np.zeros((orders, count, rows.rows), dtype=complex)
    for term, row in enumerate(rows.row):
        found[:, :, row] += z[:, :, term]
    return found


def _product(a: Array | ComplexArray, b: Array) -> AnyArray:
    """The coefficients of a product, (K + 1, B)."""
    return np.stack([sum(a[j] * b[k - j] for j in range(k + 1)) for k in range(len(a))])


def _law(row: LawRow, x: Array) -> Array:
    """The last coefficient of a row with a function of one sum, (B,)."""
    own = x[:, :, list(row.variables)]
    orders = len(x) - 1
    straight = own[-1] @ row.weights
    inner = own @ row.inner
    argument = inner[0] + row.offset
    inner[0] = 0.0
    # the function's own series about the argument, composed with the powers of the argument's
    power, total = inner.copy(), np.zeros(x.shape[1])
    for factor in law_series(row.law, argument, orders):
        total += factor * power[-1]
        power = _product(power, inner)
    return np.asarray(straight - total)


def law_series(law: Piecewise, at: Array, orders: int) -> Array:
    """f^(m)/m! of a law at places (B,) for m = 1 … orders, (orders, B)."""
    piece, t, beyond = law.locate(at)
    powers = law.powers[piece]
    a, w, p = law.sines[piece].T
    found, degree, factorial = [], powers.shape[1], 1.0
    for m in range(1, orders + 1):
        factorial *= m
        straight = sum(
            (comb(k, m) * powers[:, k] * t ** (k - m) for k in range(m, degree)), np.zeros_like(t)
        )
        waves = a * w**m / factorial * np.sin(w * t + p + 0.5 * m * np.pi)
        # beyond its ends a law is a straight line
        found.append(np.where((beyond == 0.0) | (m == 1), straight + waves, 0.0))
    return np.array(found).reshape(orders, len(at))
