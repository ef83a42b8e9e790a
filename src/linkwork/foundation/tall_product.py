"""Products of very tall matrices: BLAS would use threads that wait longer than they work."""

from __future__ import annotations

from typing import overload

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["tall_product"]

_MOST = 16384  # multiplications at once, below the number from which on threads are used
_TALLEST, _SHORTEST = 256, 16  # rows at once


@overload
def tall_product(a: Array, b: Array) -> Array: ...
@overload
def tall_product(a: Array | ComplexArray, b: ComplexArray) -> ComplexArray: ...
def tall_product(a: Array | ComplexArray, b: Array | ComplexArray) -> Array | ComplexArray:
    """a b for a (B, K), b (K, M): some rows of ``a`` at a time, by one thread."""
    rows, inner = a.shape
    columns = b.shape[1]
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
