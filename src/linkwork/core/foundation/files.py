"""Writing files and folders whole or not at all, and the folder of caches."""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import signal
import threading
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np

from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.values import as_told

# ----------------------------------------------------------------------
# Paths that a caller gives.


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


# ----------------------------------------------------------------------
# Files that are written as a whole: an interruption or a full disk leaves what was there.


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
            _written_file_replace(target, pieces)
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


def _written_file_replace(target: Path, pieces: Iterable[bytes]) -> None:
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


# ----------------------------------------------------------------------
# The folder of what Linkwork computes once and keeps.


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


# ----------------------------------------------------------------------
# Folders that are written as a whole: an interruption or a full disk leaves what was there.


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
            _written_folder_replace(whole, part, last, stale)
    except OSError as error:
        place = Path(str(error.filename2 or error.filename or part))
        base = next(filter(place.is_relative_to, (part, whole)), place)
        raise unwritten(out / place.relative_to(base), error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _part_name() -> str:
    return f".linkwork-{secrets.token_hex(6)}.part"


def _written_folder_replace(whole: Path, part: Path, last: str, stale: Collection[str]) -> None:
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


# ----------------------------------------------------------------------
# Folders that a command fills again: it replaces the files of its kind and keeps all others.


@dataclass(frozen=True, kw_only=True)
class OwnFiles:
    """The files that a run writes into a folder, by their places in it.

    ``run``: what it is called; ``option``: how its user asks for a replacement; ``files``: their
    places; ``folders``: where they lie; ``read``: files that the run reads.
    """

    run: str
    files: re.Pattern[str]
    option: str = "--force"
    folders: Collection[str] = (".",)
    read: Collection[Path] = ()

    def check(self, root: Path, force: bool) -> Collection[str]:
        """The files of an earlier run, which this one will replace; called before the work.

        Raises
        ------
        InputError
            If the folder cannot be written, if it holds a file and nothing is to be replaced, or if
            the run reads a file that it would replace.
        """
        check_place(root)
        if not root.exists():
            return ()
        try:
            there = sorted(name for name in os.listdir(root) if not PART.fullmatch(name))
            earlier = tuple(self._earlier(root))
        except OSError as error:
            raise unwritten(root, error) from None
        if there and not force:
            raise InputError(
                f'the folder "{root}" is not empty: it holds "{there[0]}"; name a new folder, or '
                f"add {self.option}, which replaces the files of an earlier {self.run} and keeps "
                "all others"
            )
        for name in earlier:
            # a folder may be a link
            if (root / name).resolve() in self.read:
                raise InputError(
                    f'the folder "{root}" holds "{name}", which this {self.run} reads and would '
                    "replace: name a new folder"
                )
        return earlier

    def _earlier(self, root: Path) -> Iterator[str]:
        for folder in self.folders:
            place = root / folder
            for name in sorted(os.listdir(place)) if place.is_dir() else ():
                found = (Path(folder) / name).as_posix()
                if self.files.fullmatch(found) and not (place / name).is_dir():
                    yield found

    @contextmanager
    def written(self, root: Path, earlier: Collection[str]) -> Iterator[Path]:
        """A temporary folder whose files replace those of an earlier run.

        Raises
        ------
        InputError
            If a file cannot be written.
        """
        with written_folder(root, stale=earlier) as part:
            yield part
