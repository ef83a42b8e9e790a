"""Frozen mappings, named sequences, deferred values."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import (
    Any,
    Generic,
    NoReturn,
    SupportsIndex,
    TypeVar,
    overload,
)

import numpy as np

from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.errors import UnknownNameError, choices

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
