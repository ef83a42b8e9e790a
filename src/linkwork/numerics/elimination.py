"""Linear equations with few unknowns, in plain numbers and with the roundings of compiled code."""

from __future__ import annotations

import math
from collections.abc import Sequence

__all__ = ["inverse_and_sign", "solve_linear"]

Row = list[float]


def solve_linear(matrix: Sequence[Row], right: Row) -> Row | None:
    """x with A x = b for n rows b, from the first n columns of A; ``None`` if A is singular."""
    n = len(right)
    if n == 1:
        return [right[0] / matrix[0][0]] if matrix[0][0] else None
    if n == 2:  # most blocks are dyads
        a, b, *_ = matrix[0]
        c, d, *_ = matrix[1]
        r, s = right
        if abs(c) > abs(a):
            a, b, r, c, d, s = c, d, s, a, b, r
        if not a:
            return None
        share = c / a
        pivot = d - share * b
        if not pivot:
            return None
        y = (s - share * r) / pivot
        return [(r - b * y) / a, y]
    found = [[x] for x in right]
    sign = _eliminate([row[:n] for row in matrix], found)
    return [x for (x,) in found] if sign else None


def inverse_and_sign(matrix: Sequence[Row]) -> tuple[list[Row], int]:
    """The inverse of the first n columns of n rows and the sign of their determinant.

    NaN and 0 where it is singular.
    """
    n = len(matrix)
    if n == 1:
        x = matrix[0][0]
        return ([[1.0 / x]], _sign(x)) if x else ([[math.nan]], 0)
    if n == 2:
        a, b, *_ = matrix[0]
        c, d, *_ = matrix[1]
        exchanged = abs(c) > abs(a)
        if exchanged:
            a, b, c, d = c, d, a, b
        share = c / a if a else 0.0
        pivot = d - share * b
        if not (a and pivot):
            return [[math.nan] * 2, [math.nan] * 2], 0
        lower, last = -share / pivot, 1.0 / pivot
        rows = [[(1.0 - b * lower) / a, -b * last / a], [lower, last]]
        sign = _sign(a) * _sign(pivot)
        return ([row[::-1] for row in rows], -sign) if exchanged else (rows, sign)
    inverse = [[float(i == j) for j in range(n)] for i in range(n)]
    sign = _eliminate([row[:n] for row in matrix], inverse)
    return inverse, sign


def _eliminate(matrix: list[Row], right: list[Row]) -> int:
    """Solve A X = B, in place of B, with partial pivoting; the sign of det A.

    It is 0 where A is singular, B then NaN, or has NaN.
    """
    n, sign = len(matrix), 1
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i][k]) > abs(matrix[best][k]):
                best = i
        if best != k:
            sign = -sign
            matrix[k], matrix[best] = matrix[best], matrix[k]
            right[k], right[best] = right[best], right[k]
        above, known = matrix[k], right[k]
        pivot = above[k]
        if not pivot:
            right[:] = [[math.nan] * len(known) for _ in right]
            return 0
        sign *= _sign(pivot)
        for row, own in zip(matrix[k + 1 :], right[k + 1 :], strict=True):
            share = row[k] / pivot
            for j in range(k + 1, n):
                row[j] -= share * above[j]
            for j, x in enumerate(known):
                own[j] -= share * x
    for k in range(n - 1, -1, -1):
        row, own = matrix[k], right[k]
        for i in range(n - 1, k, -1):
            share = row[i]
            for j, x in enumerate(right[i]):
                own[j] -= share * x
        pivot = row[k]
        for j, x in enumerate(own):
            own[j] = x / pivot
    return sign


def _sign(x: float) -> int:
    """0 for what is not a number."""
    return (x > 0.0) - (x < 0.0)
