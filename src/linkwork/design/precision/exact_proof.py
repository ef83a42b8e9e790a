"""Proof that quadratic equations have a real solution near computed numbers.

The equations are quadratic (:mod:`linkwork.design.precision.product_sums`), so that the theorem of
Newton-Kantorovich needs no bound of a region. The computed numbers are refined in whole numbers, in
which residuals have no rounding at all: a nearly singular solution is proved as long as the inverse
of its Jacobian is known to one digit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.design.precision.product_sums import ProductSums
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.products import matrix_vector
from linkwork.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.numerics.proof.kantorovich import radii

__all__ = ["ProvedNumbers", "exact_turn", "prove_numbers", "whole_number", "whole_unit"]

_BITS = 320  # of a number of the size of the task, behind the point
_ROUNDS = 12  # refinements at most
_EXACT = 1e-20  # relative: a correction that needs no further one
_LEAST_WEIGHT = 1e-3  # least weight of an unknown, in units of the task's size
_HALVINGS, _SERIES = 16, 24  # of an angle's series: 2^-16 to the 24th, over 24!, is below 2^-400
_TURN_ERROR = 1e-80  # of the series, with all its rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvedNumbers:
    """Refined numbers v (B, V) with the given ones after the unknowns, whether the proofs hold
    (B,), and bounds of the errors of all numbers (B,), infinite where no proof holds.
    """

    v: Array
    holds: BoolArray
    error: Array


def whole_unit(size: float) -> int:
    """Bits behind the point of whole numbers, for a task of this size."""
    return _BITS - math.frexp(size)[1]


def prove_numbers(
    equations: ProductSums, guess: Array, given: Sequence[int], bits: int, size: float
) -> ProvedNumbers:
    """Refine unknowns (B, n), and prove them.

    ``given``: the other numbers, as whole ones in units of 2^-bits; ``size``: of the task.
    """
    data = list(given)
    whole = [[whole_number(z, bits) for z in row] + data for row in guess.tolist()]
    count, n, unit = len(guess), equations.unknowns, 0.5**bits
    v, f = np.empty((count, equations.size)), np.empty((count, n))
    jacobian, inverse = (np.empty((count, n, n)) for _ in range(2))
    live = np.arange(count)
    with np.errstate(all="ignore"):
        for _ in range(_ROUNDS if count else 0):
            v[live] = [[float(z) * unit for z in whole[k]] for k in live]
            f[live] = [_rounded(equations.exact_residual(whole[k]), bits) for k in live]
            jacobian[live] = equations.jacobian(v[live])
            inverse[live] = _inverses(jacobian[live])
            correction = matrix_vector(inverse[live], f[live])
            scale = _LEAST_WEIGHT * size + np.abs(v[live, :n])
            largest = (np.abs(correction) / scale).max(axis=1)
            # what is as large as the numbers themselves leads elsewhere
            moving = (largest > _EXACT) & (largest < 1.0)
            live, correction = live[moving], correction[moving]
            if not len(live):
                break
            for k, step in zip(live, correction.tolist(), strict=True):
                for i, change in enumerate(step):
                    whole[k][i] -= whole_number(change, bits)
        scale = _LEAST_WEIGHT * size + np.abs(v[:, :n])
        holds, error = _prove(equations, v, jacobian, inverse, f, scale)
    return ProvedNumbers(v=v, holds=holds, error=np.where(holds, error, np.inf))


def _prove(
    equations: ProductSums,
    v: Array,
    jacobian: Array,
    inverse: Array,
    f: Array,
    scale: Array,
) -> tuple[BoolArray, Array]:
    """Whether the theorem holds in the largest norm with weights, (B,), and the radius."""
    n, own = equations.unknowns, np.abs(inverse)
    inside = np.where(np.isfinite(own).all(axis=(1, 2)), 1.0, np.inf)
    # rounding: v to floats, sums of products, and the products of matrices
    blur = 4.0 * UNIT_ROUNDOFF * equations.jacobian_size(np.abs(v))
    defect = np.abs(np.eye(n) - inverse @ jacobian)
    defect += own @ (blur + (n + 2.0) * UNIT_ROUNDOFF * np.abs(jacobian))
    # weights along which the defect is small: an unknown may move as far as the others move it
    w = scale
    for _ in range(3):
        w = np.maximum(scale, 4.0 * matrix_vector(defect, w))
    rest = (
        np.abs(f) * (1.0 + (n + 4.0) * UNIT_ROUNDOFF)
        + _TURN_ERROR * np.abs(v).max(initial=0.0) ** 2
    )
    y = (matrix_vector(own, rest) / w).max(axis=1) * inside
    z = (matrix_vector(defect, w) / w).max(axis=1) * inside
    omega = (matrix_vector(own, equations.curvature(w)) / w).max(axis=1) * inside
    slack = PROOF_SLACK
    holds, radius, _, _ = radii(y * slack, z * slack, omega * slack, np.zeros_like(omega))
    return holds, (radius[:, None] * w).max(axis=1) + 2.0 * UNIT_ROUNDOFF * np.abs(v).max(axis=1)


def exact_turn(angle: float, bits: int) -> list[int]:
    """Cosine and sine of an angle [rad] as whole numbers: the series, squared again and again."""
    step = whole_number(angle, bits) >> _HALVINGS
    real, imag, total = 1 << bits, 0, [1 << bits, 0]
    for k in range(1, _SERIES):
        real, imag = -(imag * step >> bits) // k, (real * step >> bits) // k
        total = [total[0] + real, total[1] + imag]
    for _ in range(_HALVINGS):
        c, s = total
        total = [(c * c - s * s) >> bits, (2 * c * s) >> bits]
    return total


def whole_number(x: float, bits: int) -> int:
    """x in units of 2^-bits; exactly, unless it is smaller than the last of them."""
    if not math.isfinite(x):
        return 0
    part, exponent = math.frexp(x)
    number, shift = int(part * 2.0**53), exponent - 53 + bits
    return number << shift if shift >= 0 else number >> -shift


def _rounded(f: list[int], bits: int) -> list[float]:
    """Residuals in units of 2^-2bits as floats."""
    return [math.ldexp(float(z), -2 * bits) for z in f]


def _inverses(matrices: Array) -> Array:
    """Approximate inverses (B, n, n); NaN where there is none."""
    try:
        return np.asarray(np.linalg.inv(matrices), dtype=float)
    except np.linalg.LinAlgError:
        found = np.full_like(matrices, np.nan)
        for k, matrix in enumerate(matrices):
            try:
                found[k] = np.linalg.inv(matrix)
            except np.linalg.LinAlgError:
                continue
        return found
