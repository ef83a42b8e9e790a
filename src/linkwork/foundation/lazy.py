"""Packages whose names are loaded on first use, so that nobody pays for what is not needed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType

__all__ = ["loader"]


def loader(package: str, homes: Mapping[str, tuple[str, ...]]) -> Callable[[str], object]:
    """The module-level ``__getattr__`` (PEP 562) of a package, whose ``dir`` is told the names too.

    Parameters
    ----------
    package : str
        ``__name__`` of the package.
    homes : Mapping[str, tuple of str]
        For each module of the package the names that it provides.
    """
    home = {name: module for module, names in homes.items() for name in names}
    there = vars(sys.modules[package])

    def load(name: str) -> object:
        if name not in home:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value: object = getattr(import_module(f"{package}.{home[name]}"), name)
        # importing a module puts it into its package under its own name, over a name it provides
        for module, names in homes.items():
            loaded = sys.modules.get(f"{package}.{module}")
            for own in names:
                if hasattr(loaded, own) and isinstance(there.get(own, loaded), ModuleType):
                    there[own] = getattr(loaded, own)
        return value

    # with no __dir__ of its own, a package would list only what somebody has used already
    there["__dir__"] = lambda: sorted({*home, *(n for n in there if n.startswith("__"))})
    return load
