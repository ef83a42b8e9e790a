"""Whether compiled code is there already; without loading any of it, nor what compiles it."""

from __future__ import annotations

import logging
import os
import sys
from pathlib import Path

from platformdirs import user_cache_path

__all__ = ["compiled_code_is_at_hand", "compiled_code_is_loaded", "say_that_it_compiles"]

_LAST = "rowwise"  # of the modules that take long to compile


def compiled_code_is_loaded() -> bool:
    """Whether this process has the kernels in use."""
    return f"{__package__}.{_LAST}" in sys.modules


def compiled_code_is_at_hand() -> bool:
    """Whether an earlier process has left the kernels compiled: beside their sources, in the user's
    cache where that cannot be written to, or in the folder that ``NUMBA_CACHE_DIR`` names.
    """
    here = Path(__file__).parent
    source = (here / f"{_LAST}.py").stat().st_mtime
    given = os.environ.get("NUMBA_CACHE_DIR")
    shared = Path(given) if given else user_cache_path("numba", appauthor=False)
    folders = list(shared.glob(f"{here.name}_*"))
    if not given:
        folders.append(here / "__pycache__")
    left = (entry for folder in folders for entry in folder.glob(f"{_LAST}.by_rows-*.nbi"))
    return any(entry.stat().st_mtime >= source for entry in left)


def say_that_it_compiles() -> None:
    """Tell users why they wait, if they will: a warning in the log ``linkwork``."""
    if not compiled_code_is_at_hand():
        logging.getLogger("linkwork").warning(
            "compiling Linkwork's kernels, once after an installation: one or two minutes"
        )
