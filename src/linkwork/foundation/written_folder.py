"""Folders that are written as a whole: an interruption or a full disk leaves what was there."""

from __future__ import annotations

import os
import re
import secrets
import shutil
import signal
import threading
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from linkwork.foundation.errors import InputError
from linkwork.foundation.paths import unwritten

__all__ = ["PART", "check_place", "written_folder"]

#: The names of temporary folders.
PART = re.compile(r"\.linkwork-[0-9a-f]{12}\.part")


def check_place(out: Path) -> None:
    """Refuse a folder that cannot be made, before the work whose results it is for.

    Raises
    ------
    InputError
    """
    whole = out.absolute()
    there = next(filter(os.path.lexists, (whole, *whole.parents)), whole)
    if not os.path.isdir(there):
        what = "a link that leads to no folder" if there.is_symlink() else "not a folder"
        raise InputError(f'cannot write "{out}": "{there}" is {what}; name another folder')
    trial = there / _part_name()
    try:
        (trial / whole.relative_to(there)).mkdir(parents=True)
    except (OSError, ValueError) as error:
        raise unwritten(out, error) from None
    finally:
        shutil.rmtree(trial, ignore_errors=True)


@contextmanager
def written_folder(out: Path, last: str = "", stale: Collection[str] = ()) -> Iterator[Path]:
    """A temporary folder whose files come into ``out`` when all are written.

    A folder that does not exist appears in one step. In one that does, files are replaced one by
    one, the file ``last`` after all others; then files that are ``stale`` by then and not replaced
    are removed, and their folders if nothing else is there. An interruption waits for the end of
    that.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    whole = out.absolute()
    # inside a folder that exists: what lies beside it may be another disk, or read-only
    part = (whole if whole.exists() else whole.parent) / _part_name()
    try:
        part.mkdir(parents=True)
        yield part
        if not whole.exists():
            part.rename(whole)
            return
        with _uninterrupted(f"after all files were written in {out}"):
            _replace(whole, part, last, stale)
    except OSError as error:
        place = Path(str(error.filename2 or error.filename or part))
        base = next(filter(place.is_relative_to, (part, whole)), place)
        raise unwritten(out / place.relative_to(base), error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _part_name() -> str:
    return f".linkwork-{secrets.token_hex(6)}.part"


def _replace(whole: Path, part: Path, last: str, stale: Collection[str]) -> None:
    files = [path.relative_to(part) for path in sorted(part.rglob("*")) if path.is_file()]
    for name in sorted(files, key=lambda name: name == Path(last)):
        (whole / name).parent.mkdir(parents=True, exist_ok=True)
        os.replace(part / name, whole / name)
    for name in {Path(name) for name in stale}.difference(files):
        with suppress(OSError):
            (whole / name).unlink(missing_ok=True)
            os.removedirs((whole / name).parent)  # as far as ``whole``, which has ``part``


@contextmanager
def _uninterrupted(told: str) -> Iterator[None]:
    """Let an interruption (Ctrl-C) wait for the end of a block; ``told``: what it then says."""
    before, came = signal.getsignal(signal.SIGINT), list[int]()
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield  # nothing is interrupted here
        return
    signal.signal(signal.SIGINT, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    try:
        for number in came[:1]:
            signal.raise_signal(number)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(told) from None
