"""Complex linear systems side by side in the lanes: Gauss's elimination, pivots chosen by lane."""

from __future__ import annotations

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.kernels.program.compiling import njit_no_refcount

__all__ = ["solve_in_lanes"]


@njit_no_refcount
def _subtract(w: Array, target: int, factor: int, source: int, lanes: int) -> None:
    """target -= factor * source, complex."""
    for i in range(lanes):
        a, b, c, d = w[factor, i], w[factor + 1, i], w[source, i], w[source + 1, i]
        w[target, i] -= a * c - b * d
        w[target + 1, i] -= a * d + b * c


@njit_no_refcount
def _multiply(w: Array, target: int, factor: int, lanes: int) -> None:
    """target *= factor, complex."""
    for i in range(lanes):
        a, b, c, d = w[factor, i], w[factor + 1, i], w[target, i], w[target + 1, i]
        w[target, i] = a * c - b * d
        w[target + 1, i] = a * d + b * c


@njit_no_refcount
def _invert(w: Array, target: int, lanes: int) -> None:
    """target = 1 / target, complex."""
    for i in range(lanes):
        a, b = w[target, i], w[target + 1, i]
        size = 1.0 / (a * a + b * b)
        w[target, i], w[target + 1, i] = a * size, -b * size


@njit_no_refcount
def _choose_pivots(
    w: Array, n: int, matrix: int, k: int, best: Array, row: IndexArray, lanes: int
) -> None:
    """The row (LANES,) of the largest number in the column k, from the row k on."""
    for i in range(lanes):
        a, b = w[matrix + 2 * (k * n + k), i], w[matrix + 2 * (k * n + k) + 1, i]
        best[i], row[i] = a * a + b * b, k
    for j in range(k + 1, n):
        place = matrix + 2 * (j * n + k)
        for i in range(lanes):
            a, b = w[place, i], w[place + 1, i]
            size = a * a + b * b
            larger = size > best[i]
            best[i] = size if larger else best[i]
            row[i] = j if larger else row[i]


@njit_no_refcount
def _exchange(w: Array, one: int, other: int, count: int, lane: int) -> None:
    """Exchange numbers from two registers on in one lane."""
    for k in range(count):
        w[one + k, lane], w[other + k, lane] = w[other + k, lane], w[one + k, lane]


@njit_no_refcount
def solve_in_lanes(
    w: Array, n: int, matrix: int, right: int, other: int, best: Array, row: IndexArray, lanes: int
) -> None:
    """Solve for two right sides, which the solutions replace; the matrix is used up.

    Parameters
    ----------
    w : (R, LANES)
    matrix, right, other : int
        The first register of the matrix, row by row, and of both right sides.
    best, row : (LANES,)
        Work arrays.
    lanes : int
        The first lanes, in which there is something to solve.
    """
    for k in range(n):
        _choose_pivots(w, n, matrix, k, best, row, lanes)
        own = matrix + 2 * k * n
        for i in range(lanes):
            if row[i] != k:
                there = row[i]
                _exchange(w, own + 2 * k, matrix + 2 * (there * n + k), 2 * (n - k), i)
                _exchange(w, right + 2 * k, right + 2 * there, 2, i)
                _exchange(w, other + 2 * k, other + 2 * there, 2, i)
        _invert(w, own + 2 * k, lanes)
        for column in range(k + 1, n):
            _multiply(w, own + 2 * column, own + 2 * k, lanes)
        _multiply(w, right + 2 * k, own + 2 * k, lanes)
        _multiply(w, other + 2 * k, own + 2 * k, lanes)
        for j in range(k + 1, n):
            lower = matrix + 2 * (j * n + k)
            for column in range(k + 1, n):
                _subtract(w, matrix + 2 * (j * n + column), lower, own + 2 * column, lanes)
            _subtract(w, right + 2 * j, lower, right + 2 * k, lanes)
            _subtract(w, other + 2 * j, lower, other + 2 * k, lanes)
    for k in range(n - 1, -1, -1):
        for j in range(k):
            upper = matrix + 2 * (j * n + k)
            _subtract(w, right + 2 * j, upper, right + 2 * k, lanes)
            _subtract(w, other + 2 * j, upper, other + 2 * k, lanes)
