"""The folder of what Linkwork computes once and keeps."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import Literal

import numpy as np

from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.written_file import save_bytes

__all__ = ["CACHE_VARIABLE", "cache_folder", "keep_arrays", "user_cache"]

#: The environment variable that names a folder in place of the user's cache.
CACHE_VARIABLE = "LINKWORK_CACHE"


def cache_folder(part: str) -> Path:
    """The folder of one part; it need not exist."""
    given = os.environ.get(CACHE_VARIABLE)
    return (Path(given) if given else user_cache("linkwork")) / part


def user_cache(program: str, author: str | Literal[False] | None = None) -> Path:
    """The user's cache of a program."""
    from platformdirs import user_cache_path  # a page in a browser starts without it

    return user_cache_path(program, author)


def keep_arrays(path: Path, arrays: Mapping[str, AnyArray]) -> None:
    """Write a file (.npz), whole or not at all; nothing where that is not possible."""
    held = BytesIO()
    np.savez(held, **arrays)  # type: ignore[arg-type]  # arrays alone
    with suppress(OSError, InputError):
        path.parent.mkdir(parents=True, exist_ok=True)
        save_bytes(held.getvalue(), path)
