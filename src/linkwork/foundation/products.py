"""Products of stacked and of very tall matrices."""

from __future__ import annotations

from typing import TypeVar, overload

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["Numbers", "matrix_vector", "tall_product"]

_MOST = 16384  # multiplications at once, below the number from which on threads are used
_TALLEST, _SHORTEST = 256, 16  # rows at once

#: Real or complex numbers.
Numbers = TypeVar("Numbers", Array, ComplexArray)


def matrix_vector(matrices: Numbers, vectors: Numbers) -> Numbers:
    """A x for stacked matrices (B, n, m) and vectors (B, m), (B, n)."""
    product: Numbers = (matrices @ vectors[:, :, None])[:, :, 0]
    return product


@overload
def tall_product(a: Array, b: Array) -> Array: ...
@overload
def tall_product(a: Array | ComplexArray, b: ComplexArray) -> ComplexArray: ...
def tall_product(a: Array | ComplexArray, b: Array | ComplexArray) -> Array | ComplexArray:
    """a b for a (B, K), b (K, M): some rows of ``a`` at a time, by one thread.

    BLAS would use threads that wait longer than they work.
    """
    rows, inner = a.shape
    columns = b.shape[1]
    # BLAS starts threads for larger products, which takes longer than these do
    height = min(_TALLEST, max(_SHORTEST, _MOST // max(1, inner * columns)))
    if rows <= height or not inner * columns:
        few: Array | ComplexArray = a @ b
        return few
    product: Array | ComplexArray = np.empty((rows, columns), dtype=np.result_type(a, b))
    whole = rows - rows % height
    stacked = product[:whole].reshape(-1, height, columns)
    np.matmul(a[:whole].reshape(-1, height, inner), b, out=stacked)
    np.matmul(a[whole:], b, out=product[whole:])
    return product
