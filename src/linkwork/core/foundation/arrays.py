"""Types of arrays, small matrices, stacked systems, batches, disjoint sets."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, Self, TypeVar, overload

import numpy as np

# ----------------------------------------------------------------------
# Type names for NumPy arrays by their contents.
#
# Importing ``numpy.typing`` costs a quarter of importing NumPy, so only type checkers do.


if TYPE_CHECKING:
    import numpy.typing as npt

    AnyArray = npt.NDArray[Any]
    Array = npt.NDArray[np.float64]
    BoolArray = npt.NDArray[np.bool_]
    ComplexArray = npt.NDArray[np.complex128]
    CountArray = npt.NDArray[np.int64]
    IndexArray = npt.NDArray[np.intp]
    StatusArray = npt.NDArray[np.int8]
    TurnArray = npt.NDArray[np.int32]
else:
    AnyArray = Array = BoolArray = ComplexArray = np.ndarray
    CountArray = IndexArray = StatusArray = TurnArray = np.ndarray


# ----------------------------------------------------------------------
# Arrays aligned to cache lines, without which vector instructions take a third longer.


_LINE = 64  # bytes


def allocate_aligned(*shape: int) -> Array:
    """Numbers that are not set, in a C-contiguous array at a multiple of 64 bytes."""
    size = math.prod(shape)
    room: Array = np.empty(size + _LINE // 8 - 1)
    # NumPy aligns to 16 bytes only: skip numbers up to the next line
    first = -room.ctypes.data // 8 % (_LINE // 8)
    return room[first : first + size].reshape(shape)


# ----------------------------------------------------------------------
# Products of stacked and of very tall matrices.


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


# ----------------------------------------------------------------------
# Linear systems of stacked matrices, some of which may be singular.


def solutions(matrices: Numbers, right: Numbers) -> Numbers:
    """X with A X = B for stacked (B, n, n) and (B, n, k); NaN where a matrix is singular."""
    found: Numbers = _each(np.linalg.solve, matrices, right)
    return found


def inverses(matrices: Numbers) -> Numbers:
    """The inverses of stacked matrices (B, n, n); NaN where one is singular."""
    found: Numbers = _each(np.linalg.inv, matrices)
    return found


def _each(function: Callable[..., Any], *stacks: Any) -> Any:
    try:
        return function(*stacks)
    except np.linalg.LinAlgError:
        # one singular matrix makes NumPy refuse all: the others are solved one by one
        found = np.full(stacks[-1].shape, np.nan, dtype=stacks[-1].dtype)
        for k, own in enumerate(zip(*stacks, strict=True)):
            with suppress(np.linalg.LinAlgError):
                found[k] = function(*own)
        return found


# ----------------------------------------------------------------------
# Data classes that hold many things of one kind.


class Batch:
    """A data class with arrays, in which each thing has one row; other fields belong to all."""

    @property
    def _arrays(self) -> dict[str, AnyArray]:
        every = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]  # a data class
        return {name: x for name, x in every.items() if isinstance(x, np.ndarray)}

    def take(self, index: IndexArray | BoolArray | slice) -> Self:
        """Some of the things, in the order of ``index``."""
        some: Any = {name: x[index] for name, x in self._arrays.items()}
        return replace(self, **some)  # type: ignore[type-var]  # a data class

    @classmethod
    def joined(cls, parts: Iterable[Self]) -> Self:
        """The things of several batches, in their order."""
        first, *others = parts
        every: Any = {
            name: np.concatenate([x, *(getattr(part, name) for part in others)])
            for name, x in first._arrays.items()
        }
        return replace(first, **every)  # type: ignore[type-var]  # a data class


# ----------------------------------------------------------------------
# Disjoint sets of numbered things, united two at a time (union-find).


class DisjointSets:
    """Sets of the numbers 0, 1, …; a set is named by its smallest number, its root."""

    def __init__(self, count: int = 0) -> None:
        self.above = list(range(count))

    def add(self) -> int:
        """Add the next number as a set of one element."""
        self.above.append(len(self.above))
        return self.above[-1]

    def root(self, k: int) -> int:
        """The smallest number of the set that holds k."""
        while self.above[k] != k:
            k = self.above[k]
        return k

    def unite(self, a: int, b: int) -> bool:
        """Unite the sets of a and b; returns whether they were different."""
        # the smaller root stays, so that names of sets do not depend on the order of unions
        first, second = sorted((self.root(a), self.root(b)))
        self.above[second] = first
        return first != second
