"""The folder of what Linkwork computes once and keeps."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

__all__ = ["CACHE_VARIABLE", "cache_folder", "user_cache"]

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
