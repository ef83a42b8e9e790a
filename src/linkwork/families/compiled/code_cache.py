"""Code of families that is kept in the user's cache, and the device that a march runs on."""

from __future__ import annotations

import hashlib
import importlib.util
import logging
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from threading import RLock
from typing import Any

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import CACHE_VARIABLE, cache_folder, user_cache
from linkwork.core.record.recorder import ROLES

#: Devices that a march can run on.
DEVICES = ("cpu", "gpu")


# Compiling takes some 5 ms for each instruction, of which a position then costs 0.1 ns less.
_PAYS = 100_000_000  # positions


_PAYS_COMPILED = 1_000_000  # where an earlier run has left its compiled code


_LONGEST = 4_000  # instructions: the compiler's time grows faster than they do


@dataclass(frozen=True, kw_only=True)
class Execution:
    """Whether the trial of a topology is written out and compiled, or done by the interpreter.

    Parameters
    ----------
    specialised : bool, optional
        Asked for; by default it is whatever takes less time for this many ``positions``.
    positions : int
    device : str
        Where it runs, one of :data:`DEVICES`; a graphics card runs compiled programs only.

    Raises
    ------
    InputError
        For another device, or for a graphics card that should compile nothing.
    """

    specialised: bool | None = None
    positions: int = 0
    device: str = "cpu"

    def __post_init__(self) -> None:
        if self.device not in DEVICES:
            raise InputError(
                f'there is no device "{self.device}" (there are: {", ".join(DEVICES)})'
            )
        if self.device == "gpu" and self.specialised is False:
            raise InputError(
                "a graphics card runs compiled equations only: leave out "
                'specialised=False or device="gpu"'
            )

    def pays(self, instructions: int) -> bool:
        """Whether compiling programs of this many instructions in all turns saves time."""
        return self.positions >= _PAYS and instructions <= ROLES * _LONGEST

    def pays_compiled(self, instructions: int) -> bool:
        """Whether loading code that an earlier run has compiled saves time."""
        return self.positions >= _PAYS_COMPILED and instructions <= ROLES * _LONGEST


# ----------------------------------------------------------------------
# Whether compiled code exists already; found without loading it, or Numba.


#: The loop over solution paths of a homotopy.
PATH_LOOP = "paths.path_kernel"
#: Modules with loops over lanes, and the function of each that takes long to compile.
LOOPS = {"march.independent": "march", "march.lockstep": "in_step", PATH_LOOP: "follow_paths"}
_COMPILED = (
    "core/numerics/marching.py", "core/record/*.py", "families/compiled/*.py", "families/gpu/*.py",
    "families/march/*.py", "families/paths/*.py",
)  # fmt: skip


def has_compiler() -> bool:
    """Whether Numba is installed: the extra ``fast``."""
    with suppress(ModuleNotFoundError):
        return importlib.util.find_spec("numba") is not None
    return False


def is_loaded(loop: str) -> bool:
    """Whether this process has a loop in use."""
    return f"linkwork.families.{loop}" in sys.modules


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
    for pattern in _COMPILED:
        for path in sorted(package.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.digest()


def _indices(loop: str) -> Iterator[Path]:
    """Numba's index files of a loop."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    shared = Path(given) if given else user_cache("numba", False)
    package, module = loop.split(".")
    folders = list(shared.glob(f"{package}_*"))
    if not given:
        folders.append(Path(__file__).parents[1] / package / "__pycache__")
    for folder in folders:
        yield from folder.glob(f"{module}.{LOOPS[loop]}-*.nbi")


def say_that_it_compiles(loop: str = "") -> None:
    """Warn once in the log ``linkwork`` that compiling takes time, if it will.

    Without a loop: whether what all of them share was compiled, with any of them.
    """
    if not any(map(is_compiled, (loop,) if loop else LOOPS)):
        _warn_that_it_compiles()


@cache
def _warn_that_it_compiles() -> None:
    logging.getLogger("linkwork").warning(
        "compiling Linkwork's kernels, once after an installation: up to half a minute "
        '("linkwork compile" compiles all of them beforehand)'
    )


# ----------------------------------------------------------------------
# Programs written out as modules of their own, in a folder where compiled code is kept.


_ONE_AT_A_TIME = RLock()  # a module is among the known ones before it is whole


def load_compiled(source: str, function: str) -> Any:
    """A function of a module of which the source is given; compiled at most once.

    Raises
    ------
    InputError
        If nothing can be written to the folder of the cache.
    """
    name = _name(source)
    with _ONE_AT_A_TIME:
        known = sys.modules.get(name)
        if known is None:
            path = _path(name)
            if not path.exists() or path.read_text(encoding="utf-8") != source:
                _write(path, source)
            known = _load_module(name, path)
    return getattr(known, function)


def is_cached(source: str) -> bool:
    """Whether the module is there already, so that it costs next to nothing."""
    return _name(source) in sys.modules or _path(_name(source)).exists()


def _path(name: str) -> Path:
    return cache_folder("kernels") / f"{name}.py"


def _name(source: str) -> str:
    """The name of a module: a digest of its text and of all sources it is compiled with."""
    digest = hashlib.sha256(source.encode() + sources_digest())
    return f"linkwork_kernel_{digest.hexdigest()[:24]}"


def _write(path: Path, source: str) -> None:
    """Write the file whole or not at all, also while other processes write it."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(
            "w", dir=path.parent, suffix=".part", delete=False, encoding="utf-8"
        ) as part:
            part.write(source)
        os.replace(part.name, path)
    except OSError as error:
        raise InputError(
            f"compiled code cannot be stored in {path.parent} ({error.strerror}): "
            f"name another folder in {CACHE_VARIABLE}, or use specialised=False"
        ) from None


def _load_module(name: str, path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module
