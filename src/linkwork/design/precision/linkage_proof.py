"""Proof that a real four-bar goes exactly through its positions, near a computed one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.design.precision.exact_proof import (
    exact_turn,
    prove_numbers,
    whole_number,
    whole_unit,
)
from linkwork.design.precision.position_equations import HeldValue, position_equations
from linkwork.design.precision.positions import PrecisionPositions
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray

__all__ = ["ProvedLinkages", "prove_linkages"]


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
    given: PrecisionPositions, linkage: ComplexArray, held: Sequence[HeldValue] = ()
) -> ProvedLinkages:
    """Refine real linkages x, x̄, a, ā, y, ȳ, b, b̄ (B, 8) [length], and prove them."""
    equations, bits = position_equations(given, held), whole_unit(given.size)
    data = _given_numbers(given, held, bits)
    found = prove_numbers(equations.sums, _start(given, linkage), data, bits, given.size)
    pairs = found.v[:, 0::2] + 1j * found.v[:, 1::2]
    return ProvedLinkages(
        holds=found.holds,
        legs=pairs[:, [k // 2 for k, _ in equations.legs]],
        moving=np.stack(
            [pairs[:, [a // 2, b // 2]] for (a, _), (b, _) in equations.moving], axis=1
        ),
        error=found.error,
    )


def _start(given: PrecisionPositions, linkage: ComplexArray) -> Array:
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


def _given_numbers(given: PrecisionPositions, held: Sequence[HeldValue], bits: int) -> list[int]:
    """Pivots, turns, distances, lengths, held values and 1, as whole numbers."""
    start = complex(given.start)
    whole = [whole_number(start.real, bits), whole_number(start.imag, bits)]

    def from_start(z: complex) -> list[int]:
        return [whole_number(z.real, bits) - whole[0], whole_number(z.imag, bits) - whole[1]]

    numbers = [k for z in given.pivots.tolist() for k in from_start(z)]
    for angle in given.turns.tolist():
        numbers += exact_turn(angle, bits)
    for z in (*given.poses.tolist(), *given.points.tolist()):
        numbers += from_start(z)
    for value in (*(x.length for x in given.lengths), *(x for _, x in held)):
        numbers += [whole_number(value, bits), 0]
    return [*numbers, 1 << bits, 0]
