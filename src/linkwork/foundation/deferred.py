"""A value that is computed when it is first asked for."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Generic, TypeVar

__all__ = ["Deferred"]

T = TypeVar("T")


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
