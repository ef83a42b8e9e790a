"""Packages load the modules of their public names on first use."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from types import ModuleType

__all__ = ["loader"]


def loader(package: str) -> Callable[[str], object]:
    """The ``__getattr__`` (PEP 562) of a package, with its ``__all__`` and ``__dir__``.

    The public names of a package are written once, in its block for type checkers, as
    ``from linkwork.package.module import Name as Name``. Such a line is carried out when its name
    is first used.

    Parameters
    ----------
    package : str
        ``__name__`` of the package.

    Raises
    ------
    OSError
        On first use, if the package was installed without its source.
    """
    module = sys.modules[package]
    there = vars(module)

    @cache
    def homes() -> dict[str, str]:
        """The module that defines each public name."""
        import ast  # commands use modules, and do without these
        import inspect

        return {
            alias.name: statement.module
            for statement in ast.walk(ast.parse(inspect.getsource(module)))
            if isinstance(statement, ast.ImportFrom) and statement.module
            for alias in statement.names
            if alias.asname == alias.name
        }

    def load(name: str) -> object:
        if name == "__all__":
            return sorted(homes())
        if name.startswith("__") or name not in homes():
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value: object = getattr(import_module(homes()[name]), name)
        # importing a module puts it into its package under its own name, over a name it provides
        for own, home in homes().items():
            loaded = sys.modules.get(home)
            if hasattr(loaded, own) and isinstance(there.get(own, loaded), ModuleType):
                there[own] = getattr(loaded, own)
        return value

    # with no __dir__ of its own, a package would list only what somebody has used already
    there["__dir__"] = lambda: sorted({*homes(), *(n for n in there if n.startswith("__"))})
    return load
