"""Whether compiled code exists already; found without loading it, or Numba."""

from __future__ import annotations

import hashlib
import logging
import os
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from linkwork.foundation.cache_folder import user_cache

__all__ = [
    "LOOPS",
    "PATH_LOOP",
    "SINGLE_LOOP",
    "is_compiled",
    "is_loaded",
    "loop_serves",
    "say_that_it_compiles",
    "sources_digest",
]

#: The loops over lanes, by module, with the function that takes long to compile.
LOOPS = {"independent": "march", "lockstep": "in_step", "rowwise": "by_rows"}
#: The loop over solution paths of a homotopy.
PATH_LOOP = "lane_paths"
#: Newton-Raphson of one row.
SINGLE_LOOP = "compiled_rows"
_FUNCTIONS = LOOPS | {PATH_LOOP: "follow_paths", SINGLE_LOOP: "solve_row"}
_FOLDERS = {PATH_LOOP: "paths", SINGLE_LOOP: "single"}
_COMPILED = (
    "kernels/gpu", "kernels/march", "kernels/paths", "kernels/program", "kernels/single",
    "marching",
)  # fmt: skip
_PAYS = 10_000_000  # positions: as long as they take another loop does it take to compile one


def is_loaded(loop: str) -> bool:
    """Whether this process has a loop in use."""
    return f"linkwork.kernels.{_package(loop)}.{loop}" in sys.modules


def is_compiled(loop: str) -> bool:
    """Whether an earlier process has left a loop compiled: next to its source, in the user's cache
    where that cannot be written to, or in the folder named by ``NUMBA_CACHE_DIR``.
    """
    digest = sources_digest()
    return any(digest in index.read_bytes() for index in _indices(loop))


@cache
def sources_digest() -> bytes:
    """A digest of all sources that are compiled; code compiled from others is out of date."""
    package = Path(__file__).parents[2]
    digest = hashlib.sha256()
    for folder in _COMPILED:
        for path in sorted(package.joinpath(folder).glob("*.py")):
            digest.update(path.read_bytes())
    return digest.digest()


def loop_serves(loop: str, positions: int) -> bool:
    """Whether a loop that others can replace saves time for this many positions."""
    return is_loaded(loop) or positions >= _PAYS or _was_compiled(loop)


@cache
def _was_compiled(loop: str) -> bool:
    """Whether a loop was compiled when it was first asked for: a look takes as long as a table."""
    return is_compiled(loop)


def _indices(loop: str) -> Iterator[Path]:
    """Numba's index files of a loop."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    shared = Path(given) if given else user_cache("numba", False)
    package = _package(loop)
    folders = list(shared.glob(f"{package}_*"))
    if not given:
        folders.append(Path(__file__).parents[1] / package / "__pycache__")
    for folder in folders:
        yield from folder.glob(f"{loop}.{_FUNCTIONS[loop]}-*.nbi")


def _package(loop: str) -> str:
    """The package of kernels that a loop belongs to."""
    return _FOLDERS.get(loop, "march")


def say_that_it_compiles(loop: str = "") -> None:
    """Warn once in the log ``linkwork`` that compiling takes time, if it will.

    Without a loop: whether what all of them share was compiled, with any of them.
    """
    if not any(map(is_compiled, (loop,) if loop else _FUNCTIONS)):
        _warn_that_it_compiles()


@cache
def _warn_that_it_compiles() -> None:
    logging.getLogger("linkwork").warning(
        "compiling Linkwork's kernels, once after an installation: up to half a minute "
        '("linkwork compile" compiles all of them beforehand)'
    )
