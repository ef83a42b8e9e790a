"""Linear equations with few unknowns, and conditions of their matrices, in compiled code.

As in :mod:`linkwork.numerics.elimination` and :mod:`linkwork.numerics.single_rows`.
"""

from __future__ import annotations

import math

from linkwork.foundation.arrays import Array
from linkwork.kernels.program.compiling import unfused

__all__ = ["condition_of", "eliminate", "nearness_of"]


@unfused
def eliminate(matrix: Array, right: Array) -> int:
    """Solve A X = B (n, m), in place of B, by elimination in A (n, n) with partial pivoting.

    Returns
    -------
    int
        The sign of det A: 0 where A is singular, B then NaN, or has NaN.
    """
    n, sign = len(matrix), 1
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            sign = -sign
            for j in range(n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            for j in range(right.shape[1]):
                right[k, j], right[best, j] = right[best, j], right[k, j]
        pivot = matrix[k, k]
        if pivot == 0.0:
            right[:] = math.nan
            return 0
        sign *= (pivot > 0.0) - (pivot < 0.0)
        for i in range(k + 1, n):
            share = matrix[i, k] / pivot
            for j in range(k + 1, n):
                matrix[i, j] -= share * matrix[k, j]
            for j in range(right.shape[1]):
                right[i, j] -= share * right[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(right.shape[1]):
            for i in range(n - 1, k, -1):
                right[k, j] -= matrix[k, i] * right[i, j]
            right[k, j] /= matrix[k, k]
    return sign


@unfused
def condition_of(jacobian: Array, inverse: Array, scale: Array, weights: Array) -> float:
    """‖J‖·‖J⁻¹‖ in the system's own weights."""
    forward, backward = -math.inf, -math.inf
    for i in range(len(inverse)):
        ahead, back = 0.0, 0.0
        for j in range(len(inverse)):
            ahead += abs(jacobian[i, j]) * weights[j]
            back += abs(inverse[i, j]) * scale[j]
        ahead, back = ahead / scale[i], back / weights[i]
        # what is not a number stays if it is the first
        forward = ahead if i == 0 or ahead > forward else forward
        backward = back if i == 0 or back > backward else backward
    product = forward * backward  # eq. (14)
    return product if product < math.inf else math.inf


@unfused
def nearness_of(jacobian: Array, inverse: Array, scale: Array, condition: float) -> float:
    """How near to a singular position; see :mod:`linkwork.numerics.block_solver`."""
    n = len(inverse)
    forward, backward = -math.inf, -math.inf
    for i in range(n):
        ahead, back, longest = 0.0, 0.0, 0.0
        for j in range(n):
            own = _longest(jacobian, scale, j)
            if own == 0.0:
                return condition
            ahead += abs(jacobian[i, j]) / scale[i] / own
            back += abs(inverse[i, j]) * scale[j]
            longest = own if j == i else longest
        back *= longest
        forward = ahead if i == 0 or ahead > forward else forward
        backward = back if i == 0 or back > backward else backward
    balanced = forward * backward
    least = condition
    if balanced < math.inf:
        least = balanced if balanced < condition else condition
    return math.sqrt(condition) * math.sqrt(least)  # eq. (15)


@unfused
def _longest(jacobian: Array, scale: Array, j: int) -> float:
    """The largest scaled entry of a column."""
    longest = float(abs(jacobian[0, j]) / scale[0])
    for i in range(1, len(scale)):
        own = float(abs(jacobian[i, j]) / scale[i])
        longest = own if own > longest else longest
    return longest
