"""Files that are written as a whole: an interruption or a full disk leaves what was there."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterable
from pathlib import Path

from linkwork.foundation.paths import as_path, unwritten

__all__ = ["save_bytes", "save_pieces", "save_text"]


def save_pieces(pieces: Iterable[bytes], path: Path | str) -> None:
    """Write a file, completely or not at all; links are followed, devices and pipes written to.

    Raises
    ------
    InputError
        If the file cannot be written; an existing file is then unchanged.
    """
    target = as_path(path)
    try:
        target = target.resolve()
        if target.is_file() or not target.exists():
            _replace(target, pieces)
        else:
            with target.open("wb") as device:
                device.writelines(pieces)
    except (OSError, ValueError, RuntimeError) as error:
        raise unwritten(path, error) from None


def save_bytes(data: bytes, path: Path | str) -> None:
    """Write a file, completely or not at all; raises like :func:`save_pieces`."""
    save_pieces([data], path)


def save_text(text: str, path: Path | str) -> None:
    """Write a text as UTF-8, completely or not at all; raises like :func:`save_pieces`."""
    save_bytes(text.encode("utf-8"), path)


def _replace(target: Path, pieces: Iterable[bytes]) -> None:
    """Write a temporary file and rename it: readers see the old file or the new one."""
    # names have 255 bytes at most
    stem = target.name.encode()[:100].decode(errors="ignore")
    beside = target.with_name(f".{stem}.{secrets.token_hex(6)}")
    try:
        with beside.open("xb") as file:
            file.writelines(pieces)
            file.flush()
            # the data must be on disk before the file is renamed
            os.fsync(file.fileno())
        if target.exists():
            # keep the permissions of the old file
            beside.chmod(target.stat().st_mode & 0o777)
        os.replace(beside, target)
    except BaseException:  # remove the temporary file, also after Ctrl-C
        beside.unlink(missing_ok=True)
        raise
