"""Sine and cosine of one number, free of branches: lanes of them become vector instructions."""

from __future__ import annotations

import math

from linkwork.kernels.program.compiling import njit_no_refcount

__all__ = ["sin_cos"]

_TWO_OVER_PI = 2.0 / math.pi
_WHOLE = 1.5 * 2.0**52  # added and taken away again, it leaves the nearest whole number
# π/2 in three parts, of 33 bits each the first two: n times them is exact for |n| ≤ 2^20
_MOST_QUARTERS = 2.0**20
_PART_1 = float.fromhex("0x1.921fb54400000p+0")
_PART_2 = float.fromhex("0x1.0b4611a600000p-34")
_PART_3 = float.fromhex("0x1.3198a2e037073p-69")


@njit_no_refcount
def sin_cos(x: float) -> tuple[float, float]:
    """Reduced to within π/4 of a multiple of π/2, then Taylor's series.

    For |x| below a million the error is below 2.5 · 2⁻⁵³, and three units in the last place; far
    beyond, where the reduction would lose digits, the result is NaN.
    """
    n = (x * _TWO_OVER_PI + _WHOLE) - _WHOLE
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
    q = n - 4.0 * ((0.25 * n - 0.375 + _WHOLE) - _WHOLE)  # 0, 1, 2 or 3
    odd = (q == 1.0) | (q == 3.0)
    u = p if odd else s
    v = s if odd else p
    sine = -u if q >= 2.0 else u
    cosine = -v if (q == 1.0) | (q == 2.0) else v
    return sine, cosine
