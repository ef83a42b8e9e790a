"""Packages whose names are loaded on first use, so that nobody pays for what is not needed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module

__all__ = ["loader"]


def loader(package: str, homes: Mapping[str, tuple[str, ...]]) -> Callable[[str], object]:
    """The module-level ``__getattr__`` (PEP 562) of a package.

    Parameters
    ----------
    package : str
        ``__name__`` of the package.
    homes : Mapping[str, tuple of str]
        For each module of the package the names that it provides.
    """
    home = {name: module for module, names in homes.items() for name in names}

    def load(name: str) -> object:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value: object = getattr(import_module(f"{package}.{home[name]}"), name)
        # Python binds a module that was imported on the way to its own name in the package, which
        # may be the name of a function too: every module that is there now provides its names
        for module, names in homes.items():
            loaded = sys.modules.get(f"{package}.{module}")
            for one in names:
                if hasattr(loaded, one):
                    setattr(sys.modules[package], one, getattr(loaded, one))
        return value

    return load
