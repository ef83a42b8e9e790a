"""The files of Pyodide and of its packages: found or downloaded, and compared with known hashes."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

from linkwork.foundation.errors import InputError

__all__ = ["PACKAGES", "PyodideFiles", "pyodide_files"]

#: The packages among the files.
PACKAGES = ("numpy", "tomlkit", "platformdirs")
_OWN_LOCK = "lock.json"  # in a folder: hashes of files that are not the official ones
_PATIENCE = 60.0  # without an answer [s]
_LARGEST = 50_000_000  # bytes of one file

#: Receives the fraction done.
Progress = Callable[[float], None]


@dataclass(frozen=True)
class LockedFile:
    """A file, where it is found, and the hash of its content."""

    file: str
    url: str
    sha256: str


@dataclass(frozen=True, kw_only=True)
class PyodideFiles:
    """Contents by name, and the names of those that are not the official files."""

    contents: Mapping[str, bytes]
    unofficial: tuple[str, ...]


def pyodide_files(folder: Path | None = None, progress: Progress | None = None) -> PyodideFiles:
    """All files, compared with their hashes.

    Parameters
    ----------
    folder : Path, optional
        A folder that contains the files; without it they are downloaded. A file ``lock.json`` there
        (``{"numpy": {"file": …, "sha256": …}}``) replaces files by others, for tests.
    progress : callable, optional

    Raises
    ------
    InputError
        If a file is missing, cannot be downloaded, or has another hash.
    """
    official = _official()
    locked = official if folder is None else {**official, **_own_lock(folder)}
    contents = {}
    for k, (name, file) in enumerate(locked.items()):
        content = _downloaded(file) if folder is None else _found(folder, file)
        _check_hash(file, content)
        contents[name] = content
        if progress is not None:
            progress((k + 1) / len(locked))
    unofficial = tuple(name for name in locked if locked[name].sha256 != official[name].sha256)
    return PyodideFiles(contents=contents, unofficial=unofficial)


@cache
def _official() -> Mapping[str, LockedFile]:
    text = (resources.files("linkwork.viewer.web") / "official.json").read_text("utf-8")
    return {name: LockedFile(**entry) for name, entry in json.loads(text).items()}


def _own_lock(folder: Path) -> dict[str, LockedFile]:
    """Files named by the lock file of a folder, if it has one."""
    path = folder / _OWN_LOCK
    if not path.exists():
        return {}
    try:
        entries = json.loads(path.read_text("utf-8"))
        own = {
            name: LockedFile(file=str(entry["file"]), url="", sha256=str(entry["sha256"]))
            for name, entry in entries.items()
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f'"{path}" is not a lock file ({type(error).__name__}: {error}): write '
            '{"numpy": {"file": "…", "sha256": "…"}}, or remove it to use the official files'
        ) from None
    for name in own:
        if name not in _official():
            raise InputError(f'"{path}": "{name}" is none of {", ".join(_official())}')
    return own


def _found(folder: Path, file: LockedFile) -> bytes:
    try:
        return (folder / file.file).read_bytes()
    except OSError as error:
        raise InputError(
            f'cannot read "{folder / file.file}": {error.strerror or error}; '
            f"get it{_source(file) or ', or mend the lock file'}"
        ) from None


def _downloaded(file: LockedFile) -> bytes:
    try:
        with urlopen(file.url, timeout=_PATIENCE) as answer:
            content: bytes = answer.read(_LARGEST)
    except (URLError, OSError) as error:
        reason = getattr(error, "reason", None) or error
        raise InputError(
            f"cannot download {file.url}: {reason}; without a network, put this file and the "
            "others into a folder and name it: --pyodide FOLDER"
        ) from None
    return content


def _check_hash(file: LockedFile, content: bytes) -> None:
    found = hashlib.sha256(content).hexdigest()
    if found != file.sha256:
        raise InputError(
            f'"{file.file}" is not the expected file: its SHA-256 is {found}, and {file.sha256} '
            f"was expected; get it again{_source(file)}"
        )


def _source(file: LockedFile) -> str:
    return f" from {file.url}" if file.url else ""
