"""Whether compiled code exists already; found without loading it, or Numba."""

from __future__ import annotations

import hashlib
import logging
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from platformdirs import user_cache_path

__all__ = ["kernels_are_compiled", "kernels_are_loaded", "say_that_it_compiles"]

_LAST = (
    Path(__file__).parents[1] / "march" / "rowwise.py"
)  # of the modules that take long to compile


def kernels_are_loaded() -> bool:
    """Whether this process has the kernels in use."""
    return "linkwork.kernels.march.rowwise" in sys.modules


def kernels_are_compiled() -> bool:
    """Whether an earlier process has left the kernels compiled: next to their sources, in the
    user's cache where that cannot be written to, or in the folder named by ``NUMBA_CACHE_DIR``.
    """
    return any(map(_is_of_this_source, _indices()))


def _indices() -> Iterator[Path]:
    """Numba's index files of the compiled code that takes longest."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    shared = Path(given) if given else user_cache_path("numba", appauthor=False)
    folders = list(shared.glob(f"{_LAST.parent.name}_*"))
    if not given:
        folders.append(_LAST.parent / "__pycache__")
    for folder in folders:
        yield from folder.glob(f"{_LAST.stem}.by_rows-*.nbi")


def _is_of_this_source(index: Path) -> bool:
    """By the digest that numba keeps in it, for the times of files tell nothing in a copy; without
    one, as before numba 0.68, by them.
    """
    if hashlib.sha256(_LAST.read_bytes()).digest() in index.read_bytes():
        return True
    return index.stat().st_mtime >= _LAST.stat().st_mtime


def say_that_it_compiles() -> None:
    """Tell users why they wait, if they will: a warning in the log ``linkwork``."""
    if not kernels_are_compiled():
        logging.getLogger("linkwork").warning(
            "compiling Linkwork's kernels, once after an installation: one or two minutes"
        )
