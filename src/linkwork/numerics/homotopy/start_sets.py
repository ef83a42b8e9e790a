"""Solved random members of families of systems, kept on disk: shipped ones, and the user's own.

A random member takes up to a minute to be solved and depends on the structure only. The solutions
that are read are polished again, so that no file is trusted with a number.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import zipfile
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
from platformdirs import user_cache_path

from linkwork.foundation.arrays import AnyArray

__all__ = ["FOLDER", "SHIPPED", "key_of", "read_set", "write_set"]

#: A folder that takes the place of the user's cache.
FOLDER = "LINKWORK_CACHE"
#: The sets of the library and of common topologies; made by ``scripts/start_sets``.
SHIPPED = Path(__file__).with_name("start_sets.npz")
_VERSION = 1  # of the random members and of what is stored of them


def key_of(family: object) -> str:
    """The name of a family's set: a digest of all that the family consists of."""
    return hashlib.sha256(f"{_VERSION} {family!r}".encode()).hexdigest()[:24]


def read_set(key: str) -> dict[str, AnyArray] | None:
    """The arrays of a set by name; ``None`` if there is none that can be read."""
    for path, prefix in ((SHIPPED, f"{key}."), (_path(key), "")):
        # a file that cannot be read is no set: it is computed, and written again
        with suppress(OSError, ValueError, KeyError, zipfile.BadZipFile), np.load(path) as stored:
            names = [name for name in stored.files if name.startswith(prefix)]
            if names:
                return {name.removeprefix(prefix): stored[name] for name in names}
    return None


def write_set(key: str, arrays: Mapping[str, AnyArray]) -> None:
    """Keep a set in the user's cache, whole or not at all; nothing where that is not possible."""
    path = _path(key)
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".part", delete=False) as part:
            np.savez(part, **arrays)  # type: ignore[arg-type]
        os.replace(part.name, path)


def _path(key: str) -> Path:
    given = os.environ.get(FOLDER)
    folder = Path(given) if given else user_cache_path("linkwork")
    return folder / "start_sets" / f"{key}.npz"
