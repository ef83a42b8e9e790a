"""The store of a study on disk: create, resume, or reject the store of another study."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path
from typing import Any

from linkwork.batch.study.chunk_manifest import (
    PARTIAL,
    Entry,
    read_entries,
    write_entry,
    write_whole,
)
from linkwork.batch.study.job import Part
from linkwork.batch.study.study import DESIGN, Study
from linkwork.batch.study.zarr_files import LEDGER, METADATA, ZarrFiles
from linkwork.foundation.errors import InputError, key_text

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

__all__ = ["Store", "attributes_of", "open_store"]

_IDENTITY = "linkwork_identity"
_LOCK = "lock"
_LONGEST_SHOWN = 60  # characters of a value that differs


class Store:
    """The store of one study, open for writing; see :func:`open_store`.

    Parameters
    ----------
    path : Path
    study : Study
    files : ZarrFiles
        Makes the files of the store.
    """

    def __init__(self, path: Path, study: Study, files: ZarrFiles) -> None:
        self.path, self.study = path, study
        self._files = files
        entries = read_entries(path)
        #: Chunks that are finished, whose files are as they were written.
        self.done = {k for k, entry in entries.items() if entry.holds(path)}

    def write(self, k: int, part: Part) -> None:
        """Store a chunk: first its files, then its entry in the ledger."""
        designs = self.study.designs_of(k)
        varied = self.study.varied(k)
        files = self._files.encoded(designs, {**varied, **part.arrays})
        for path, data in files.items():
            write_whole(self.path / path, data)
        write_entry(
            # after the files: an entry without its files would be trusted by the next run
            self.path,
            Entry.of_files(k, designs, files, rows=part.rows, problems=part.problems),
        )
        self.done.add(k)


@contextmanager
def open_store(study: Study, path: Path, *, fresh: bool = False) -> Iterator[Store]:
    """The store of a study: made, or gone on with if it holds chunks of the same study.

    Parameters
    ----------
    fresh : bool
        Take away the store of any study that is there.

    Raises
    ------
    InputError
        If another study or something else is there, or another run is writing to it.
    """
    files = _files_of(study)
    if fresh and path.exists():
        attributes_of(path)  # nothing but a study's store is ever taken away
        _take_away(path)
    if not path.exists():
        _make(path, files.first)
    attributes_of(path)  # what is no store has no lock either
    with _lock_store(path):
        _check_same(study, path)
        yield Store(path, study, files)


def attributes_of(path: Path) -> Mapping[str, Any]:
    """What a store says of its study.

    Raises
    ------
    InputError
        If it is no store of a study.
    """
    if not path.exists():
        raise InputError(f'there is no "{path}"')
    try:
        found = json.loads((path / METADATA).read_text(encoding="utf-8"))["attributes"]
        found[_IDENTITY] = json.loads(found[_IDENTITY])
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(
            f'"{path}" exists and is not the store of a study: choose another name'
        ) from None
    attributes: Mapping[str, Any] = found
    return attributes


def _files_of(study: Study) -> ZarrFiles:
    lead = study.inputs[0]
    others = [name for name in study.inputs[1:] if " " not in name]
    attributes = {
        "title": study.name,
        "mechanism_name": study.job.description.name,
        "linkwork_version": study.job.version,
        "seed": study.identity["seed"],
        "plan": study.text,
        "mechanism": study.mechanism_text,
        _IDENTITY: json.dumps(study.identity, ensure_ascii=False),
        **({"coordinates": " ".join(others)} if others else {}),
    }
    sizes = {DESIGN: study.plan.count, lead: len(study.model.rows_in_file_units)}
    return ZarrFiles(study.variables, sizes, study.chunk_size, attributes)


def _make(path: Path, files: Mapping[str, bytes]) -> None:
    """The store without any chunk, in one step."""
    if not path.parent.is_dir():
        raise InputError(f'cannot write "{path}": there is no folder "{path.parent}"')
    # on the same file system, so that renaming it is one step
    part = path.with_name(f".{path.name}.{os.getpid()}{PARTIAL}")
    shutil.rmtree(part, ignore_errors=True)
    for name, data in files.items():
        (part / name).parent.mkdir(parents=True, exist_ok=True)
        (part / name).write_bytes(data)
    (part / LEDGER / _LOCK).touch()
    os.rename(part, path)


def _take_away(path: Path) -> None:
    """The store is there or not: a part of it that is left would be gone on with."""
    aside = path.with_name(f".{path.name}.{os.getpid()}.old{PARTIAL}")
    with _lock_store(path):
        # renamed before it is deleted: an interruption leaves no half store under its name
        os.rename(path, aside)
    shutil.rmtree(aside)


def _check_same(study: Study, path: Path) -> None:
    """Refuse a store of another study."""
    there = attributes_of(path)[_IDENTITY]
    # as JSON reads it again: tuples are lists there
    here = json.loads(json.dumps(study.identity))
    if told := "\n".join(_differences(there, here)):
        raise InputError(
            f'"{path}" holds another study:\n{told}\n'
            "Choose another store, or start over with --fresh, "
            "which deletes the old study."
        )


def _differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """What differs between two studies, a line for each."""
    for key in {**there, **here}:
        old: Any = there.get(key)
        new: Any = here.get(key)
        if old == new:
            continue
        if key == "mechanism":
            old, new = _first_change(old, new)
        # other names: the values are of no interest then
        elif key == "dimensions" and [n for n, _ in old] != [n for n, _ in new]:
            old, new = ([name for name, _ in each] for each in (old, new))
        elif key in ("dimensions", "input", "reductions", "filters"):
            for name, was, now in _changed_entries(dict(old), dict(new)):
                yield f"  {key_text((key, name))}: {_shown(was)} there, {_shown(now)} here"
            continue
        yield f"  {key}: {_shown(old)} there, {_shown(new)} here"


def _changed_entries(
    old: Mapping[str, Any], new: Mapping[str, Any]
) -> Iterator[tuple[str, Any, Any]]:
    for name in {**old, **new}:
        if old.get(name) != new.get(name):
            yield name, old.get(name), new.get(name)


def _first_change(old: str, new: str) -> tuple[str, str]:
    """The first lines of two texts that are not the same."""
    pairs = zip_longest(old.split("\n"), new.split("\n"), fillvalue="")
    was, now = next(pair for pair in pairs if pair[0] != pair[1])
    return was.strip(), now.strip()


def _shown(value: Any) -> str:
    if value is None or value == "":
        return "nothing"
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _LONGEST_SHOWN else text[:_LONGEST_SHOWN] + "…"


@contextmanager
def _lock_store(path: Path) -> Iterator[None]:
    """Nobody else writes meanwhile; the lock of a process that was killed is gone with it."""
    lock = path / LEDGER / _LOCK
    with lock.open("ab") as file:
        try:
            if sys.platform == "win32":
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            else:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # of a store that was taken away between opening and locking: as if it were locked
            if not os.path.samestat(os.fstat(file.fileno()), lock.stat()):
                raise FileNotFoundError(lock)
        except OSError:
            raise InputError(
                f'another run is writing to "{path}": wait for it, or end it'
            ) from None
        yield
