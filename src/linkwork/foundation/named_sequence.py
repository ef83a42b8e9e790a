"""Results in an order, each with a name."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import SupportsIndex, TypeVar, overload

from linkwork.foundation.errors import UnknownNameError, choices

__all__ = ["NamedSequence"]

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
