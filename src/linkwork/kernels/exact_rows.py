"""Rows of phasor terms and lines at one position, rounded once: in whole-number arithmetic.

Double precision loses a unit or two of rounding per term, which is enough to move a dead point
that lies close to a change point: there an error δ of a closure shifts the input by δ / |sin θ|.
Numbers are taken as the exact fractions that floats are, angles as multiples of 2^-B.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.kernels.phasor_rows import PhasorRows

__all__ = ["exact_line", "exact_rows"]

_BITS = 160  # B: products of two floats, sums of many, and room
_ONE = 1 << _BITS


def exact_rows(rows: PhasorRows, v: Array) -> ComplexArray:
    """F of all rows at one position v (N,), each part rounded once, (R,)."""
    values = [Fraction(x) for x in v.tolist()]
    phases = [Fraction(0)] * len(rows.row)
    for t, k, w in zip(rows.phase_term, rows.phase_variable, rows.phase_weight, strict=True):
        phases[t] += Fraction(float(w)) * values[k]
    sums = [[Fraction(0), Fraction(0)] for _ in range(rows.rows)]
    for t, phase in enumerate(phases):
        c, s = (Fraction(part, _ONE) for part in _cosine_and_sine(round(phase * _ONE)))
        factor = rows.coefficient[t]
        re, im = Fraction(float(factor.real)), Fraction(float(factor.imag))
        length = values[rows.length[t]] if rows.length[t] >= 0 else Fraction(1)
        row = sums[rows.row[t]]
        row[0] += length * (re * c - im * s)
        row[1] += length * (re * s + im * c)
    return np.array([complex(float(re), float(im)) for re, im in sums], dtype=complex)


def exact_line(constant: float, weights: Sequence[float], values: Sequence[float]) -> float:
    """Σ w v + constant, rounded once."""
    pairs = zip(weights, values, strict=True)
    return float(sum((Fraction(w) * Fraction(x) for w, x in pairs), Fraction(float(constant))))


@cache
def _quarter() -> int:
    """π/2 · 2^B by Machin's formula, π/4 = 4 atan(1/5) - atan(1/239)."""
    extra = 64  # for whole turns

    def arc(n: int) -> int:
        power = (1 << (_BITS + extra)) // n
        total, k, sign = power, 1, 1
        while power:
            power //= n * n
            k, sign = k + 2, -sign
            total += sign * (power // k)
        return total

    return 2 * (4 * arc(5) - arc(239))


def _cosine_and_sine(angle: int) -> tuple[int, int]:
    """cos and sin of ``angle`` · 2^-B, times 2^B."""
    quarter = _quarter()
    extra = quarter.bit_length() - 1 - _BITS
    number = ((angle << extra) + quarter // 2) // quarter
    rest = angle - ((number * quarter) >> extra)
    c, s, term, k = _ONE, 0, _ONE, 0
    while term:
        k += 1
        term = term * rest // (k << _BITS)
        if -1 <= term <= 0:
            break
        sign = -1 if k % 4 in (2, 3) else 1
        if k % 2:
            s += sign * term
        else:
            c += sign * term
    return ((c, s), (-s, c), (-c, -s), (s, -c))[number % 4]
