"""Proof that quadratic equations have a real solution near computed numbers.

The equations are quadratic (:mod:`linkwork.synthesis.precision.problem`), so that the theorem of
Newton-Kantorovich needs no bound of a region. The computed numbers are refined in whole numbers, in
which residuals have no rounding at all: a nearly singular solution is proved as long as the inverse
of its Jacobian is known to one digit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import (
    AnyArray,
    Array,
    BoolArray,
    ComplexArray,
    inverses,
    matrix_vector,
)
from linkwork.core.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.core.numerics.kantorovich import radii
from linkwork.synthesis.precision.position_equations import HeldValue, position_equations
from linkwork.synthesis.precision.positions import PrecisionPositions
from linkwork.synthesis.precision.problem import ProductSums

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
    equations: ProductSums, guess: Array, data: Sequence[int], bits: int, size: float
) -> ProvedNumbers:
    """Refine unknowns (B, n), and prove them.

    ``data``: the other numbers, as whole ones in units of 2^-bits; ``size``: of the task.
    """
    count, n, unit = len(guess), equations.unknowns, 0.5**bits
    whole = np.empty((count, equations.size), dtype=object)
    whole[:, :n], whole[:, n:] = _whole_numbers(guess, bits), data
    v, f = np.empty((count, equations.size)), np.empty((count, n))
    holds, error = np.zeros(count, dtype=bool), np.full(count, np.inf)
    live = np.arange(count)
    with np.errstate(all="ignore"):
        for _ in range(_ROUNDS if count else 0):
            v[live] = whole[live].astype(float) * unit
            residual = np.array([equations.exact_residual(row) for row in whole[live].tolist()])
            f[live] = np.ldexp(residual.astype(float), -2 * bits)
            jacobian = equations.jacobian(v[live])
            inverse = inverses(jacobian)
            correction = matrix_vector(inverse, f[live])
            scale = _LEAST_WEIGHT * size + np.abs(v[live, :n])
            holds[live], error[live] = _prove(equations, v[live], jacobian, inverse, f[live], scale)
            largest = (np.abs(correction) / scale).max(axis=1)
            rounding = 3.0 * UNIT_ROUNDOFF * np.abs(v[live]).max(axis=1)
            near = largest < 1.0  # a step as large as the numbers themselves leads elsewhere
            holds[live] &= near
            moving = near & (error[live] > rounding) & (largest > _EXACT)
            v[live[near], :n] -= correction[near]
            live, correction = live[moving], correction[moving]
            if not len(live):
                break
            whole[live, :n] -= _whole_numbers(correction, bits)
    return ProvedNumbers(v=v, holds=holds, error=np.where(holds, error, np.inf))


def _prove(
    equations: ProductSums,
    v: Array,
    jacobian: Array,
    inverse: Array,
    f: Array,
    scale: Array,
) -> tuple[BoolArray, Array]:
    """Whether the theorem holds in the largest norm with weights, (B,), and a bound of the error
    after the correction that belongs to F.
    """
    n, magnitude = equations.unknowns, np.abs(inverse)
    inside = np.where(np.isfinite(magnitude).all(axis=(1, 2)), 1.0, np.inf)
    # rounding: v to floats, sums of products, and the products of matrices
    blur = 4.0 * UNIT_ROUNDOFF * equations.jacobian_size(np.abs(v))
    defect = np.abs(np.eye(n) - inverse @ jacobian)
    defect += magnitude @ (blur + (n + 2.0) * UNIT_ROUNDOFF * np.abs(jacobian))
    # weights along which the defect is small: an unknown may move as far as the others force it to
    w = scale
    for _ in range(3):
        w = np.maximum(scale, 4.0 * matrix_vector(defect, w))
    rest = (
        np.abs(f) * (1.0 + (n + 4.0) * UNIT_ROUNDOFF)
        + _TURN_ERROR * np.abs(v).max(initial=0.0) ** 2
    )
    y = (matrix_vector(magnitude, rest) / w).max(axis=1) * inside
    z = (matrix_vector(defect, w) / w).max(axis=1) * inside
    omega = (matrix_vector(magnitude, equations.curvature(w)) / w).max(axis=1) * inside
    slack = PROOF_SLACK
    holds, radius, _, _ = radii(y * slack, z * slack, omega * slack, np.zeros_like(omega))
    # eq. (29), and the rounding of the correction
    left = np.minimum((z + 0.5 * omega * radius) * radius * slack, radius)
    left += (n + 4.0) * UNIT_ROUNDOFF * y
    return holds, (left[:, None] * w).max(axis=1) + 2.0 * UNIT_ROUNDOFF * np.abs(v).max(axis=1)


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
    return int(_whole_numbers(np.array([x]), bits)[0])


def _whole_numbers(x: Array, bits: int) -> AnyArray:
    """The same for an array."""
    part, exponent = np.frexp(np.where(np.isfinite(x), x, 0.0))
    number, shift = (part * 2.0**53).astype(np.int64).astype(object), exponent + (bits - 53)
    left, right = (np.maximum(z, 0).astype(object) for z in (shift, -shift))
    return np.asarray(number << left >> right, dtype=object)


# ----------------------------------------------------------------------
# Proof that a real four-bar goes exactly through its positions, near a computed one.


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvedLinkages:
    """Proofs of B linkages.

    Parameters
    ----------
    holds : (B,) bool
    legs : (B, 4) complex
        x, a, y, b, refined: pivots seen from the first position of the traced point [length].
    moving : (B, J, 2) complex
        A and B in the positions after the first one, seen from the traced point there [length].
    error : (B,)
        A bound of the error of all these numbers [length]; infinite where no proof holds.
    """

    holds: BoolArray
    legs: ComplexArray
    moving: ComplexArray
    error: Array


def prove_linkages(
    positions: PrecisionPositions, linkage: ComplexArray, held: Sequence[HeldValue] = ()
) -> ProvedLinkages:
    """Refine real linkages x, x̄, a, ā, y, ȳ, b, b̄ (B, 8) [length], and prove them."""
    equations, bits = position_equations(positions, held), whole_unit(positions.size)
    data = _parameter_numbers(positions, held, bits)
    proof = prove_numbers(equations.sums, _start(positions, linkage), data, bits, positions.size)
    pairs = proof.v[:, 0::2] + 1j * proof.v[:, 1::2]
    return ProvedLinkages(
        holds=proof.holds,
        legs=pairs[:, [k // 2 for k, _ in equations.legs]],
        moving=np.stack(
            [pairs[:, [a // 2, b // 2]] for (a, _), (b, _) in equations.moving], axis=1
        ),
        error=proof.error,
    )


def _start(positions: PrecisionPositions, linkage: ComplexArray) -> Array:
    """The unknowns (B, n) of computed linkages."""
    x, a, y, b = (0.5 * (linkage[:, k] + linkage[:, k + 1].conj()) for k in (0, 2, 4, 6))
    pivots = len(positions.pivots)
    parts = [x, *([a] if pivots < 1 else []), y, *([b] if pivots < 2 else [])]
    turns = list(np.exp(1j * positions.turns))
    with np.errstate(all="ignore"):
        turns += [_turn(x, a, y, b, d) for d in positions.points - positions.start]
    for turn in turns:
        parts += [turn * x, turn * y]
    z = np.stack(parts, axis=1)
    return np.ascontiguousarray(z).view(float)


def _turn(
    x: ComplexArray, a: ComplexArray, y: ComplexArray, b: ComplexArray, d: complex
) -> ComplexArray:
    """e of a linkage at a point: p γ + p̄ γ̄ + r = 0 with both legs."""
    p, u = (a.conj() - d.conjugate()) * x, (b.conj() - d.conjugate()) * y
    r = 2.0 * (d * (a - x).conj()).real - abs(d) ** 2
    w = 2.0 * (d * (b - y).conj()).real - abs(d) ** 2
    e = 1.0 + (p.conj() * w - u.conj() * r) / (p * u.conj() - p.conj() * u)
    return np.asarray(e / np.abs(e))


def _parameter_numbers(task: PrecisionPositions, held: Sequence[HeldValue], bits: int) -> list[int]:
    """Pivots, turns, distances, lengths, held values and 1, as whole numbers."""
    start = complex(task.start)
    whole = [whole_number(start.real, bits), whole_number(start.imag, bits)]

    def from_start(z: complex) -> list[int]:
        return [whole_number(z.real, bits) - whole[0], whole_number(z.imag, bits) - whole[1]]

    numbers = [k for z in task.pivots.tolist() for k in from_start(z)]
    for angle in task.turns.tolist():
        numbers += exact_turn(angle, bits)
    for z in (*task.poses.tolist(), *task.points.tolist()):
        numbers += from_start(z)
    for value in (*(x.length for x in task.lengths), *(x for _, x in held)):
        numbers += [whole_number(value, bits), 0]
    return [*numbers, 1 << bits, 0]
