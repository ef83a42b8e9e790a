"""The machine that runs programs over lanes: one instruction at a time, all lanes at once.

Registers are rows of a workspace (R, LANES). A pass over one row is a loop of known length over
contiguous numbers, which the compiler turns into vector instructions; choosing the operation costs
little beside it. So no mechanism needs a compilation of its own.
"""

from __future__ import annotations

import math

import numba  # noqa: TID253 - this module is loaded when a family is solved
import numpy as np

__all__ = ["LANES", "compiled", "compiled_for", "run"]

LANES = 64


def compiled_for(signature: str | None):  # type: ignore[no-untyped-def]
    """Compiled once for all layouts of the arrays that a signature leaves open; ``None``: for
    every layout that is met.
    """
    return numba.njit(signature, cache=True, error_model="numpy", fastmath={"contract"}, nogil=True)


compiled = compiled_for(None)


_TWO_OVER_PI = 2.0 / math.pi
# π/2 in three parts, of 33 bits each the first two: n times them is exact for |n| ≤ 2^20
_MOST_QUARTERS = 2.0**20
_PART_1 = float.fromhex("0x1.921fb54400000p+0")
_PART_2 = float.fromhex("0x1.0b4611a600000p-34")
_PART_3 = float.fromhex("0x1.3198a2e037073p-69")


@compiled
def run(code, w):  # type: ignore[no-untyped-def]
    """Run a program (K, 5) over a workspace (R, LANES)."""
    for k in range(code.shape[0]):
        op = code[k, 0]
        d, a, b, c = code[k, 1], code[k, 2], code[k, 3], code[k, 4]
        if op == 5:
            for i in range(LANES):
                w[d, i] = w[a, i] * w[b, i] + w[c, i]
        elif op == 3:
            for i in range(LANES):
                w[d, i] = w[a, i] * w[b, i]
        elif op == 1:
            for i in range(LANES):
                w[d, i] = w[a, i] + w[b, i]
        elif op == 2:
            for i in range(LANES):
                w[d, i] = w[a, i] - w[b, i]
        elif op == 7:
            for i in range(LANES):
                w[d, i] = w[c, i] - w[a, i] * w[b, i]
        elif op == 6:
            for i in range(LANES):
                w[d, i] = w[a, i] * w[b, i] - w[c, i]
        elif op == 15:
            for i in range(LANES):
                yes, no = w[b, i], w[c, i]
                w[d, i] = yes if w[a, i] > 0.5 else no
        elif op == 18:
            for i in range(LANES):
                yes = w[b, i]
                w[d, i] = yes if w[a, i] > 0.5 else w[d, i]
        elif op == 19:
            for i in range(LANES):
                w[d, i] -= w[a, i]
        elif op == 13:
            _sin_cos(w, a, d, c)
        elif op == 0:
            for i in range(LANES):
                w[d, i] = w[a, i]
        elif op == 8:
            for i in range(LANES):
                w[d, i] = -w[a, i]
        elif op == 9:
            for i in range(LANES):
                w[d, i] = abs(w[a, i])
        elif op == 10:
            for i in range(LANES):
                x, y = w[a, i], w[b, i]
                w[d, i] = x if (x > y) | (x != x) else y
        elif op == 11:
            for i in range(LANES):
                x, y = w[a, i], w[b, i]
                w[d, i] = x if (x < y) | (x != x) else y
        elif op == 16:
            for i in range(LANES):
                w[d, i] = 1.0 if w[a, i] <= w[b, i] else 0.0
        elif op == 17:
            for i in range(LANES):
                w[d, i] = w[a, i] * w[b, i]
        elif op == 4:
            for i in range(LANES):
                w[d, i] = w[a, i] / w[b, i]
        elif op == 12:
            for i in range(LANES):
                w[d, i] = math.sqrt(w[a, i])


@compiled
def _sin_cos(w, a, sine, cosine):  # type: ignore[no-untyped-def]
    """Reduced to within π/4 of a multiple of π/2, then Taylor's series.

    For |x| below a million the error is below 2.5 · 2⁻⁵³, and three units in the last place; far
    beyond, where the reduction would lose digits, what is returned is not a number.
    """
    for i in range(LANES):
        x = w[a, i]
        n = np.floor(x * _TWO_OVER_PI + 0.5)
        r = ((x - n * _PART_1) - n * _PART_2) - n * _PART_3
        r = r if abs(n) <= _MOST_QUARTERS else math.nan
        z = r * r
        s = -7.647163731819816e-13 + z * 2.8114572543455206e-15
        s = 1.6059043836821613e-10 + z * s
        s = -2.505210838544172e-08 + z * s
        s = 2.7557319223985893e-06 + z * s
        s = -0.0001984126984126984 + z * s
        s = 0.008333333333333333 + z * s
        s = -0.16666666666666666 + z * s
        s = r + r * z * s
        p = 4.779477332387385e-14 + z * -1.5619206968586225e-16
        p = -1.1470745597729725e-11 + z * p
        p = 2.08767569878681e-09 + z * p
        p = -2.755731922398589e-07 + z * p
        p = 2.48015873015873e-05 + z * p
        p = -0.001388888888888889 + z * p
        p = 0.041666666666666664 + z * p
        p = 1.0 - 0.5 * z + z * z * p
        q = n - 4.0 * np.floor(0.25 * n)
        odd = (q == 1.0) | (q == 3.0)
        u = p if odd else s
        v = s if odd else p
        w[sine, i] = -u if q >= 2.0 else u
        w[cosine, i] = -v if (q == 1.0) | (q == 2.0) else v
