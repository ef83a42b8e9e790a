"""The positions of a task, seen from the first one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import (
    PROOF_SLACK,
    UNIT_ROUNDOFF,
    AnyArray,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
    inverses,
    matrix_vector,
)
from linkwork.core.numerics.kantorovich import radii
from linkwork.synthesis.precision.problem import (
    ComplexPlace,
    PrecisionProblem,
    ProductSums,
    ProductWriter,
)


@dataclass(frozen=True, order=True)
class GivenLength:
    """The distance of two of A0, B0, A, B and the traced point P [length]."""

    one: str
    other: str
    length: float


@dataclass(frozen=True, kw_only=True, eq=False)
class PrecisionPositions:
    """What a four-bar has to do; the order of positions does not matter here.

    Parameters
    ----------
    start : complex
        The traced point in the first position [length].
    poses : (M, ) complex
        The point in the poses after the first position [length].
    turns : (M,)
        How far the coupler has turned there since the first position [rad].
    points : (N,) complex
        The point in the other positions [length].
    pivots : (0, 1 or 2,) complex
        Fixed pivots that are given: A0, or A0 and B0 [length].
    lengths : tuple of GivenLength
        In the order of their ends.
    order : (1 + M + N,) int
        The number that every position has in the task: the start, poses, points.
    listed : int
        How many of them the task lists; the others were drawn.
    """

    start: complex
    poses: ComplexArray
    turns: Array
    points: ComplexArray
    pivots: ComplexArray
    lengths: tuple[GivenLength, ...]
    order: IndexArray
    listed: int

    @classmethod
    def of(
        cls,
        points: ComplexArray,
        angles: Array,
        pivots: ComplexArray,
        lengths: Sequence[GivenLength] = (),
    ) -> PrecisionPositions:
        """Positions (J,) in any order, with the coupler's angles [rad], NaN where it is free.

        The first pose is the start, the first point if there are no poses.
        """
        posed = np.flatnonzero(~np.isnan(angles))
        first = int(posed[0]) if len(posed) else 0
        order = np.concatenate([[first], posed[1:], np.setdiff1d(np.arange(len(points)), posed)])
        order = order.astype(np.intp)
        if not len(posed):
            order = order[1:]
        others, count = points[order[1:]], max(len(posed) - 1, 0)
        return cls(
            start=complex(points[first]),
            poses=others[:count],
            turns=angles[order[1 : count + 1]] - angles[first],
            points=others[count:],
            pivots=pivots,
            lengths=tuple(sorted(lengths)),
            order=order,
            listed=len(order),
        )

    @property
    def problem(self) -> PrecisionProblem:
        """The family of equations."""
        return PrecisionProblem(
            poses=len(self.poses),
            points=len(self.points),
            pivots=len(self.pivots),
            lengths=tuple((entry.one, entry.other) for entry in self.lengths),
        )

    @property
    def size(self) -> float:
        """The mean distance of positions from the first one, by squares [length]."""
        moved = np.concatenate([self.poses, self.points]) - self.start
        return float(np.sqrt((np.abs(moved) ** 2).mean()))

    def parameters(self, size: float) -> ComplexArray:
        """The parameters of the equations in units of ``size``, (P,)."""
        poses, points, pivots = (
            (z - self.start) / size for z in (self.poses, self.points, self.pivots)
        )
        turned = np.exp(1j * self.turns)
        lengths = np.array([entry.length / size for entry in self.lengths])
        return np.concatenate(
            [
                np.column_stack([turned, poses, poses.conj()]).ravel(),
                np.column_stack([points, points.conj()]).ravel(),
                np.column_stack([pivots, pivots.conj()]).ravel(),
                lengths**2,
            ]
        )


# ----------------------------------------------------------------------
# The conditions of a four-bar's positions as quadratic equations with whole coefficients.
#
# Moving pivots A_j and B_j in position j, seen from the traced point there, are separate
# unknowns. With x, y of the first position and the fixed pivots a, b, all seen from its point,
#
#     |δ|² + 2 Re((A - a) δ̄) - 2 Re((A - x) ā) = 0,   alike with B, b and y,
#     |A|² = |x|²,   B x = A y,      or in a pose  A = e x,   B = e y.
#
# Given lengths are alike, and coordinates of pivots may keep a value. They are real equations of
# real numbers v: the unknowns, the given numbers and 1.


#: A coordinate that keeps a value: its place among x, [a], y, [b], seen from the first position
#: [length].
HeldValue = tuple[int, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionEquations:
    """The equations, and the places of x, a, y, b in v, and of A and B in the positions after the
    first.
    """

    sums: ProductSums
    legs: tuple[ComplexPlace, ...]
    moving: tuple[tuple[ComplexPlace, ComplexPlace], ...]


def position_equations(
    positions: PrecisionPositions, held: Sequence[HeldValue] = ()
) -> PositionEquations:
    """The equations; v is x, [a], y, [b], all A_j and B_j, then a, b as far as they are given,
    e of all poses, δ of all positions, given lengths and held values, each with 0, then 1 and 0.
    """
    free = iter(range(0, 10_000, 2))

    def place() -> ComplexPlace:
        first = next(free)
        return first, first + 1

    pivots = len(positions.pivots)
    count = len(positions.poses) + len(positions.points)
    x, a = place(), (0, 0) if pivots > 0 else place()
    y, b = place(), (0, 0) if pivots > 1 else place()
    moving = tuple((place(), place()) for _ in range(count))
    unknowns = (8 - 2 * pivots) + 4 * count
    a = place() if pivots > 0 else a
    b = place() if pivots > 1 else b
    turns = [place() for _ in positions.poses]
    deltas = [place() for _ in range(count)]
    lengths = [place()[0] for _ in positions.lengths]
    values = [place()[0] for _ in held]
    one = place()
    writer = ProductWriter()
    for k, ((left, right), delta) in enumerate(zip(moving, deltas, strict=True)):
        _leg(writer, left, x, a, delta)  # eq. (114)
        _leg(writer, right, y, b, delta)
        if k < len(turns):
            writer.equal_products(left, one, turns[k], x)
            writer.equal_products(right, one, turns[k], y)
        else:
            writer.equal_lengths(left, x)
            writer.equal_products(right, x, left, y)
    named = {"A": x, "A0": a, "B": y, "B0": b}
    for entry, length in zip(positions.lengths, lengths, strict=True):
        ends = [named[end] for end in (entry.one, entry.other) if end in named]
        _length_equation(writer, ends[0], ends[1] if len(ends) > 1 else None, length)
    for (k, _), value in zip(held, values, strict=True):
        writer.equation((1, k, one[0]), (-1, value, one[0]))
    return PositionEquations(
        sums=writer.sums(unknowns, one[1] + 1), legs=(x, a, y, b), moving=moving
    )


def _leg(
    writer: ProductWriter,
    moved: ComplexPlace,
    start: ComplexPlace,
    fixed: ComplexPlace,
    delta: ComplexPlace,
) -> None:
    """|δ|² + 2 Re((A - a) δ̄) - 2 Re((A - x) ā) = 0."""
    writer.equation(
        *[(1, d, d) for d in delta],
        *[(2, m, d) for m, d in zip(moved, delta, strict=True)],
        *[(-2, f, d) for f, d in zip(fixed, delta, strict=True)],
        *[(-2, m, f) for m, f in zip(moved, fixed, strict=True)],
        *[(2, s, f) for s, f in zip(start, fixed, strict=True)],
    )


def _length_equation(
    writer: ProductWriter, one: ComplexPlace, other: ComplexPlace | None, length: int
) -> None:
    """|A - B|² = L²; ``None`` is the traced point, from which all is seen."""
    terms = [(1, k, k) for k in one]
    if other is not None:
        terms += [(1, k, k) for k in other]
        terms += [(-2, k, i) for k, i in zip(one, other, strict=True)]
    writer.equation(*terms, (-1, length, length))


# ----------------------------------------------------------------------
# Proof that quadratic equations have a real solution near computed numbers.
#
# The equations are quadratic (:mod:`linkwork.synthesis.precision.problem`), so that the theorem of
# Newton-Kantorovich needs no bound of a region. The computed numbers are refined in whole numbers,
# in which residuals have no rounding at all: a nearly singular solution is proved as long as the
# inverse of its Jacobian is known to one digit.


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
