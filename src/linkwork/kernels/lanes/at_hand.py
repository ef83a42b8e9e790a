"""Whether compiled code is there already; without loading any of it, nor what compiles it."""

from __future__ import annotations

import os
import sys
from pathlib import Path

__all__ = ["compiled_code_is_at_hand", "compiled_code_is_loaded"]

_LAST = "rowwise"  # of the modules that take long to compile


def compiled_code_is_loaded() -> bool:
    """Whether this process has the kernels in use."""
    return f"{__package__}.{_LAST}" in sys.modules


def compiled_code_is_at_hand() -> bool:
    """Whether an earlier process has left the kernels compiled, beside their sources or in the
    folder that ``NUMBA_CACHE_DIR`` names.
    """
    here = Path(__file__).parent
    source = (here / f"{_LAST}.py").stat().st_mtime
    folders = [here / "__pycache__"]
    given = os.environ.get("NUMBA_CACHE_DIR")
    if given:
        folders = [folder for folder in Path(given).glob(f"{here.name}_*") if folder.is_dir()]
    left = (entry for folder in folders for entry in folder.glob(f"{_LAST}.by_rows-*.nbi"))
    return any(entry.stat().st_mtime >= source for entry in left)
