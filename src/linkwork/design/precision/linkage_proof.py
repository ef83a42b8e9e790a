"""Proof that a real four-bar goes exactly through its positions, near a computed one.

All conditions are quadratic (:mod:`linkwork.design.precision.position_equations`), so that the
theorem of Newton-Kantorovich needs no bound of a region. The computed linkage is refined in whole
numbers, in which residuals have no rounding at all: a nearly singular solution is proved as long as
the inverse of its Jacobian is known to one digit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwork.design.precision.position_equations import (
    FurtherConditions,
    PositionEquations,
    position_equations,
)
from linkwork.design.precision.positions import PrecisionPositions
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.products import matrix_vector
from linkwork.foundation.rounding import PROOF_SLACK, UNIT_ROUNDOFF
from linkwork.numerics.proof.kantorovich import radii

__all__ = ["ProvedLinkages", "prove_linkages"]

_BITS = 320  # of a number of the size of the task, behind the point
_ROUNDS = 12  # refinements at most
_EXACT = 1e-20  # relative: a correction that needs no further one
_LEAST_WEIGHT = 1e-3  # least weight of an unknown, in units of the task's size
_HALVINGS, _SERIES = 16, 24  # of an angle's series: 2^-16 to the 24th, over 24!, is below 2^-400
_TURN_ERROR = 1e-80  # of the series, with all its rounding


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
    given: PrecisionPositions, linkage: ComplexArray, further: FurtherConditions | None = None
) -> ProvedLinkages:
    """Refine real linkages x, x̄, a, ā, y, ȳ, b, b̄ (B, 8) [length], and prove them."""
    further = further or FurtherConditions()
    equations, bits = position_equations(given, further), _BITS - math.frexp(given.size)[1]
    data, count = _given_numbers(given, further, bits), len(linkage)
    guess = _start(given, equations, linkage)
    whole = [[_whole(z, bits) for z in row] + data for row in guess.tolist()]
    n, unit = equations.unknowns, 0.5**bits
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
            scale = _LEAST_WEIGHT * given.size + np.abs(v[live, :n])
            size = (np.abs(correction) / scale).max(axis=1)
            # what is as large as the numbers themselves leads elsewhere
            moving = (size > _EXACT) & (size < 1.0)
            live, correction = live[moving], correction[moving]
            if not len(live):
                break
            for k, step in zip(live, correction.tolist(), strict=True):
                for i, change in enumerate(step):
                    whole[k][i] -= _whole(change, bits)
        scale = _LEAST_WEIGHT * given.size + np.abs(v[:, :n])
        holds, error = _prove(equations, v, jacobian, inverse, f, scale)
    pairs = v[:, 0::2] + 1j * v[:, 1::2]
    return ProvedLinkages(
        holds=holds,
        legs=pairs[:, [k // 2 for k, _ in equations.legs]],
        moving=np.stack(
            [pairs[:, [a // 2, b // 2]] for (a, _), (b, _) in equations.moving], axis=1
        ),
        error=np.where(holds, error, np.inf),
    )


def _prove(
    equations: PositionEquations,
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


def _start(given: PrecisionPositions, equations: PositionEquations, linkage: ComplexArray) -> Array:
    """The unknowns (B, n) of computed linkages."""
    x, a, y, b = (0.5 * (linkage[:, k] + linkage[:, k + 1].conj()) for k in (0, 2, 4, 6))
    pivots = len(given.pivots)
    parts = [x, *([a] if pivots < 1 else []), y, *([b] if pivots < 2 else [])]
    turns = list(np.exp(1j * given.turns))
    with np.errstate(all="ignore"):
        turns += [_turn(x, a, y, b, d) for d in given.points - given.start]
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


def _given_numbers(given: PrecisionPositions, further: FurtherConditions, bits: int) -> list[int]:
    """Pivots, turns, distances, lengths, held values and 1, as whole numbers."""
    start = complex(given.start)
    whole = [_whole(start.real, bits), _whole(start.imag, bits)]

    def from_start(z: complex) -> list[int]:
        return [_whole(z.real, bits) - whole[0], _whole(z.imag, bits) - whole[1]]

    numbers = [k for z in given.pivots.tolist() for k in from_start(z)]
    for angle in given.turns.tolist():
        numbers += _exact_turn(angle, bits)
    for z in (*given.poses.tolist(), *given.points.tolist()):
        numbers += from_start(z)
    for value in (*(x.length for x in further.lengths), *(x for _, x in further.held)):
        numbers += [_whole(value, bits), 0]
    return [*numbers, 1 << bits, 0]


def _exact_turn(angle: float, bits: int) -> list[int]:
    """Cosine and sine of an angle [rad] as whole numbers: the series, squared again and again."""
    step = _whole(angle, bits) >> _HALVINGS
    real, imag, total = 1 << bits, 0, [1 << bits, 0]
    for k in range(1, _SERIES):
        real, imag = -(imag * step >> bits) // k, (real * step >> bits) // k
        total = [total[0] + real, total[1] + imag]
    for _ in range(_HALVINGS):
        c, s = total
        total = [(c * c - s * s) >> bits, (2 * c * s) >> bits]
    return total


def _whole(x: float, bits: int) -> int:
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
