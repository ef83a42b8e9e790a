"""Rows of phasor terms and lines at one position, rounded once: in whole-number arithmetic.

Double precision loses a unit or two of rounding per term, which is enough to move a dead point
that lies close to a change point: there an error δ of a closure shifts the input by δ / |sin θ|.
All numbers are multiples of 2^-B.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.kernels.phasor_rows import PhasorRows

__all__ = ["exact_line", "exact_rows"]

_BITS = 160  # B: products of two floats, sums of many, and room
_ONE = 1 << _BITS


def exact_rows(rows: PhasorRows, v: Array) -> ComplexArray:
    """F of all rows at one position v (N,), each part rounded once, (R,)."""
    values = [_whole(x) for x in v.tolist()]
    phases = [0] * len(rows.row)
    lists = (x.tolist() for x in (rows.phase_term, rows.phase_variable, rows.phase_weight))
    for t, k, w in zip(*lists, strict=True):
        phases[t] += _product(_whole(w), values[k])
    sums = [[0, 0] for _ in range(rows.rows)]
    lists = (x.tolist() for x in (rows.row, rows.coefficient, rows.length))
    for phase, row, factor, length in zip(phases, *lists, strict=True):
        c, s = _cosine_and_sine(phase)
        re, im = _whole(factor.real), _whole(factor.imag)
        along, across = _product(re, c) - _product(im, s), _product(re, s) + _product(im, c)
        if length >= 0:
            along, across = _product(values[length], along), _product(values[length], across)
        sums[row][0] += along
        sums[row][1] += across
    return np.array([complex(_rounded(re), _rounded(im)) for re, im in sums], dtype=complex)


def exact_line(constant: float, weights: Sequence[float], values: Sequence[float]) -> float:
    """Σ w v + constant, rounded once."""
    pairs = zip(weights, values, strict=True)
    return _rounded(_whole(constant) + sum(_product(_whole(w), _whole(x)) for w, x in pairs if w))


def _whole(x: float) -> int:
    """x · 2^B."""
    return int(math.ldexp(x, _BITS))


def _product(a: int, b: int) -> int:
    return (a * b) >> _BITS


def _rounded(x: int) -> float:
    return math.ldexp(float(x), -_BITS)


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
        term = _product(term, rest) // k
        if -1 <= term <= 0:
            break
        sign = -1 if k % 4 in (2, 3) else 1
        if k % 2:
            s += sign * term
        else:
            c += sign * term
    return ((c, s), (-s, c), (-c, -s), (s, -c))[number % 4]
