"""The manifest of a store: finished chunks, with the checksums of their files.

A chunk is finished when its entry is there, and the entry is written after its files. So a run
that is killed leaves chunks that are finished, and others that are computed again.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from linkwork.batch.study.zarr_files import LEDGER

__all__ = ["PARTIAL", "Entry", "read_entries", "write_entry", "write_whole"]

#: What files are called until they are whole.
PARTIAL = ".part"
_SUFFIX = ".json"


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A finished chunk.

    Parameters
    ----------
    chunk, start, stop : int
        Which it is, and its designs from ``start`` up to ``stop``.
    files : Mapping[str, [size, CRC-32]]
        By path in the store.
    rows : Mapping[str, int]
        How many rows ended in which status.
    problems : Mapping[str, int]
        Why so many designs could not be built.
    """

    chunk: int
    start: int
    stop: int
    files: Mapping[str, list[int]]
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
        """The entry of a chunk whose files have this content."""
        sums = {path: [len(data), zlib.crc32(data)] for path, data in sorted(files.items())}
        return cls(
            chunk=chunk,
            start=designs.start,
            stop=designs.stop,
            files=sums,
            rows=rows,
            problems=problems,
        )

    def holds(self, store: Path) -> bool:
        """Whether all files are there as they were written."""
        return all(_sum(store / path) == known for path, known in self.files.items())


def write_whole(path: Path, data: bytes) -> None:
    """Write a file that appears whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + PARTIAL)
    part.write_bytes(data)
    # renaming is atomic: a reader never sees half a file
    os.replace(part, path)


def write_entry(store: Path, entry: Entry) -> None:
    """Note that a chunk is finished."""
    # sorted, so that two runs of a study write equal stores
    text = json.dumps(asdict(entry), ensure_ascii=False, sort_keys=True)
    write_whole(store / LEDGER / f"{entry.chunk:08}{_SUFFIX}", text.encode())


def read_entries(store: Path) -> dict[int, Entry]:
    """All entries by chunk; one that cannot be read is as none."""
    found = {}
    for path in sorted((store / LEDGER).glob(f"[0-9]*{_SUFFIX}")):
        try:
            entry = Entry(**json.loads(path.read_text(encoding="utf-8")))
        except (ValueError, TypeError):  # cut short by a machine that lost its power
            continue
        found[entry.chunk] = entry
    return found


def _sum(path: Path) -> list[int] | None:
    """Size and checksum of a file; ``None`` if it is not there."""
    size = total = 0
    try:
        with path.open("rb") as file:
            # piece by piece: a file may be larger than memory
            while piece := file.read(1 << 20):
                size += len(piece)
                total = zlib.crc32(piece, total)
    except FileNotFoundError:
        return None
    return [size, total]
