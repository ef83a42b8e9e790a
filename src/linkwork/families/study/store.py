"""The store of a study: a Zarr group that is written chunk by chunk and can be resumed.

A chunk is finished when the array ``ledger/chunks`` has its record, which is written last. zarr
writes every file completely or not at all, and ends it with a checksum (codec ``crc32c``).

Zarr has no checksums of the files that describe arrays. ``ledger/store`` has them, and its content
describes the store while such a file is damaged.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import warnings
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from itertools import islice, zip_longest
from pathlib import Path
from typing import Any

from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.errors import InputError, key_text
from linkwork.core.foundation.files import as_path, unwritten
from linkwork.core.foundation.values import as_told
from linkwork.families.study.study import DESIGN, Part, Study

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

#: The group of what Linkwork notes about the chunks and the store.
LEDGER = "ledger"
#: The file that describes the whole store, or one array in its folder.
METADATA = "zarr.json"

_RECORDS = f"{LEDGER}/chunks"  # an array of texts, one for each chunk
_STORE = f"{LEDGER}/store"
_LOCK = f"{LEDGER}/lock"
_IDENTITY = "linkwork_identity"
_PARTIAL = ".partial"  # zarr's suffix of incomplete files
_LONGEST_SHOWN = 60  # maximum length of a value in a message
_DEEPEST = 2  # keys of a difference between studies, as dimensions."O2 A"


# ----------------------------------------------------------------------
# Create a store, or resume it.


class Store:
    """The store of one study, open for writing; see :func:`open_store`.

    Parameters
    ----------
    path : Path
    study : Study
    repaired : tuple of str
        Metadata that was damaged and has been written again.
    """

    def __init__(self, path: Path, study: Study, repaired: tuple[str, ...]) -> None:
        import zarr

        self.path, self.study, self.repaired = path, study, repaired
        changed = {chunk.number: bool(chunk.changed) for chunk in read_chunks(path)}
        #: Finished chunks as they were written.
        self.done = {k for k in changed if not changed[k]}
        #: Chunks that were finished, and have changed since.
        self.damaged = tuple(k for k in changed if changed[k])
        group = zarr.open_group(str(path), mode="r+")
        # otherwise a chunk of fill values would have no file, like one that was lost
        with zarr.config.set({"array.write_empty_chunks": True}):
            self._arrays = _arrays_of_chunks(group)

    def write(self, k: int, part: Part) -> None:
        """Store a chunk: first its arrays, then its record."""
        designs = self.study.designs_of(k)
        for name, values in {**self.study.varied(k), **part.arrays}.items():
            self._write(name, designs, values)
        record = json.dumps({"rows": part.rows, "problems": part.problems}, sort_keys=True)
        self._write(_RECORDS, range(k, k + 1), [record])
        self.done.add(k)

    def _write(self, name: str, where: range, values: AnyArray | list[str]) -> None:
        try:
            self._arrays[name][where.start : where.stop] = values
        except OSError as error:
            raise InputError(
                f'cannot write "{self.path / name}": {error.strerror or error}. The chunks that '
                "are stored are complete: make room and repeat the command"
            ) from None


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
    files = _files_before_chunks(study)
    if force and _exists(path):
        check_is_store(path)  # delete nothing but the store of a study
        _take_away(path)
    if not _exists(path):
        _make(path, files)
    check_is_store(path)  # only stores have a lock
    with _lock_store(path):
        _check_same(study, path)
        of_study = _names_of_files(path)
        for incomplete in path.rglob(f"*{_PARTIAL}"):
            if of_study.fullmatch(incomplete.relative_to(path).as_posix()):
                incomplete.unlink()
        repaired = damaged_metadata(path)
        if repaired:
            # a title or a comment may have changed, so all of it belongs together
            _write_files(path, files)
        yield Store(path, study, repaired)


def _files_before_chunks(study: Study) -> dict[str, bytes]:
    """Path and content of the files of a store without chunks."""
    import zarr
    from zarr.codecs import Crc32cCodec, ZstdCodec
    from zarr.storage import MemoryStore

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
    chunks = {**sizes, DESIGN: study.chunk_size}
    buffers: dict[str, Any] = {}
    store = MemoryStore(buffers)
    group = zarr.open_group(store, mode="w", zarr_format=3, attributes=attributes)
    for variable in study.variables:
        array = group.create_array(
            variable.name,
            shape=tuple(sizes[axis] for axis in variable.axes),
            chunks=tuple(chunks[axis] for axis in variable.axes),
            dtype=variable.dtype,
            fill_value=variable.fill,
            dimension_names=variable.axes,
            attributes=dict(variable.attributes),
            compressors=[ZstdCodec(level=3), Crc32cCodec()],
        )
        if variable.values is not None:
            array[:] = variable.values
    group.create_array(
        _RECORDS,
        shape=(study.chunks,),
        chunks=(1,),
        dtype="string",
        fill_value="",
        compressors=[Crc32cCodec()],
    )
    with warnings.catch_warnings():
        # used by xarray; other readers read the metadata of each array
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        zarr.consolidate_metadata(store)
    files = {path: buffer.to_bytes() for path, buffer in buffers.items()}
    content = {
        "group": json.loads(files[METADATA]),
        "checksums": {path: zlib.crc32(data) for path, data in files.items()},
    }
    text = json.dumps(content, ensure_ascii=False).encode()
    return {**files, _STORE: _checksum(text) + b"\n" + text}


def _make(path: Path, files: Mapping[str, bytes]) -> None:
    """Create a store without chunks, in one step."""
    if not path.parent.is_dir():
        raise InputError(f'cannot write "{path}": there is no folder "{path.parent}"')
    # on the same file system, so that renaming is atomic
    part = path.with_name(f".{path.name}.{os.getpid()}{_PARTIAL}")
    shutil.rmtree(part, ignore_errors=True)
    try:
        _write_files(part, {**files, _LOCK: b""})
        os.rename(part, path)
    except OSError as error:
        raise unwritten(path, error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _write_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files, each completely or not at all."""
    for name, data in files.items():
        path = folder / name
        part = path.with_name(path.name + _PARTIAL)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            part.write_bytes(data)
            os.replace(part, path)
        except OSError as error:
            raise unwritten(path, error) from None


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
    aside = path.with_name(f".{path.name}.{os.getpid()}.old{_PARTIAL}")
    with _lock_store(path):
        # renamed before deletion: an interruption leaves no incomplete store of this name
        os.rename(path, aside)
    shutil.rmtree(aside)


def _foreign_files(path: Path) -> list[str]:
    """Files in a store that are neither metadata, nor chunks of arrays, nor of the ledger."""
    of_study = _names_of_files(path)
    files = (each.relative_to(path) for each in sorted(path.rglob("*")) if each.is_file())
    return [str(file) for file in files if not of_study.fullmatch(file.as_posix())]


def _names_of_files(path: Path) -> re.Pattern[str]:
    """The names of all files that a study may have written, incomplete ones too."""
    arrays = [re.escape(found.parent.name) for found in path.glob(f"*/{METADATA}")]
    folder = f"({'|'.join([*arrays, _RECORDS])})/"
    chunk = r"c(/\d+)+(\.[0-9a-f]{32})?"
    return re.compile(
        f"(({folder})?{METADATA}|{folder}{chunk}|{_STORE})({_PARTIAL})?|{_LOCK}", re.DOTALL
    )


@contextmanager
def _lock_store(path: Path) -> Iterator[None]:
    """Lock the store against other writers; the lock of a killed process disappears."""
    lock = path / _LOCK
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
# Read a store.


@dataclass(frozen=True, kw_only=True)
class StoredChunk:
    """A finished chunk of D designs.

    Parameters
    ----------
    number : int
    designs : range
    changed : tuple of str
        The files that are missing or do not match their checksums; such a chunk has no rows and no
        problems.
    arrays : Mapping[str, (D,) or (D, R)]
    rows : Mapping[str, int]
        Number of rows by status.
    problems : Mapping[str, int]
        Number of designs that could not be built, by reason.
    """

    number: int
    designs: range
    changed: tuple[str, ...]
    arrays: Mapping[str, AnyArray]
    rows: Mapping[str, int]
    problems: Mapping[str, int]


def open_arrays(path: Path) -> Any:
    """The arrays of a store for reading, as a zarr group; damaged metadata is not read."""
    import zarr
    from zarr.storage import LocalStore, StorePath

    store = LocalStore(path, read_only=True)
    return zarr.Group(zarr.AsyncGroup.from_dict(StorePath(store), _description(path)))


def read_chunks(path: Path) -> Iterator[StoredChunk]:
    """The finished chunks, in order."""
    arrays = _arrays_of_chunks(open_arrays(path))
    return (_read_chunk(path, arrays, k) for k in sorted(chunks_with_record(path)))


def _read_chunk(path: Path, arrays: Mapping[str, Any], k: int) -> StoredChunk:
    values: dict[str, AnyArray] = {}
    changed: list[str] = []
    for name, array in arrays.items():
        place = (k, *[0] * (array.ndim - 1))
        file = f"{name}/{array.metadata.encode_chunk_key(place)}"
        try:
            values[name] = array.get_block_selection(place)
        except (OSError, ValueError):
            changed.append(file)
        else:
            if not (path / file).exists():  # zarr has read fill values instead
                changed.append(file)
    (size,), (count,) = arrays["built"].chunks, arrays["built"].shape
    record = {"rows": {}, "problems": {}} if changed else json.loads(values.pop(_RECORDS)[0])
    return StoredChunk(
        number=k,
        designs=range(k * size, min((k + 1) * size, count)),
        changed=tuple(changed),
        arrays=values,
        **record,
    )


def chunks_with_record(path: Path) -> set[int]:
    """The chunks that are recorded as finished; their files are not read."""
    names = (file.name for file in (path / _RECORDS / "c").glob("*"))
    return {int(name) for name in names if name.isdecimal()}


def _arrays_of_chunks(group: Any) -> dict[str, Any]:
    """The arrays that are written chunk by chunk, the records last."""
    found = dict(group.arrays())
    stored = {name: a for name, a in found.items() if a.metadata.dimension_names[0] == DESIGN}
    return {**stored, _RECORDS: group[_RECORDS]}


def attributes_of(path: Path) -> Mapping[str, Any]:
    """The attributes of a store that describe its study.

    Raises
    ------
    InputError
        If it is not the store of a study, or its metadata is damaged.
    """
    check_is_store(path)
    if damaged_metadata(path):
        raise InputError(
            f'the metadata of "{path}" is damaged, or of an earlier version: repeat the command '
            "of its study, which repairs the store"
        )
    return _attributes(_description(path))


def damaged_metadata(path: Path) -> tuple[str, ...]:
    """The files that describe a store and have changed since they were written."""
    known = _read_store_file(path)
    if known is None:
        return (_STORE,)
    return tuple(file for file, sum_ in known["checksums"].items() if _sum(path / file) != sum_)


def _description(path: Path) -> dict[str, Any]:
    """The content of the file that describes the whole store, also while it is damaged.

    Raises
    ------
    InputError
        If its copy is damaged too.
    """
    known = _read_store_file(path)
    found = _read_group(path) if known is None else known["group"]
    if found is None:
        raise InputError(
            f'"{path}" is damaged beyond knowing its study: start over with --force, '
            "which deletes it, or choose another store"
        )
    return found


def _attributes(description: Mapping[str, Any]) -> dict[str, Any]:
    found = description["attributes"]
    return {**found, _IDENTITY: json.loads(found[_IDENTITY])}


def _read_store_file(path: Path) -> dict[str, Any] | None:
    """The copy of the description, and checksums; ``None`` if the file is missing or damaged."""
    try:
        checksum, text = (path / _STORE).read_bytes().split(b"\n", 1)
        known: dict[str, Any] | None = json.loads(text) if checksum == _checksum(text) else None
    except (OSError, ValueError):
        return None
    return known


def _read_group(path: Path) -> dict[str, Any] | None:
    """The description of a study's store; ``None`` if it is missing or damaged."""
    try:
        found: dict[str, Any] = json.loads((path / METADATA).read_text(encoding="utf-8"))
        _attributes(found)
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    return found


def _checksum(text: bytes) -> bytes:
    return b"%08x" % zlib.crc32(text)


def _sum(file: Path) -> int | None:
    try:
        return zlib.crc32(file.read_bytes())
    except OSError:
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
    known = (path / _LOCK).exists() or _read_store_file(path) is not None
    if not known and _read_group(path) is None:
        raise InputError(f'"{path}" exists and is not the store of a study: choose another name')


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError as error:  # such as a name that is too long
        raise InputError(f"{as_told(str(path))} cannot be read: {error.strerror}") from None


# ----------------------------------------------------------------------
# Whether a store holds the same study.


def _check_same(study: Study, path: Path) -> None:
    """Reject the store of another study."""
    there = _attributes(_description(path))[_IDENTITY]
    if lines := "\n".join(_differences(there, study.identity)):
        raise InputError(
            f'"{path}" holds another study:\n{lines}\n'
            "Choose another store, or start over with --force, "
            "which deletes the old study."
        )


def _differences(there: Any, here: Any, *key: str) -> Iterator[str]:
    """The differences between two studies, one line each."""
    if isinstance(there, dict) and isinstance(here, dict) and len(key) < _DEEPEST:
        for name in {**here, **there}:
            yield from _differences(there.get(name), here.get(name), *key, name)
    elif isinstance(there, str) and isinstance(here, str):
        # the first lines that differ
        lines = zip_longest(there.split("\n"), here.split("\n"), fillvalue="")
        for old, new in islice((pair for pair in lines if pair[0] != pair[1]), 1):
            yield _difference(old.strip(), new.strip(), key)
    elif there != here:
        yield _difference(there, here, key)


def _difference(there: Any, here: Any, key: tuple[str, ...]) -> str:
    return f"  {key_text(key)}: {_shown(there)} there, {_shown(here)} here"


def _shown(value: Any) -> str:
    if value is None or value == "":
        return "nothing"
    text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _LONGEST_SHOWN else text[:_LONGEST_SHOWN] + "…"


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
    files = {chunk.number: chunk.changed for chunk in read_chunks(path)}
    changed = {number: names for number, names in files.items() if names}
    return Verification(
        sound=len(files) - len(changed), metadata=damaged_metadata(path), chunks=changed
    )
