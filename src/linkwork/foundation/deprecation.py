"""Former public names keep working for two minor releases, with a ``DeprecationWarning``."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import wraps
from types import ModuleType
from typing import ParamSpec, TypeVar

__all__ = ["former_method", "former_module"]

P = ParamSpec("P")
R = TypeVar("R")


def former_module(former: str, module: ModuleType, removed_in: str) -> Callable[[str], object]:
    """The ``__getattr__`` (PEP 562) of a module that has another name now.

    Parameters
    ----------
    former : str
        ``__name__`` of the module that calls this.
    module : module
        Has all the names under its own.
    removed_in : str
        The version that no longer has the former name.
    """

    def get(name: str) -> object:
        if name.startswith("__") and name != "__all__":
            raise AttributeError(f"module {former!r} has no attribute {name!r}")
        value: object = getattr(module, name)
        _warn(f"{former}.{name}", f"{module.__name__}.{name}", removed_in)
        return value

    return get


def former_method(former: str, method: Callable[P, R], removed_in: str) -> Callable[P, R]:
    """A method under its former name."""

    @wraps(method)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        _warn(f"{former}()", f"{method.__name__}()", removed_in)
        return method(*args, **kwargs)

    return call


def _warn(former: str, name: str, removed_in: str) -> None:
    warnings.warn(
        f"{former} is now {name}; the former name is removed in version {removed_in}",
        DeprecationWarning,
        stacklevel=3,
    )
