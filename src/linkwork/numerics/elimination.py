"""Linear equations with few unknowns, in plain numbers where that is quicker than LAPACK."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

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
    try:
        found: Row = np.linalg.solve(np.array([row[:n] for row in matrix]), right).tolist()
    except np.linalg.LinAlgError:
        return None
    return found


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
    array = np.array([row[:n] for row in matrix])
    try:
        found: list[Row] = np.linalg.inv(array).tolist()
    except np.linalg.LinAlgError:
        return [[math.nan] * n for _ in range(n)], 0
    return found, _sign(float(np.linalg.det(array)))


def _sign(x: float) -> int:
    """0 for what is not a number."""
    return (x > 0.0) - (x < 0.0)
