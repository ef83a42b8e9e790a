"""The store of a study on disk: create, resume, or reject the store of another study."""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Container, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path
from typing import Any

from linkwork.batch.study.chunk_manifest import (
    PARTIAL,
    Entry,
    Metadata,
    changed_files,
    read_entries,
    write_entry,
    write_whole,
)
from linkwork.batch.study.job import Part
from linkwork.batch.study.study import DESIGN, Study
from linkwork.batch.study.zarr_files import LEDGER, METADATA, ZarrFiles
from linkwork.foundation.errors import InputError, key_text
from linkwork.foundation.paths import unwritten
from linkwork.foundation.plain_numbers import as_told

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

__all__ = ["Store", "attributes_of", "check_is_store", "damaged_metadata", "open_store"]

_IDENTITY = "linkwork_identity"
_LOCK = "lock"
_LONGEST_SHOWN = 60  # maximum length of a value in a message


class Store:
    """The store of one study, open for writing; see :func:`open_store`.

    Parameters
    ----------
    path : Path
    study : Study
    files : ZarrFiles
        Creates the files of the store.
    repaired : tuple of str
        Metadata that was damaged and has been written again.
    """

    def __init__(
        self, path: Path, study: Study, files: ZarrFiles, repaired: tuple[str, ...]
    ) -> None:
        self.path, self.study, self.repaired = path, study, repaired
        self._files = files
        sound, damaged = read_entries(path)
        #: Finished chunks with files that match their checksums.
        self.done = set(sound)
        #: Chunks that were finished, and have changed since.
        self.damaged = tuple(sorted(damaged))

    def write(self, k: int, part: Part) -> None:
        """Store a chunk: first its files, then its ledger entry."""
        designs = self.study.designs_of(k)
        varied = self.study.varied(k)
        files = self._files.encoded(designs, {**varied, **part.arrays})
        for path, data in files.items():
            write_whole(self.path / path, data)
        write_entry(
            # after the files: the next run would accept an entry without files
            self.path,
            Entry.of_files(k, designs, files, rows=part.rows, problems=part.problems),
        )
        self.done.add(k)


@contextmanager
def open_store(study: Study, path: Path, *, force: bool = False) -> Iterator[Store]:
    """Create the store of a study, or resume it if it belongs to the same study.

    Parameters
    ----------
    force : bool
        Delete an existing store of any study.

    Raises
    ------
    InputError
        If the path contains another study or other files, or another run is writing to it.
    """
    files = _files_of(study)
    if force and _exists(path):
        check_is_store(path)  # delete nothing but the store of a study
        _take_away(path)
    if not _exists(path):
        _make(path, files.first, study)
    check_is_store(path)  # only stores have a lock
    with _lock_store(path):
        _check_same(study, path)
        yield Store(path, study, files, _repair(path, files.first, study))


def attributes_of(path: Path) -> Mapping[str, Any]:
    """The attributes of a store that describe its study.

    Raises
    ------
    InputError
        If it is not the store of a study, or its metadata is damaged.
    """
    check_is_store(path)
    if (attributes := _read_attributes(path)) is None or damaged_metadata(path):
        raise InputError(
            f'the metadata of "{path}" is damaged, or of an earlier version: repeat the command '
            "of its study, which repairs the store"
        )
    return attributes


def damaged_metadata(path: Path) -> tuple[str, ...]:
    """The files that describe a store and have changed since they were written."""
    known = Metadata.read(path)
    if known is None:
        return (Metadata(files={}, identity={}).sealed()[0],)
    return changed_files(path, known.files)


def _read_attributes(path: Path) -> dict[str, Any] | None:
    try:
        found = json.loads((path / METADATA).read_text(encoding="utf-8"))["attributes"]
        return {**found, _IDENTITY: json.loads(found[_IDENTITY])}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def check_is_store(path: Path) -> None:
    """Check that a folder is the store of a study, damaged or not.

    Raises
    ------
    InputError
        If it is not there, or something else.
    """
    if not _exists(path):
        raise InputError(f'there is no "{path}"')
    known = (path / LEDGER / _LOCK).exists() or _read_attributes(path) is not None
    if not known and Metadata.read(path) is None:
        raise InputError(f'"{path}" exists and is not the store of a study: choose another name')


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError as error:  # such as a name that is too long
        raise InputError(f"{as_told(str(path))} cannot be read: {error.strerror}") from None


def _repair(path: Path, files: Mapping[str, bytes], study: Study) -> tuple[str, ...]:
    """Write damaged metadata again; its names."""
    damaged = damaged_metadata(path)
    if damaged:
        # a title or a comment may have changed, so all of it belongs together
        name, record = Metadata.of_files(files, _as_stored(study.identity)).sealed()
        for each, data in {**files, name: record}.items():
            write_whole(path / each, data)
    return damaged


def _as_stored(identity: Mapping[str, Any]) -> Mapping[str, Any]:
    """As read back from JSON: tuples become lists."""
    found: Mapping[str, Any] = json.loads(json.dumps(identity))
    return found


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


def _make(path: Path, files: Mapping[str, bytes], study: Study) -> None:
    """Create a store without chunks, in one step."""
    if not path.parent.is_dir():
        raise InputError(f'cannot write "{path}": there is no folder "{path.parent}"')
    # on the same file system, so that renaming is atomic
    part = path.with_name(f".{path.name}.{os.getpid()}{PARTIAL}")
    shutil.rmtree(part, ignore_errors=True)
    record, content = Metadata.of_files(files, _as_stored(study.identity)).sealed()
    try:
        for name, data in {**files, record: content, f"{LEDGER}/{_LOCK}": b""}.items():
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            (part / name).write_bytes(data)
        os.rename(part, path)
    except OSError as error:
        raise unwritten(path, error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _take_away(path: Path) -> None:
    """Delete a store in one step: remaining parts would be resumed.

    Raises
    ------
    InputError
        If it contains files that no study has written.
    """
    if foreign := _foreign_files(path):
        raise InputError(
            f'"{path}" also contains files that are no part of a study, as "{foreign[0]}": '
            "move them elsewhere, or choose another store"
        )
    aside = path.with_name(f".{path.name}.{os.getpid()}.old{PARTIAL}")
    with _lock_store(path):
        # renamed before deletion: an interruption leaves no incomplete store of this name
        os.rename(path, aside)
    shutil.rmtree(aside)


def _foreign_files(path: Path) -> list[str]:
    """Files in a store that are neither metadata, nor parts of arrays, nor of the ledger."""
    arrays = {found.parent.name for found in path.glob(f"*/{METADATA}")}
    return [
        str(Path(*parts))
        for parts in (file.relative_to(path).parts for file in sorted(path.rglob("*")))
        if (path / Path(*parts)).is_file() and not _is_own(parts, arrays)
    ]


def _is_own(parts: Sequence[str], arrays: Container[str]) -> bool:
    folder, *rest = parts
    name = parts[-1].removesuffix(PARTIAL)
    if not rest:
        return name == METADATA
    if folder == LEDGER:
        return len(rest) == 1 and (name in (METADATA, _LOCK) or name.endswith(".json"))
    if len(rest) == 1:
        return name == METADATA
    numbers = (*rest[1:-1], name)
    return folder in arrays and rest[0] == "c" and all(part.isdecimal() for part in numbers)


def _check_same(study: Study, path: Path) -> None:
    """Reject the store of another study."""
    here = _as_stored(study.identity)
    known, attributes = Metadata.read(path), _read_attributes(path)
    if known is not None:
        there = known.identity
    elif attributes is not None:
        there = attributes[_IDENTITY]
    else:
        raise InputError(
            f'"{path}" is damaged beyond knowing its study: start over with --force, '
            "which deletes it, or choose another store"
        )
    if told := "\n".join(_differences(there, here)):
        raise InputError(
            f'"{path}" holds another study:\n{told}\n'
            "Choose another store, or start over with --force, "
            "which deletes the old study."
        )


def _differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """The differences between two studies, one line each."""
    for key in {**here, **there}:
        old: Any = there.get(key)
        new: Any = here.get(key)
        if old == new:
            continue
        if key == "mechanism":
            old, new = _first_change(old, new)
        # different names: values need not be compared
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
    for name in {**new, **old}:
        if old.get(name) != new.get(name):
            yield name, old.get(name), new.get(name)


def _first_change(old: str, new: str) -> tuple[str, str]:
    """The first differing lines of two texts."""
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
    """Lock the store against other writers; the lock of a killed process disappears."""
    lock = path / LEDGER / _LOCK
    lock.parent.mkdir(exist_ok=True)
    with lock.open("ab") as file:
        try:
            if sys.platform == "win32":
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            else:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # a store deleted between opening and locking counts as locked
            if not os.path.samestat(os.fstat(file.fileno()), lock.stat()):
                raise FileNotFoundError(lock)
        except OSError:
            raise InputError(
                f'another run is writing to "{path}": wait for it or stop it'
            ) from None
        yield
