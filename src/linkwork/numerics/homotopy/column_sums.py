"""Columns of closure matrices as sums of free coefficients: the structure of a family.

A link with three joints enters the loops with a, b and a + b, and loops that do not pass it
with 0. Which coefficients of a column are zero, and which are sums of others, is the same for all
mechanisms of one structure; the free coefficients are their dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import product

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

__all__ = [
    "Columns",
    "column_ranks",
    "columns_of",
    "random_closures",
    "rank_together",
    "sums_hold",
]

#: For every column of a closure matrix its L coefficients as tuples of weights of free ones.
Columns = tuple[tuple[tuple[int, ...], ...], ...]

_SAME_SUM = 1e-11  # relative: two sums of coefficients are the same by construction
_LARGEST_FREE = 6  # coefficients of a column among which sums are looked for
_ROUNDING = 64 * UNIT_ROUNDOFF  # of coefficients of a column, relative to the largest


def columns_of(closures: ComplexArray) -> Columns:
    """The columns of a closure matrix (L, K) as sums of free coefficients."""
    return tuple(_sums(column.tolist()) for column in closures.T)


def random_closures(columns: Columns, rng: np.random.Generator) -> ComplexArray:
    """A closure matrix (L, K) with such columns."""
    parts = []
    for column in columns:
        weights = np.array(column, dtype=float)
        free = rng.normal(size=weights.shape[1]) + 1j * rng.normal(size=weights.shape[1])
        parts.append(weights @ free)
    return np.stack(parts, axis=1)


def sums_hold(columns: Columns, closures: ComplexArray, spread: Array) -> bool:
    """Whether all sums of a closure matrix (L, K) hold within rounding.

    Parameters
    ----------
    spread : (L, K)
        How far each coefficient may be from its true value.

    Notes
    -----
    :func:`columns_of` takes coefficients for sums that differ from them by more than that: good
    enough for a random relative, not for a proof.
    """
    made = _as_sums(columns)
    apart = np.abs((made @ closures.T[:, :, None])[:, :, 0].T - closures)
    unsure = spread + (np.abs(made) @ spread.T[:, :, None])[:, :, 0].T
    rounding = _ROUNDING * np.abs(closures).max(axis=0)
    return bool((apart <= np.minimum(unsure, rounding)).all())


@cache
def _as_sums(columns: Columns) -> Array:
    """(K, L, L): every column as sums of its own coefficients, the free ones as themselves."""
    loops = len(columns[0])
    made = np.zeros((len(columns), loops, loops))
    for matrix, column in zip(made, columns, strict=True):
        width = len(column[0])
        first = [column.index(tuple(int(j == k) for j in range(width))) for k in range(width)]
        matrix[:, first] = column
    return made


def column_ranks(columns: Columns) -> list[int]:
    """The rank of every set of columns for almost all values of the free coefficients.

    A set of columns, as a bit mask s, has rank r(s) = min over its subsets k of
    f(k) + |s| - |k|, where f is the rank of all vectors that free coefficients of k multiply (Rado
    1942, Q. J. Math. 13, 83): determinants are sums of different monomials, one for each choice of
    a vector per column. Integers, so nothing is rounded.
    """
    loops = len(columns[0])
    vectors = [tuple(zip(*column, strict=True)) for column in columns]
    spans: list[tuple[_Pivoted, ...]] = [()]
    ranks = [0]  # f(s) - |s| first, then r(s) - |s|
    for chosen in vectors:
        for span, rank in zip(spans[:], ranks[:], strict=True):
            wider = _span(span, chosen, loops)
            spans.append(wider)
            ranks.append(rank + len(wider) - len(span) - 1)
    for k in range(len(columns)):
        bit = 1 << k
        for s in range(len(ranks)):
            if s & bit:
                # minimum over subsets, one element at a time
                ranks[s] = min(ranks[s], ranks[s ^ bit])
    return [rank + s.bit_count() for s, rank in enumerate(ranks)]


def rank_together(columns: Columns) -> int:
    """The rank of all vectors that free coefficients of some columns multiply."""
    vectors = [vector for column in columns for vector in zip(*column, strict=True)]
    return len(_span((), vectors, len(columns[0])))


_Pivoted = tuple[int, tuple[int, ...]]


def _span(
    span: tuple[_Pivoted, ...], vectors: Sequence[tuple[int, ...]], most: int
) -> tuple[_Pivoted, ...]:
    """A basis in echelon form, with the pivots' places, and further vectors."""
    for vector in vectors:
        if len(span) == most:
            break
        for place, row in span:
            if vector[place]:
                a, b = row[place], vector[place]
                vector = tuple(a * x - b * y for x, y in zip(vector, row, strict=True))
        pivot = next((k for k, x in enumerate(vector) if x), None)
        if pivot is not None:
            span = (*span, (pivot, vector))
    return span


def _sums(column: list[complex]) -> tuple[tuple[int, ...], ...]:
    """Every coefficient of a column as a sum, with weights -1, 0 and 1, of earlier free ones."""
    size = max(map(abs, column))
    free: list[complex] = []
    found: list[tuple[int, ...]] = []
    for value in column:
        few = free[:_LARGEST_FREE]
        # 0 first: a sparse sum before a dense one
        for weights in product((0, 1, -1), repeat=len(few)):
            rest = value - sum(w * c for w, c in zip(weights, few, strict=True))
            if abs(rest) <= _SAME_SUM * size:
                found.append(weights)
                break
        else:
            found.append((*(0 for _ in free), 1))
            free.append(value)
    width = len(free)
    return tuple((*weights, *(0 for _ in range(width - len(weights)))) for weights in found)
