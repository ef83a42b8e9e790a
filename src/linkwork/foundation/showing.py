"""How results show themselves without knowing who draws.

Results lie below drawings and import none of them. The root package, which knows both, names the
function that shows a result; it is loaded when a result is shown for the first time.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

__all__ = ["shower", "shown_by"]

_SHOWERS: dict[str, tuple[str, str]] = {}


def shown_by(what: str, module: str, function: str) -> None:
    """Name the function of a module that shows something, ``Motion.plot``."""
    _SHOWERS[what] = (module, function)


def shower(what: str) -> Callable[..., Any]:
    """The function that shows something.

    Raises
    ------
    LookupError
        If nobody has named one.
    """
    if what not in _SHOWERS:
        raise LookupError(f'no function is named for "{what}"')
    module, function = _SHOWERS[what]
    found: Callable[..., Any] = getattr(import_module(module), function)
    return found
