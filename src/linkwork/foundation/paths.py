"""Paths that a caller gives."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from linkwork.foundation.errors import InputError
from linkwork.foundation.plain_numbers import as_told

__all__ = ["as_path"]


def as_path(given: object) -> Path:
    """A path from a text or a path.

    Raises
    ------
    InputError
        For anything else.
    """
    if not isinstance(given, str | PathLike):
        raise InputError(f"a path must be a text or a Path, got {as_told(given)}")
    return Path(given)
