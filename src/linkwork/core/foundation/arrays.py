"""Arrays, containers and rounding."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Generic, NoReturn, Self, SupportsIndex, TypeVar, overload

import numpy as np

from linkwork.core.foundation.errors import UnknownNameError, choices

if TYPE_CHECKING:
    import numpy.typing as npt

# ----------------------------------------------------------------------
# Types of arrays, small matrices, stacked systems, batches, disjoint sets.


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


# ----------------------------------------------------------------------
# Frozen mappings, named sequences, deferred values.


# ----------------------------------------------------------------------
# Immutable containers: dictionaries and read-only arrays.


K = TypeVar("K")
V = TypeVar("V")


class FrozenDict(dict[K, V]):
    """A dictionary that keeps its order, compares like a dictionary and refuses changes."""

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("a mechanism is immutable: build a changed copy instead")

    __setitem__ = __delitem__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse
    __ior__ = _refuse

    # pickling would fill the dictionary item by item, which is refused
    def __reduce__(self) -> tuple[type[FrozenDict[K, V]], tuple[dict[K, V]]]:
        return type(self), (dict(self),)

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))

    @classmethod
    def of(cls, mapping: Mapping[Any, Any] | None) -> FrozenDict[Any, Any]:
        """A frozen copy; ``None`` gives an empty one."""
        return cls(mapping or {})


class ComputedDict(Mapping[K, V]):
    """A mapping that computes each value when it is first asked for, and keeps it.

    Parameters
    ----------
    names : iterable
        All keys, in their order.
    compute : callable
        Gives the value of a key.
    """

    def __init__(self, names: Iterable[K], compute: Callable[[K], V]) -> None:
        self._values: dict[K, V | None] = dict.fromkeys(names)
        self._compute = compute

    def __getitem__(self, name: K) -> V:
        known = self._values[name]
        if known is None:
            known = self._values[name] = self._compute(name)
        return known

    def __iter__(self) -> Iterator[K]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def __repr__(self) -> str:
        return repr(dict(self))

    # the function that computes values need not be one that can be pickled
    def __reduce__(self) -> tuple[type[FrozenDict[K, V]], tuple[dict[K, V]]]:
        return FrozenDict, (dict(self),)


def read_only(array: AnyArray) -> AnyArray:
    """A copy that refuses writes."""
    frozen = np.array(array)
    frozen.flags.writeable = False
    return frozen


# ----------------------------------------------------------------------
# Results in an order, each with a name.


T = TypeVar("T")


class NamedSequence(Sequence[T]):
    """A sequence whose members have names too: indexed by number from 0, by slice or by name."""

    @property
    @abstractmethod
    def _by_name(self) -> tuple[tuple[str, T], ...]:
        """The members in their order, with their names."""

    @abstractmethod
    def _unknown(self, name: object) -> tuple[str, str]:
        """The problem with a name that no member has, and the word for members."""

    def __len__(self) -> int:
        return len(self._by_name)

    @overload
    def __getitem__(self, which: SupportsIndex | str) -> T: ...
    @overload
    def __getitem__(self, which: slice) -> tuple[T, ...]: ...
    def __getitem__(self, which: SupportsIndex | str | slice) -> T | tuple[T, ...]:
        """A member by its number, from 0, or by its name; several by a slice."""
        members = self._by_name
        if isinstance(which, slice):
            return tuple(member for _, member in members[which])
        if isinstance(which, SupportsIndex):
            return members[which][1]
        for name, member in members:
            if name == which:
                return member
        problem, kinds = self._unknown(which)
        raise UnknownNameError(f"{problem} {choices(kinds, [own for own, _ in members], which)}")


# ----------------------------------------------------------------------
# A value that is computed when it is first asked for.


class Deferred(Generic[T]):
    """The result of a function without arguments, computed once.

    A copy by pickle has the value: the function need not be one that can be pickled.
    """

    def __init__(self, compute: Callable[[], T]) -> None:
        self._compute: Callable[[], T] | None = compute

    @property
    def value(self) -> T:
        """Computed at the first call."""
        if self._compute is not None:
            self._value, self._compute = self._compute(), None
        return self._value

    def __reduce__(self) -> tuple[type[Deferred[T]], tuple[Callable[[], T]]]:
        return type(self), (partial(_same, self.value),)


def _same(value: T) -> T:
    return value


# ----------------------------------------------------------------------
# The rounding of floating-point numbers, and tolerances that several modules share.


#: The distance from 1 to the next larger number, 2⁻⁵²: twice the unit roundoff.
EPSILON = float(np.finfo(float).eps)
#: The same of extended precision, where the processor computes with it.
EXTENDED_EPSILON = float(np.finfo(np.longdouble).eps)
#: The largest relative error of one rounded operation, 2⁻⁵³.
UNIT_ROUNDOFF = EPSILON / 2.0
#: Of an angle: how far it may be off when it is printed in degrees. A link's constant is added, the
#: float of π/180 is rounded, the quotient, and the angle without its whole turns.
PRINTED_ANGLE = 4.0 * UNIT_ROUNDOFF
#: A factor that covers the rounding of a proof's own bounds, which are sums of positive numbers.
PROOF_SLACK = 1.0 + 1e-12

#: Smaller singular values, relative to the largest one of a scaled Jacobian, count as none.
RANK_TOLERANCE = 1e-9
#: Weighted: a correction beyond which Newton-Raphson has run away.
FAR = 1e9
#: Below that rounding, not the equations, decides the ratio of two corrections.
SMALLEST_RATIO = 1e-9
#: The condition number up to which a position has rates, and can begin a curve.
REGULAR_CONDITION = 1e5
#: Weighted: the furthest that a position moves when its input is made exact.
LARGEST_POLISH = 1e-6
#: A position belongs to a tangent of a crossing if its distance from that is at most this part of
#: its distance from the other one.
CLOSER_TANGENT = 0.1
#: Relative to their size: rows of a motion that differ by less show one position, solved twice.
EQUAL_ROWS = 1e-9
#: Relative: slower motion is rest, to the accuracy of positions.
REST = 1e-11
#: A complex solution this near to its mirror image may be a real one.
ALMOST_REAL = 1e-6
#: The same of a multiple solution, whose path ends less precisely.
ALMOST_DOUBLE = 1e-3
