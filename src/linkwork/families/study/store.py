"""The packages that a study needs."""

from __future__ import annotations

import json
import os
import shutil
import sys
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.errors import InputError, MissingPackageError, key_text
from linkwork.core.foundation.files import as_path, unwritten
from linkwork.core.foundation.values import as_told
from linkwork.families.study.study import DESIGN, Part, Study, passes_name


def check_packages() -> None:
    """Check that the packages for stores are installed.

    Raises
    ------
    MissingPackageError
        If one is missing; with the install command.
    """
    # not imported here: an import that Ctrl-C ends may raise ImportError
    if any(find_spec(name) is None for name in ("xarray", "zarr")):
        raise MissingPackageError(
            'studies are stored by zarr and xarray: pip install "linkwork[study]"'
        )


# ----------------------------------------------------------------------
# The store of a study: a Zarr group that is written chunk by chunk and can be resumed.
#
# A chunk is finished when the array ``ledger/chunks`` has its record, which is written last. zarr
# writes every file completely or not at all, and ends the files of chunks with a checksum (codec
# ``crc32c``).


if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

#: The group of what Linkwork notes about the chunks.
LEDGER = "ledger"
#: The file that describes the whole store, or one array in its folder.
METADATA = "zarr.json"

_RECORDS = f"{LEDGER}/chunks"  # an array of texts, one for each chunk
_LOCK = f"{LEDGER}/lock"
_IDENTITY = "linkwork_identity"
_PARTIAL = ".partial"  # zarr's suffix of incomplete files
_LONGEST_SHOWN = 60  # maximum length of a value in a message


# ----------------------------------------------------------------------
# Create a store, or resume it.


class Store:
    """The store of one study, open for writing; see :func:`open_store`."""

    def __init__(self, path: Path, study: Study) -> None:
        import zarr

        self.path, self.study = path, study
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
    if force and _exists(path):
        _take_away(path)
    if not _exists(path):
        _make(path, study)
    attributes = attributes_of(path)  # only stores have a lock
    with _lock_store(path):
        _check_same(path, attributes[_IDENTITY], study.identity)
        for incomplete in path.rglob(f"*{_PARTIAL}"):
            incomplete.unlink()
        yield Store(path, study)


def _make(path: Path, study: Study) -> None:
    """Create a store without chunks, in one step."""
    if not path.parent.is_dir():
        raise InputError(f'cannot write "{path}": there is no folder "{path.parent}"')
    # on the same file system, so that renaming is atomic
    part = path.with_name(f".{path.name}.{os.getpid()}{_PARTIAL}")
    shutil.rmtree(part, ignore_errors=True)
    try:
        _write_without_chunks(part, study)
        os.rename(part, path)
    except OSError as error:
        raise unwritten(path, error) from None
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _write_without_chunks(folder: Path, study: Study) -> None:
    """The description of a store and of its arrays, and the inputs of all designs."""
    import zarr
    from zarr.codecs import Crc32cCodec, ZstdCodec

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
    group = zarr.open_group(str(folder), mode="w", zarr_format=3, attributes=attributes)
    for variable in study.variables:
        array = group.create_array(
            variable.name,
            shape=tuple(sizes[axis] for axis in variable.axes),
            chunks=tuple(chunks[axis] for axis in variable.axes),
            dtype=variable.dtype,
            fill_value=variable.fill,
            dimension_names=variable.axes,
            attributes=variable.attributes,
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
        zarr.consolidate_metadata(group.store)
    (folder / _LOCK).touch()


def _take_away(path: Path) -> None:
    """Delete the store of a study in one step: remaining parts would be resumed."""
    attributes_of(path)  # deletes nothing else
    aside = path.with_name(f".{path.name}.{os.getpid()}.old{_PARTIAL}")
    with _lock_store(path):
        # renamed before deletion: an interruption leaves no incomplete store of this name
        os.rename(path, aside)
    shutil.rmtree(aside)


@contextmanager
def _lock_store(path: Path) -> Iterator[None]:
    """Lock the store against other writers; the lock of a killed process disappears."""
    with (path / _LOCK).open("ab") as file:
        try:
            if sys.platform == "win32":
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            else:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
    """The arrays of a store for reading, as a zarr group."""
    import zarr

    return zarr.open_group(str(path), mode="r")


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
        If it is not there, or not the store of a study.
    """
    if not _exists(path):
        raise InputError(f'there is no "{path}"')
    try:
        described = json.loads((path / METADATA).read_text(encoding="utf-8"))["attributes"]
        return {**described, _IDENTITY: json.loads(described[_IDENTITY])}
    except (OSError, ValueError, KeyError, TypeError):
        raise InputError(
            f'"{path}" exists and is not the store of a study: choose another name'
        ) from None


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError as error:  # such as a name that is too long
        raise InputError(f"{as_told(str(path))} cannot be read: {error.strerror}") from None


# ----------------------------------------------------------------------
# Whether a store holds the same study.


def _check_same(path: Path, there: Mapping[str, Any], here: Mapping[str, Any]) -> None:
    """Reject the store of another study."""
    old, new = _entries(there), _entries(here)
    lines = [
        _difference(key, old.get(key), new.get(key))
        for key in {**old, **new}
        if old.get(key) != new.get(key)
    ]
    if lines:
        raise InputError(
            "\n".join([f'"{path}" holds another study:', *lines])
            + "\nChoose another store, or start over with --force, which deletes the old study."
        )


def _entries(identity: Mapping[str, Any]) -> dict[tuple[str, ...], Any]:
    """What identifies a study, by key path."""
    found: dict[tuple[str, ...], Any] = {}
    for name, value in identity.items():
        if isinstance(value, dict):
            found |= {(name, key): entry for key, entry in value.items()}
        else:
            # blank lines at the end of a mechanism may differ
            found[(name,)] = value.rstrip() if isinstance(value, str) else value
    return found


def _difference(key: tuple[str, ...], old: Any, new: Any) -> str:
    """A line about two values; of two texts about the first lines that differ."""
    if isinstance(old, str) and isinstance(new, str):
        lines = zip_longest(old.split("\n"), new.split("\n"), fillvalue="")
        old, new = next(pair for pair in lines if pair[0] != pair[1])
    return f"  {key_text(key)}: {_shown(old)} there, {_shown(new)} here"


def _shown(value: Any) -> str:
    if value is None or value == "":
        return "nothing"
    text = value.strip() if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _LONGEST_SHOWN else text[:_LONGEST_SHOWN] + "…"


# ----------------------------------------------------------------------
# Whether a store is as it was written.


@dataclass(frozen=True, kw_only=True)
class Verification:
    """The chunks of a store compared with their checksums.

    Parameters
    ----------
    sound : int
        Chunks that are as they were written.
    chunks : Mapping[int, tuple of str]
        Changed files of damaged chunks.
    """

    sound: int
    chunks: Mapping[int, tuple[str, ...]]

    @property
    def intact(self) -> bool:
        """Whether nothing has changed."""
        return not self.chunks

    def to_dict(self) -> dict[str, Any]:
        """The result in JSON types."""
        return {"intact": self.intact, **asdict(self)}


def verify_store(store: Path | str) -> Verification:
    """Compare the chunks of a study's store with their checksums; nothing is changed.

    Raises
    ------
    InputError
        If it is not the store of a study.
    """
    path = as_path(store)
    attributes_of(path)
    files = {chunk.number: chunk.changed for chunk in read_chunks(path)}
    changed = {number: names for number, names in files.items() if names}
    return Verification(sound=len(files) - len(changed), chunks=changed)


# ----------------------------------------------------------------------
# The summary of a store: counts, ranges and histograms, also of an unfinished study.


_BINS = 12
_SAME_VALUE = 1e-12  # relative: values that differ by less are equal


@dataclass(frozen=True, kw_only=True)
class OutputSummary:
    """The values of one output of the designs that passed.

    Parameters
    ----------
    name, unit : str
    count : int
        Number of values.
    least, mean, most : float
        NaN without values.
    histogram : tuple of int
        Numbers of values in equal bins from ``least`` to ``most``; one bin if all values are equal
        to rounding.
    """

    name: str
    unit: str
    count: int
    least: float
    mean: float
    most: float
    histogram: tuple[int, ...]


@dataclass(frozen=True, kw_only=True)
class Summary:
    """The summary of a study, computed from its store.

    Parameters
    ----------
    name, mechanism : str
    designs, computed : int
        Numbers of designs in the plan and in the store.
    inputs : int
        Rows of each design.
    built, passed : int
        Designs that could be built, and those that passed every filter.
    filters : Mapping[str, (str, int)]
        By name: the condition, and the number of designs that pass it.
    rows : Mapping[str, int]
        Rows of designs that were built, by status.
    certified : int
        Rows that are proved.
    problems : Mapping[str, int]
        Number of designs that could not be built, by reason.
    outputs : tuple of OutputSummary
    damaged : tuple of int
        Chunks whose files have changed since they were stored; they count as not computed.
    repaired : tuple of int
        Damaged chunks that the run has computed again.
    """

    name: str
    mechanism: str
    designs: int
    computed: int
    inputs: int
    built: int
    passed: int
    filters: Mapping[str, tuple[str, int]]
    rows: Mapping[str, int]
    certified: int
    problems: Mapping[str, int]
    outputs: tuple[OutputSummary, ...]
    damaged: tuple[int, ...] = ()
    repaired: tuple[int, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """The summary in JSON types."""
        return asdict(self)


def summary_of(store: Path | str) -> Summary:
    """The summary of a study's store, finished or not.

    Raises
    ------
    InputError
        If it is not the store of a study.
    """
    path = as_path(store)
    known = attributes_of(path)
    check_packages()
    identity = known["linkwork_identity"]
    filters = identity["filters"]
    counted = ("built", "passed", "certified", *map(passes_name, filters))
    outputs = {name: _Output() for name in (*identity["reductions"], *identity["keep"])}
    counts, rows, problems = Counter[str](), Counter[str](), Counter[str]()
    sound: list[range] = []
    damaged: list[int] = []
    for chunk in read_chunks(path):
        if chunk.changed:
            damaged.append(chunk.number)
            continue
        sound.append(chunk.designs)
        rows.update(chunk.rows)
        problems.update(chunk.problems)
        counts.update({name: int(chunk.arrays[name].sum()) for name in counted})
        for name, output in outputs.items():
            output.measure(_values(chunk.arrays[name], chunk.arrays["passed"]))
    arrays = open_arrays(path)
    return Summary(
        name=known["title"],
        mechanism=known["mechanism_name"],
        designs=identity["count"],
        computed=sum(map(len, sound)),
        inputs=identity["input"]["rows"],
        built=counts["built"],
        passed=counts["passed"],
        filters={name: (filters[name], counts[passes_name(name)]) for name in filters},
        rows=dict(rows.most_common()),
        certified=counts["certified"],
        problems=dict(problems.most_common()),
        outputs=tuple(
            output.summary(name, arrays[name], arrays["passed"], sound)
            for name, output in outputs.items()
        ),
        damaged=tuple(damaged),
    )


def _values(values: AnyArray, passed: AnyArray) -> Array:
    """The available values of designs that passed."""
    there = values[passed]
    return np.asarray(there[np.isfinite(there)])


class _Output:
    """The values of an output, chunk by chunk: the store may be larger than memory."""

    count, total, least, most = 0, 0.0, np.inf, -np.inf

    def measure(self, values: Array) -> None:
        """Count the values of a chunk."""
        self.count += values.size
        self.total += float(values.sum())
        self.least = min(self.least, float(values.min(initial=np.inf)))
        self.most = max(self.most, float(values.max(initial=-np.inf)))

    def summary(self, name: str, array: Any, passed: Any, sound: list[range]) -> OutputSummary:
        """Of all values; the chunks are read again, since the ends of the bins are known now."""
        found = self.count > 0
        bins = np.array([self.count] if found else [], dtype=int)
        if found and self.most - self.least > _SAME_VALUE * max(abs(self.least), abs(self.most)):
            bins = np.zeros(_BINS, dtype=int)
            for designs in sound:
                part = slice(designs.start, designs.stop)
                values = _values(array[part], passed[part])
                bins += np.histogram(values, _BINS, (self.least, self.most))[0]
        return OutputSummary(
            name=name,
            unit=array.attrs.get("units", ""),
            count=self.count,
            least=self.least if found else np.nan,
            mean=self.total / self.count if found else np.nan,
            most=self.most if found else np.nan,
            histogram=tuple(bins.tolist()),
        )
