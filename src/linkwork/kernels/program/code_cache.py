"""Programs written out as modules of their own, in a folder where compiled code is kept."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
import tempfile
from pathlib import Path
from threading import RLock
from typing import Any

from linkwork.foundation.cache_folder import CACHE_VARIABLE, cache_folder
from linkwork.foundation.errors import InputError
from linkwork.kernels.program.kernel_cache import sources_digest

__all__ = ["is_cached", "load_compiled"]

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
    return _folder() / f"{name.rpartition('.')[2]}.py"


def _folder() -> Path:
    return cache_folder("kernels")


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
