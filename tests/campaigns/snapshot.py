"""What mechanisms do, recorded before the code is changed at large, to be compared afterwards.

Of every mechanism: the rows of its sweep, its configurations, and of some its circuits and the
rows of a family; see :mod:`tests.campaigns.snapshot_mechanisms` for which mechanisms there are.
Only the public interface is asked, so that a record outlives the code that made it.

A record is flat: words and numbers by ``section.category.field``.
"""

from __future__ import annotations

import json
import multiprocessing
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

import linkwork as lw
from linkwork.core.results.failure import Limit
from tests.campaigns.snapshot_mechanisms import (
    designs_of,
    mechanism_of,
    wants_circuits,
)

__all__ = ["Record", "Snapshot", "attempt", "load", "record_of", "save", "take"]

Array = npt.NDArray[np.float64]
T = TypeVar("T")

_FILE = "snapshot.npz"


@dataclass
class Record:
    """What one mechanism does; ``seconds`` is the processor's time of each call."""

    name: str
    words: dict[str, list[str]] = field(default_factory=dict)
    numbers: dict[str, Array] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    def say(self, path: str, words: Iterable[object]) -> None:
        """Record words, statuses, names, yes and no."""
        self.words[path] = [str(word) for word in words]

    def note(self, path: str, numbers: object) -> None:
        """Record numbers exactly."""
        self.numbers[path] = np.array(numbers, dtype=float)


@dataclass(frozen=True)
class Snapshot:
    """Records by name, and how long it took to make them."""

    records: dict[str, Record]
    seconds: float

    def told(self) -> str:
        """How many mechanisms, calls, rows, and what they took; errors by their type."""
        calls: Counter[str] = Counter()
        seconds: defaultdict[str, float] = defaultdict(float)
        counts: Counter[str] = Counter()
        for record in self.records.values():
            for section, taken in record.seconds.items():
                calls[section] += 1
                seconds[section] += taken
            for path, words in record.words.items():
                section, category, what = path.split(".")
                if category == "error":
                    counts[f"{section}: {words[0]}"] += 1
                elif (category, what) in _COUNTED:
                    counts[f"{section}, {_COUNTED[category, what]}"] += len(words)
        whole = f"{sum(seconds.values()):.0f} s of one core"
        lines = [f"{len(self.records)} mechanisms in {self.seconds:.0f} s, {whole}"]
        lines += [f"  {n:>8} {name:<16} {seconds[name]:>9.1f} s" for name, n in calls.items()]
        lines += [f"  {n:>8} {name}" for name, n in sorted(counts.items())]
        each = [(s, r.name, call) for r in self.records.values() for call, s in r.seconds.items()]
        for taken, name, call in sorted(each, reverse=True)[:5]:
            lines.append(f"  {taken:>8.1f} s {name}, {call}")
        return "\n".join(lines)


#: Words that are counted in the summary: one for each row, configuration, circuit.
_COUNTED = {
    ("status", "name"): "positions",
    ("circuits", "name"): "circuits",
    ("branches", "name"): "branches",
    ("limits", "kind"): "limits",
}


# ------------------------------------------------------------------ one mechanism


def record_of(name: str) -> Record:
    """What the mechanism of this name does."""
    record = Record(name)
    mechanism = attempt(record, "make", lambda: mechanism_of(name))
    if mechanism is None:
        return record
    motion = attempt(record, "sweep", mechanism.sweep)
    if motion is not None:
        _add_motion(record, motion)
    configurations = attempt(record, "configurations", mechanism.configurations)
    if configurations is not None:
        _add_configurations(record, configurations)
    if wants_circuits(name):
        circuits = attempt(record, "circuits", mechanism.circuits)
        if circuits is not None:
            _add_circuits(record, circuits)
    designs = {} if motion is None else designs_of(name, mechanism)
    if motion is not None and designs:
        family = attempt(record, "family", lambda: mechanism.family(designs).sweep(threads=1))
        if family is not None:
            _add_family(record, family, motion)
    return record


def attempt(record: Record, section: str, call: Callable[[], T]) -> T | None:
    """The result of a call, or the reason why there is none; what is not ours is a crash."""
    begin, found = process_time(), None
    try:
        found = call()
    except lw.LinkworkError as error:
        record.say(f"{section}.error.type", [type(error).__name__])
        record.say(f"{section}.message.text", [error])
    except Exception as error:
        record.say(f"{section}.error.type", [f"crash: {type(error).__name__}"])
        record.say(f"{section}.message.text", [error])
    record.seconds[section] = process_time() - begin
    return found


def _add_motion(record: Record, motion: lw.Motion) -> None:
    columns = _columns(motion)
    record.say("sweep.names.column", columns)
    record.say("sweep.names.measure", _measures(motion, columns, motion.outputs))
    record.say("sweep.status.name", [status.name for status in motion.status])
    record.say("sweep.certified.flag", motion.certified.tolist())
    record.say("sweep.certified.reason", [reason.name for reason in motion.certification])
    record.say("sweep.rows.branch", motion.branch)
    record.say("sweep.rows.limit", motion.limit)
    record.say("sweep.rows.added", motion.added.tolist())
    record.note("sweep.coordinates.value", np.stack([motion[name] for name in columns], axis=-1))
    record.note("sweep.coordinates.condition", motion.condition)
    record.note("sweep.radii.value", motion.radius)
    _add_limits(record, "sweep", motion.limits)


def _columns(result: Any) -> list[str]:
    """Inputs, unknowns, links, sliders, coordinates, outputs of a motion or position; each once."""
    places = [f"{point}.{axis}" for point in result.points for axis in "xy"]
    inputs = result.inputs if hasattr(result, "inputs") else result.input
    tables = (inputs, result.unknowns, result.links, result.sliders, places, result.outputs)
    return list(dict.fromkeys(name for table in tables for name in table))


def _measures(result: Any, columns: Sequence[str], outputs: Iterable[str]) -> list[str]:
    """What every column measures: ``length``, ``number``, or the unit of an angle."""
    angle = result.units.angle.value
    inputs = result.input_units
    if hasattr(result, "value_units"):
        units = result.value_units
    else:
        units = {n: angle if result.series(n).quantity.kind.value == "angle" else ""
                 for n in columns if n not in inputs}  # fmt: skip
    units = {**units, **inputs}
    others = {name: "number" if name in outputs else "length" for name in columns}
    return [angle if units.get(name) == angle else others[name] for name in columns]


def _add_limits(record: Record, section: str, limits: Iterable[Limit]) -> None:
    limits = tuple(limits)
    record.say(f"{section}.limits.kind", [limit.kind.name for limit in limits])
    record.say(f"{section}.limits.located", [limit.located for limit in limits])
    record.say(f"{section}.limits.status", [limit.status.name for limit in limits])
    record.say(f"{section}.limits.loops", [", ".join(limit.loops) for limit in limits])
    record.note(f"{section}.limits.input", [limit.input for limit in limits])
    record.note(f"{section}.limits.input slack", [_width(limit) for limit in limits])


def _width(limit: Limit) -> float:
    low, high = limit.bracket
    return abs(high - low)


def _add_configurations(record: Record, found: lw.circuits.Configurations) -> None:
    record.say("configurations.names.all", found.names)
    record.say("configurations.complete.grade", [found.completeness.name])
    record.say("configurations.status.name", [position.status.name for position in found])
    proofs = [position.certificate for position in found]
    record.say("configurations.certified.flag", [proof.certified for proof in proofs])
    record.say("configurations.certified.reason", [p.certification.name for p in proofs])
    if len(found):
        columns = _columns(found[0])
        record.say("configurations.names.column", columns)
        measures = _measures(found[0], columns, found[0].outputs)
        record.say("configurations.names.measure", measures)
        values = [[position[name] for name in columns] for position in found]
        record.note("configurations.coordinates.value", values)
        record.note("configurations.coordinates.condition", [p.condition for p in found])


def _add_circuits(record: Record, found: lw.circuits.Circuits) -> None:
    limits = [[*circuit.dead_points, *circuit.change_points] for circuit in found]
    record.say("circuits.complete.grade", [found.completeness.name])
    record.say("circuits.circuits.name", [circuit.name for circuit in found])
    record.say("circuits.circuits.closed", [circuit.closed for circuit in found])
    record.say("circuits.circuits.end", [circuit.end.name for circuit in found])
    record.say("circuits.circuits.turns", [circuit.turns for circuit in found])
    record.say("circuits.circuits.turning", [dict(sorted(c.turning.items())) for c in found])
    record.say("circuits.certified.circuit", [circuit.certified for circuit in found])
    record.note("circuits.circuits.range", [circuit.input_range for circuit in found])
    slack = [max(map(_width, some), default=0.0) for some in limits]
    record.note("circuits.circuits.range slack", slack)
    branches = [(k, branch) for k, circuit in enumerate(found) for branch in circuit.branches]
    record.say("circuits.branches.name", [branch.name for _, branch in branches])
    record.say("circuits.branches.configuration", [b.configuration for _, b in branches])
    record.say("circuits.branches.end", [branch.end.name for _, branch in branches])
    record.say("circuits.certified.branch", [branch.certified for _, branch in branches])
    record.note("circuits.branches.range", [branch.input_range for _, branch in branches])
    record.note("circuits.branches.range slack", [slack[k] for k, _ in branches])
    _add_limits(record, "circuits", (limit for some in limits for limit in some))
    owners = [c.name for c, some in zip(found, limits, strict=True) for _ in some]
    record.say("circuits.limits.circuit", owners)


def _add_family(record: Record, family: Any, motion: lw.Motion) -> None:
    """Rows of all designs one after the other; the names are those of the mechanism's own sweep."""
    columns = [*motion.unknowns, *(f"{p}.{axis}" for p in motion.points for axis in "xy")]
    shape = family.status.shape
    record.say("family.names.column", columns)
    record.say("family.names.varied", family.dimensions)
    record.say("family.names.measure", _measures(motion, columns, motion.outputs))
    record.say("family.status.name", [lw.Status.of_code(c).name for c in family.status.flat])
    record.say("family.certified.flag", family.certified.ravel().tolist())
    reasons = [lw.Certification.of_code(c).name for c in family.certification.flat]
    record.say("family.certified.reason", reasons)
    values = [np.broadcast_to(family[name], shape).ravel() for name in columns]
    record.note("family.coordinates.value", np.stack(values, axis=-1))
    record.note("family.coordinates.condition", family.condition.ravel())
    record.note("family.rows.input", family.inputs)
    for end in ("lower", "upper"):
        record.say(f"family.limits.{end} kind", getattr(family.limits, f"{end}_kind").tolist())
        record.note(f"family.limits.{end}", getattr(family.limits, end))


# ------------------------------------------------------------------ all of them


def take(
    names: Sequence[str],
    processes: int,
    progress: Callable[[int, int], None] | None = None,
    make: Callable[[str], Record] = record_of,
) -> Snapshot:
    """Records of mechanisms by their names; ``make`` records one."""
    begin, records = perf_counter(), {}
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        for record in pool.map(make, names, chunksize=4):
            records[record.name] = record
            if progress is not None:
                progress(len(records), len(names))
    return Snapshot(records, perf_counter() - begin)


def save(snapshot: Snapshot, place: Path) -> Path:
    """Write a snapshot: to a file ``….npz``, or into a folder."""
    path = place if place.suffix == ".npz" else place / _FILE
    path.parent.mkdir(parents=True, exist_ok=True)
    pieces: list[Array] = [np.empty(0)]
    told, passed = [], 0
    for record in snapshot.records.values():
        places = {}
        for name, values in record.numbers.items():
            places[name] = [passed, *values.shape]
            pieces.append(values.ravel())
            passed += values.size
        words = {name: _runs(words) for name, words in record.words.items()}
        told.append([record.name, words, places, record.seconds])
    text = json.dumps({"seconds": snapshot.seconds, "records": told}, ensure_ascii=False)
    index = np.frombuffer(text.encode(), dtype=np.uint8)
    np.savez_compressed(path, index=index, numbers=np.concatenate(pieces))
    return path


def load(place: Path) -> Snapshot:
    """Read what :func:`save` wrote."""
    with np.load(place if place.is_file() else place / _FILE) as file:
        index, numbers = json.loads(file["index"].tobytes().decode()), file["numbers"]
    records = {}
    for name, words, places, seconds in index["records"]:
        record = Record(name, seconds=seconds)
        record.words = {path: _unrolled(runs) for path, runs in words.items()}
        for path, (begin, *shape) in places.items():
            size = int(np.prod(shape))
            record.numbers[path] = numbers[begin : begin + size].reshape(shape)
        records[name] = record
    return Snapshot(records, index["seconds"])


def _runs(words: Sequence[str]) -> list[tuple[str, int]]:
    return [(sys.intern(word), len(list(same))) for word, same in groupby(words)]


def _unrolled(runs: Iterable[tuple[str, int]]) -> list[str]:
    return [word for word, count in runs for _ in range(count)]
