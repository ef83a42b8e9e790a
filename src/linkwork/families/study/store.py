"""Whether the packages of stores are installed; asked before anything that loads Numba."""

from __future__ import annotations

import json
import os
import shutil
import sys
import warnings
import zlib
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.errors import InputError, key_text
from linkwork.core.foundation.files import as_path, unwritten
from linkwork.core.foundation.values import as_told
from linkwork.families.study.study import DESIGN, Part, Study, Variable

# ----------------------------------------------------------------------
# Arrays as files of a Zarr store; the only module that uses zarr.
#
# Files are created in memory and written by :mod:`~linkwork.batch.study.store`, each completely or
# not at all.


#: The group that lists finished chunks.
LEDGER = "ledger"
#: The file that describes the whole store, or one array in its folder.
METADATA = "zarr.json"


class ZarrFiles:
    """The files of a store, created in memory.

    Parameters
    ----------
    variables : iterable of Variable
    sizes : Mapping[str, int]
        Length of every axis.
    chunk : int
        Designs per file.
    attributes : Mapping
        Attributes of the store.
    """

    def __init__(
        self,
        variables: Iterable[Variable],
        sizes: Mapping[str, int],
        chunk: int,
        attributes: Mapping[str, Any],
    ) -> None:
        import zarr
        from zarr.codecs import ZstdCodec
        from zarr.storage import MemoryStore

        self._files: dict[str, Any] = {}
        store = MemoryStore(self._files)
        group = zarr.open_group(store, mode="w", zarr_format=3, attributes=dict(attributes))
        group.create_group(LEDGER)
        self._arrays: dict[str, Any] = {}
        for variable in variables:
            array = group.create_array(
                variable.name,
                shape=tuple(sizes[axis] for axis in variable.axes),
                chunks=tuple(chunk if axis == DESIGN else sizes[axis] for axis in variable.axes),
                dtype=variable.dtype,
                fill_value=variable.fill,
                dimension_names=variable.axes,
                attributes=dict(variable.attributes),
                compressors=ZstdCodec(level=3),
            )
            if variable.values is not None:
                array[:] = variable.values
            self._arrays[variable.name] = array
        with warnings.catch_warnings():
            # used by xarray; other readers read the metadata of each array
            warnings.filterwarnings("ignore", message="Consolidated metadata")
            zarr.consolidate_metadata(store)
        #: Path and content of the files that exist before any computation.
        self.first = {path: buffer.to_bytes() for path, buffer in self._files.items()}

    def encoded(self, designs: range, arrays: Mapping[str, AnyArray]) -> dict[str, bytes]:
        """Path and content of the files that hold a chunk's arrays."""
        for name, values in arrays.items():
            self._arrays[name][designs.start : designs.stop] = values
        made = [path for path in self._files if path not in self.first]
        return {path: self._files.pop(path).to_bytes() for path in made}


def open_arrays(path: Path) -> Any:
    """The arrays of a store for reading, as a zarr group."""
    import zarr

    return zarr.open_group(str(path), mode="r")


# ----------------------------------------------------------------------
# The manifest of a store: finished chunks, with the checksums of their files.
#
# A chunk is finished when its entry exists; the entry is written after the files. After a killed
# run, unfinished chunks are computed again, and so are chunks with files that have changed since.
# Every file of the manifest has a checksum of its own.


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


# ----------------------------------------------------------------------
# The store of a study on disk: create, resume, or reject the store of another study.


if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


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


# ----------------------------------------------------------------------
# Whether a store is as it was written.


@dataclass(frozen=True, kw_only=True)
class Verification:
    """The files of a store compared with their checksums.

    Parameters
    ----------
    sound : int
        Chunks that are as they were written.
    metadata : tuple of str
        Changed files that describe the store.
    chunks : Mapping[int, tuple of str]
        Changed files of damaged chunks.
    """

    sound: int
    metadata: tuple[str, ...]
    chunks: Mapping[int, tuple[str, ...]]

    @property
    def intact(self) -> bool:
        """Whether nothing has changed."""
        return not self.metadata and not self.chunks

    def to_dict(self) -> dict[str, Any]:
        """The result in JSON types."""
        return {"intact": self.intact, **asdict(self)}


def verify_store(store: Path | str) -> Verification:
    """Compare all files of a study's store with their checksums; nothing is changed.

    Raises
    ------
    InputError
        If it is not the store of a study.
    """
    path = as_path(store)
    check_is_store(path)
    sound, damaged = read_entries(path)
    return Verification(sound=len(sound), metadata=damaged_metadata(path), chunks=damaged)
