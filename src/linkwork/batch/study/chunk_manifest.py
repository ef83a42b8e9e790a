"""The manifest of a store: finished chunks, with the checksums of their files.

A chunk is finished when its entry exists; the entry is written after the files. After a killed run,
unfinished chunks are computed again, and so are chunks with files that have changed since. Every
file of the manifest has a checksum of its own.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from linkwork.batch.study.zarr_files import LEDGER
from linkwork.foundation.errors import InputError

__all__ = [
    "PARTIAL",
    "Entry",
    "Metadata",
    "changed_files",
    "chunks_with_entry",
    "read_entries",
    "write_entry",
    "write_whole",
]

#: Suffix of incomplete files.
PARTIAL = ".part"
_SUFFIX = ".json"
_STORE = f"store{_SUFFIX}"
_SEAL = "checksum"

#: [size, CRC-32] of files, by their path in the store.
Sums = Mapping[str, list[int]]


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A finished chunk.

    Parameters
    ----------
    chunk, start, stop : int
        Its number, and its designs from ``start`` to ``stop`` (excluded).
    files : Mapping[str, [size, CRC-32]]
        By path in the store.
    rows : Mapping[str, int]
        Number of rows by status.
    problems : Mapping[str, int]
        Number of designs that could not be built, by reason.
    """

    chunk: int
    start: int
    stop: int
    files: Sums
    rows: Mapping[str, int]
    problems: Mapping[str, int]

    @classmethod
    def of_files(
        cls,
        chunk: int,
        designs: range,
        files: Mapping[str, bytes],
        rows: Mapping[str, int],
        problems: Mapping[str, int],
    ) -> Entry:
        """The entry of a chunk with files of this content."""
        return cls(
            chunk=chunk,
            start=designs.start,
            stop=designs.stop,
            files=_sums(files),
            rows=rows,
            problems=problems,
        )


@dataclass(frozen=True, kw_only=True)
class Metadata:
    """The files that describe a store and its arrays, and the identity of its study."""

    files: Sums
    identity: Mapping[str, Any]

    @classmethod
    def of_files(cls, files: Mapping[str, bytes], identity: Mapping[str, Any]) -> Metadata:
        """Of files with this content."""
        return cls(files=_sums(files), identity=identity)

    @classmethod
    def read(cls, store: Path) -> Metadata | None:
        """From a store; ``None`` if it is missing or damaged."""
        found = _unsealed(store / LEDGER / _STORE)
        return None if found is None else cls(**found)

    def sealed(self) -> tuple[str, bytes]:
        """Path in the store and content of the file that holds this."""
        return f"{LEDGER}/{_STORE}", _sealed(asdict(self))


def changed_files(store: Path, known: Sums) -> tuple[str, ...]:
    """The files that are missing or do not match their checksums."""
    return tuple(path for path, sums in known.items() if _sum(store / path) != sums)


def write_whole(path: Path, data: bytes) -> None:
    """Write a file completely or not at all.

    Raises
    ------
    InputError
        If it cannot be written, as on a full disk.
    """
    part = path.with_name(path.name + PARTIAL)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(data)
        # renaming is atomic: readers never see incomplete files
        os.replace(part, path)
    except OSError as error:
        with suppress(OSError):  # it would take up the last of the disk
            part.unlink()
        raise InputError(
            f'cannot write "{path}": {error.strerror or error}. The chunks that are stored are '
            "complete: make room and repeat the command"
        ) from None


def write_entry(store: Path, entry: Entry) -> None:
    """Record that a chunk is finished."""
    write_whole(store / LEDGER / f"{entry.chunk:08}{_SUFFIX}", _sealed(asdict(entry)))


def read_entries(store: Path) -> tuple[dict[int, Entry], dict[int, tuple[str, ...]]]:
    """The entries of chunks that are as they were written; the changed files of the others."""
    sound: dict[int, Entry] = {}
    damaged: dict[int, tuple[str, ...]] = {}
    for chunk, path in _entry_files(store):
        found = _unsealed(path)
        if found is None:
            damaged[chunk] = (f"{LEDGER}/{path.name}",)
            continue
        entry = Entry(**found)
        if changed := changed_files(store, entry.files):
            damaged[chunk] = changed
        else:
            sound[chunk] = entry
    return sound, damaged


def chunks_with_entry(store: Path) -> set[int]:
    """The chunks that are recorded as finished; their files are not read."""
    return {chunk for chunk, _ in _entry_files(store)}


def _entry_files(store: Path) -> Iterator[tuple[int, Path]]:
    for path in sorted((store / LEDGER).glob(f"[0-9]*{_SUFFIX}")):
        if path.stem.isdecimal():
            yield int(path.stem), path


def _sealed(values: Mapping[str, Any]) -> bytes:
    """JSON text with its own checksum; sorted, so that two runs write identical stores."""
    text = json.dumps(values, ensure_ascii=False, sort_keys=True)
    return json.dumps(
        {**values, _SEAL: zlib.crc32(text.encode())}, ensure_ascii=False, sort_keys=True
    ).encode()


def _unsealed(path: Path) -> dict[str, Any] | None:
    """The values of a sealed file; ``None`` if it is missing, truncated or changed."""
    try:
        data = path.read_bytes()
        values = json.loads(data)
        del values[_SEAL]
        return values if _sealed(values) == data else None
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _sums(files: Mapping[str, bytes]) -> dict[str, list[int]]:
    return {path: [len(data), zlib.crc32(data)] for path, data in sorted(files.items())}


def _sum(path: Path) -> list[int] | None:
    """Size and checksum of a file; ``None`` if it cannot be read."""
    size = total = 0
    try:
        with path.open("rb") as file:
            # in pieces: a file may be larger than memory
            while piece := file.read(1 << 20):
                size += len(piece)
                total = zlib.crc32(piece, total)
    except OSError:
        return None
    return [size, total]
