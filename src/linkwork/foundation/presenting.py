"""Registration of functions that display results, or compute further ones, by layers above."""

from __future__ import annotations

from collections.abc import Callable
from typing import Concatenate, ParamSpec, TypeVar, cast

__all__ = ["presenter", "register_presenter", "register_when_needed"]

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")

_presenters: dict[Callable[..., object], Callable[[], Callable[..., object]]] = {}
_registrations: list[Callable[[], None]] = []


def register_presenter(
    method: Callable[Concatenate[T, P], R], load: Callable[[], Callable[Concatenate[T, P], R]]
) -> None:
    """Let a function with the signature of a method do the work of the method.

    Parameters
    ----------
    method : callable
        A method of a result, ``Motion.plot``.
    load : callable
        Returns the function; called whenever the method is, so that it may load what is needed.
    """
    _presenters[method] = load


def register_when_needed(registration: Callable[[], None]) -> None:
    """Call a function that registers presenters as soon as one is asked for."""
    _registrations.append(registration)


def presenter(method: Callable[P, R]) -> Callable[P, R]:
    """The function that does the work of a method.

    Raises
    ------
    LookupError
        If none is registered.
    """
    while _registrations:
        _registrations.pop()()
    if method not in _presenters:
        raise LookupError(f"no presenter is registered for {method.__qualname__}")
    return cast("Callable[P, R]", _presenters[method]())
