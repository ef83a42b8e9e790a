"""The folder of what Linkwork computes once and keeps."""

from __future__ import annotations

import os
from pathlib import Path

from platformdirs import user_cache_path

__all__ = ["CACHE_VARIABLE", "cache_folder"]

#: The environment variable that names a folder in place of the user's cache.
CACHE_VARIABLE = "LINKWORK_CACHE"


def cache_folder(part: str) -> Path:
    """The folder of one part; it need not exist."""
    given = os.environ.get(CACHE_VARIABLE)
    return (Path(given) if given else user_cache_path("linkwork")) / part
