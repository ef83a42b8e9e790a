"""Immutable containers: a dictionary and read-only arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn, TypeVar

import numpy as np

from linkwork.foundation.arrays import AnyArray

__all__ = ["FrozenDict", "read_only"]

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


def read_only(array: AnyArray) -> AnyArray:
    """A copy that refuses writes."""
    frozen = np.array(array)
    frozen.flags.writeable = False
    return frozen
