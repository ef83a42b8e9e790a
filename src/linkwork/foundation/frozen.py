"""Immutable containers: dictionaries and read-only arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, NoReturn, TypeVar

import numpy as np

from linkwork.foundation.arrays import AnyArray

__all__ = ["ComputedDict", "FrozenDict", "read_only"]

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
