"""Members of public classes that serve the package only."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

__all__ = ["internal", "internal_members"]

T = TypeVar("T", bound=type)
_NAMES = "__linkwork_internal__"


def internal(*names: str) -> Callable[[T], T]:
    """A class decorator: these fields and methods are no part of the public interface.

    The reference leaves them out; all others have public types in their signatures.
    """

    def marked(kind: T) -> T:
        setattr(kind, _NAMES, frozenset(names))
        return kind

    return marked


def internal_members(kind: type) -> frozenset[str]:
    """The internal members of a class and its base classes."""
    return frozenset().union(*(vars(base).get(_NAMES, ()) for base in kind.__mro__))
