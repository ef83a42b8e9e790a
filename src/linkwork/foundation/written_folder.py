"""Folders that are written as a whole: an interruption or a full disk leaves what was there."""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from linkwork.foundation.paths import unwritten

__all__ = ["check_place", "written_folder"]


def check_place(out: Path) -> None:
    """Refuse a folder that cannot be made, before the work whose results it is for.

    Raises
    ------
    InputError
    """
    whole = out.absolute()
    there = next(place for place in (whole, *whole.parents) if place.exists())
    code = 0 if os.access(there, os.W_OK | os.X_OK) else errno.EACCES
    code = code if there.is_dir() else errno.ENOTDIR
    if code:
        raise unwritten(out, OSError(code, os.strerror(code)))


@contextmanager
def written_folder(out: Path, last: str = "") -> Iterator[Path]:
    """A temporary folder next to ``out``, whose files come into ``out`` when all are written.

    A folder that does not exist appears in one step. In one that does, files are replaced one by
    one, the file ``last`` after all others.

    Raises
    ------
    InputError
        If a file cannot be written.
    """
    whole = out.absolute()
    part = whole.with_name(f".{whole.name}.{os.getpid()}.part")
    try:
        part.mkdir(parents=True)
        yield part
        if not whole.exists():
            part.rename(whole)
            return
        files = [path.relative_to(part) for path in sorted(part.rglob("*")) if path.is_file()]
        for name in sorted(files, key=lambda name: name == Path(last)):
            (whole / name).parent.mkdir(parents=True, exist_ok=True)
            os.replace(part / name, whole / name)
    except OSError as error:
        raise unwritten(out, error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
