"""Rows of phasor terms and lines at one position, rounded once: in whole-number arithmetic.

Double precision loses a unit or two of rounding per term, which is enough to move a dead point
that lies close to a change point: there an error δ of a closure shifts the input by δ / |sin θ|.
Angles are multiples of 2^-B, lengths of a power of 2 that depends on the smallest of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cache, lru_cache

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.kernels.phasor_rows import PhasorRows

__all__ = ["exact_line", "exact_rows"]

_BITS = 160  # B: products of two floats, sums of many, and room
_ONE = 1 << _BITS
_MANTISSA = 53  # bits of a float


def exact_rows(rows: PhasorRows, v: Array) -> ComplexArray:
    """F of all rows at one position v (N,), each part rounded once, (R,)."""
    values, coefficients = v.tolist(), rows.coefficient.tolist()
    lengths = [values[k] if k >= 0 else None for k in rows.length.tolist()]
    phases = [0] * len(rows.row)
    lists = (x.tolist() for x in (rows.phase_term, rows.phase_variable, rows.phase_weight))
    for t, k, w in zip(*lists, strict=True):
        phases[t] += (_whole(w, _BITS) * _whole(values[k], _BITS)) >> _BITS
    parts = [part for factor in coefficients for part in (factor.real, factor.imag)]
    bits = _BITS + _room(parts) + _room(length for length in lengths if length is not None)
    sums = [[0, 0] for _ in range(rows.rows)]
    terms = zip(phases, rows.row.tolist(), coefficients, lengths, strict=True)
    for phase, row, factor, length in terms:
        c, s = _cosine_and_sine(phase)
        re, im = _whole(factor.real, bits), _whole(factor.imag, bits)
        along, across = (re * c - im * s) >> _BITS, (re * s + im * c) >> _BITS
        if length is not None:
            by = _whole(length, bits)
            along, across = (by * along) >> bits, (by * across) >> bits
        sums[row][0] += along
        sums[row][1] += across
    one = 1 << bits
    return np.array([complex(re / one, im / one) for re, im in sums], dtype=complex)


def exact_line(constant: float, weights: Sequence[float], values: Sequence[float]) -> float:
    """Σ w v + constant, rounded once."""
    pairs = zip(weights, values, strict=True)
    return float(sum((Fraction(w) * Fraction(x) for w, x in pairs if w), Fraction(constant)))


def _whole(x: float, bits: int) -> int:
    """x · 2^bits."""
    part, exponent = math.frexp(x)
    shift = exponent + bits - _MANTISSA
    whole = int(math.ldexp(part, _MANTISSA))
    return whole << shift if shift >= 0 else whole >> -shift


def _room(sizes: Iterable[float]) -> int:
    """How many bits more the smallest of some numbers needs to be as precise as 1 is."""
    return max([0, *(-math.frexp(size)[1] for size in sizes if size)])


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


@lru_cache(maxsize=256)  # many terms of a mechanism turn together
def _cosine_and_sine(angle: int) -> tuple[int, int]:
    """cos and sin of ``angle`` · 2^-B, times 2^B."""
    quarter = _quarter()
    extra = quarter.bit_length() - 1 - _BITS
    number = ((angle << extra) + quarter // 2) // quarter
    rest = angle - ((number * quarter) >> extra)
    c, s, term, k = _ONE, 0, _ONE, 0
    while term:
        k += 1
        term = ((term * rest) >> _BITS) // k
        if -1 <= term <= 0:
            break
        sign = -1 if k % 4 in (2, 3) else 1
        if k % 2:
            s += sign * term
        else:
            c += sign * term
    return ((c, s), (-s, c), (-c, -s), (s, -c))[number % 4]
