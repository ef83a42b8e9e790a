"""Proof that a real Watt-II six-bar goes exactly through its pairs of angles.

Both four-bars are seen from the ground of the crank to that of the rocker: a is the crank, b and c
are the arms of the bell crank, e is the rocker. The arms in every position, seen from crank and
rocker, are unknowns of their own, B = b t / u and C = c t / v. With m = b̄ c all conditions are
quadratic equations, eq. (182):

    |B|² = |b|²,   B̄ C = m u v̄,   |ū + B - a|² = |1 + b - a|²,   |v̄ + e - C|² = |1 + e - c|².
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from linkwork.design.precision.exact_proof import exact_turn, prove_numbers, whole_unit
from linkwork.design.precision.product_sums import ComplexPlace, ProductSums, ProductWriter
from linkwork.design.six_bars.watt_problem import bell_crank_turns
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray

__all__ = ["ProvedSixBars", "prove_six_bars"]

_SIZE = 1.0  # of the numbers: each four-bar has its ground as the unit
_POSITIONS = 8  # after the first


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvedSixBars:
    """Proofs of D six-bars.

    Parameters
    ----------
    arms : (D, 4) complex
        a, b, c, e, refined [ground of their four-bar].
    turns : (D, 9) complex
        The rotations of the bell crank.
    holds : (D,) bool
    error : (D,)
        A bound of the errors of all arms in all positions [ground of their four-bar]; infinite
        where no proof holds.
    """

    arms: ComplexArray
    turns: ComplexArray
    holds: BoolArray
    error: Array


def prove_six_bars(x: ComplexArray, inputs: Array, outputs: Array) -> ProvedSixBars:
    """Refine real solutions (D, 8), and prove them.

    ``inputs``, ``outputs``: (8,) angles of crank and rocker from their first ones [rad].
    """
    u, v = (np.exp(1j * angle) for angle in (inputs, outputs))
    a, b, d, c = (0.5 * (x[:, k] + x[:, k + 1].conj()) for k in (0, 2, 4, 6))
    c, e = -c, -d
    turns = bell_crank_turns(x, u, v)
    with np.errstate(all="ignore"):
        turns = turns / np.abs(turns)
    parts = [a, b, c, e, b.conj() * c]
    for t, one, other in zip(turns.T, u, v, strict=True):
        parts += [b * t / one, c * t / other]
    guess = np.ascontiguousarray(np.stack(parts, axis=1)).view(float)
    bits = whole_unit(_SIZE)
    found = prove_numbers(_equations(), guess, _given(inputs, outputs, bits), bits, _SIZE)
    pairs = found.v[:, 0::2] + 1j * found.v[:, 1::2]
    arms = pairs[:, :4]
    with np.errstate(all="ignore"):
        turned = pairs[:, 5 : 5 + 2 * _POSITIONS : 2] * u / arms[:, 1:2]
        turned = turned / np.abs(turned)
    return ProvedSixBars(
        arms=arms,
        turns=np.concatenate([np.ones((len(x), 1)), turned], axis=1),
        holds=found.holds,
        error=found.error,
    )


def _given(inputs: Array, outputs: Array, bits: int) -> list[int]:
    """u, v and u v̄ of all pairs, and 1, as whole numbers."""
    numbers = list[int]()
    for one, other in zip(inputs.tolist(), outputs.tolist(), strict=True):
        (ur, ui), (vr, vi) = exact_turn(one, bits), exact_turn(other, bits)
        numbers += [ur, ui, vr, vi, (ur * vr + ui * vi) >> bits, (ui * vr - ur * vi) >> bits]
    return [*numbers, 1 << bits, 0]


@cache
def _equations() -> ProductSums:
    """The equations; v is a, b, c, e, m, all B and C, then u, v and u v̄ of all pairs, 1 and 0."""
    places = [(k, k + 1) for k in range(0, 10 + 10 * _POSITIONS + 2, 2)]
    a, b, c, e, m = places[:5]
    arms = places[5 : 5 + 2 * _POSITIONS]
    given, one = places[5 + 2 * _POSITIONS : -1], places[-1]
    writer = ProductWriter()
    for part, terms in zip(m, _conjugate_product(b, c), strict=True):
        writer.equation((-1, part, one[0]), *terms)
    for k in range(_POSITIONS):
        arm_b, arm_c = arms[2 * k : 2 * k + 2]
        u, v, both = given[3 * k : 3 * k + 3]
        # eq. (182)
        writer.equal_lengths(arm_b, b)
        real, imag = _conjugate_product(arm_b, arm_c)
        writer.equation(*real, (-1, m[0], both[0]), (1, m[1], both[1]))
        writer.equation(*imag, (-1, m[0], both[1]), (-1, m[1], both[0]))
        _coupler(writer, (u, a, arm_b), (a, b), one)
        _coupler(writer, (v, arm_c, e), (c, e), one)
    return writer.sums(places[5 + 2 * _POSITIONS][0], one[1] + 1)


def _coupler(
    writer: ProductWriter,
    moved: tuple[ComplexPlace, ComplexPlace, ComplexPlace],
    start: tuple[ComplexPlace, ComplexPlace],
    one: ComplexPlace,
) -> None:
    """|w̄ + y - x|² = |1 + y0 - x0|² for w, x, y, where |x| = |x0| and |y| = |y0|."""
    turn, x, y = moved
    x0, y0 = start
    writer.equation(
        *_real_product(1, turn, y),
        *_real_product(-1, turn, x),
        *[(-1, i, j) for i, j in zip(y, x, strict=True)],
        (-1, one[0], y0[0]),
        (1, one[0], x0[0]),
        *[(1, i, j) for i, j in zip(y0, x0, strict=True)],
    )


def _real_product(
    factor: int, x: ComplexPlace, y: ComplexPlace
) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """The real part of x y."""
    return (factor, x[0], y[0]), (-factor, x[1], y[1])


def _conjugate_product(
    x: ComplexPlace, y: ComplexPlace
) -> tuple[list[tuple[int, int, int]], list[tuple[int, int, int]]]:
    """Both parts of x̄ y."""
    return [(1, x[0], y[0]), (1, x[1], y[1])], [(1, x[0], y[1]), (-1, x[1], y[0])]
