"""Paths that a caller gives."""

from __future__ import annotations

import errno
from collections.abc import Iterable
from os import PathLike
from pathlib import Path

from linkwork.foundation.errors import InputError
from linkwork.foundation.plain_numbers import as_told

__all__ = ["as_path", "suffix_of", "unwritten"]


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


def suffix_of(file: Path, what: str, formats: Iterable[str]) -> str:
    """The suffix of a file to be written, in small letters.

    Raises
    ------
    InputError
        If it is none of the formats.
    """
    suffix = file.suffix.lower()
    known = tuple(formats)
    if suffix not in known:
        raise InputError(
            f'cannot write "{file}": the suffix of {what} is one of {", ".join(known)}'
        )
    return suffix


def unwritten(path: Path | str, error: Exception) -> InputError:
    """The error for a file or folder that could not be written: its name, the reason, a remedy."""
    reason = getattr(error, "strerror", None) or error
    full = getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT)
    remedy = ": make room there, or write to another place" if full else ""
    return InputError(f'cannot write "{path}": {reason}{remedy}')
