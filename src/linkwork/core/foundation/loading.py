"""Loading public names, optional packages and threads when they are needed."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from threading import Lock
from types import ModuleType
from typing import TypeVar

from linkwork.core.foundation.errors import MissingPackageError

# ----------------------------------------------------------------------
# Packages load the modules of their public names on first use.


def loader(package: str) -> Callable[[str], object]:
    """The ``__getattr__`` (PEP 562) of a package, with its ``__all__`` and ``__dir__``.

    The public names of a package are written once, in its block for type checkers, as
    ``from linkwork.package.module import Name as Name``, or ``from linkwork import package as
    package``. Such a line is carried out when its name is first used.

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
        if homes()[name] == package:
            return import_module(f"{package}.{name}")
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


# ----------------------------------------------------------------------
# Packages that only some results need, imported where these are asked for.


@contextmanager
def installed_with(extra: str, need: str) -> Iterator[None]:
    """Around the import of packages of an extra; ``need`` says what needs them.

    Raises
    ------
    MissingPackageError
        If they are not installed.
    """
    try:
        yield
    except ImportError:
        raise MissingPackageError(f'{need}: pip install "linkwork[{extra}]"') from None


# ----------------------------------------------------------------------
# Work shared among threads; the calling thread takes part.


Item = TypeVar("Item")


def cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_out(work: Callable[[Item], object], items: Iterable[Item], threads: int) -> None:
    """Apply ``work`` to every item; a free thread takes the next one.

    The calling thread works too, since a waiting thread would occupy a core while the new threads
    start. The first exception is raised here, and no further item is begun.
    """
    left, lock = iter(items), Lock()

    def take_turns() -> None:
        nonlocal left
        while True:
            # iterators are not safe among threads
            with lock:
                try:
                    item = next(left)
                except StopIteration:
                    return
            try:
                work(item)
            except BaseException:
                with lock:
                    # after an error no thread begins a further item
                    left = iter(())
                raise

    if threads <= 1:
        take_turns()
        return
    with ThreadPoolExecutor(threads - 1) as pool:
        helpers = [pool.submit(take_turns) for _ in range(threads - 1)]
        take_turns()
    for helper in helpers:
        # raises the error of a helper here
        helper.result()
