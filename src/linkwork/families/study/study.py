"""Conditions that a plan sets for the motion of a design, parsed from text.

Conditions are comparisons such as ``mu >= 40`` and ``stroke(rocker) <= 60``, or the words of
:data:`WORDS`. They are matched by patterns and never evaluated as code.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Mapping, Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.description import Description, Problems
from linkwork.core.mechanism.varied_numbers import number_named
from linkwork.core.motion.model import Model
from linkwork.core.motion.solving import as_described
from linkwork.core.results.quantities.registry import Call
from linkwork.families.family import Family, family_of
from linkwork.families.family_motion import FamilyMotion
from linkwork.families.sampling import (
    CHUNK,
    Distribution,
    Normal,
    Plan,
    Uniform,
    from_table,
    grid,
    latin_hypercube,
    random,
)

_COMPARISON = re.compile(r"(?P<left>[^<>=]+)(?P<sign>>=|<=|>|<)(?P<bound>[^<>=]+)")
_SIGNS: Mapping[str, Callable[[Array, float], BoolArray]] = {
    ">=": np.greater_equal,
    "<=": np.less_equal,
    ">": np.greater,
    "<": np.less,
}


class Measured:
    """The quantities of a motion, each computed once.

    Parameters
    ----------
    motion : FamilyMotion
        D designs over R rows.
    """

    def __init__(self, motion: FamilyMotion) -> None:
        self.motion = motion
        self._values: dict[str, Array] = {}

    def __getitem__(self, name: str) -> Array:
        """A quantity, (D, R), in file units."""
        if name not in self._values:
            self._values[name] = self.motion[name]
        return self._values[name]

    def value(self, name: str) -> Array:
        """A number of the whole motion, (D,): ``stroke(rocker)``."""
        asked = self.motion.quantities.find_of_motion(name)
        if asked.follows:
            return self.motion.value(name)
        return self.motion.number(asked, self[asked.of.name])


@dataclass(frozen=True)
class Comparison:
    """A number of a motion compared with a bound, in file units; false without found rows."""

    reduced: Call
    sign: str
    bound: float

    def __str__(self) -> str:
        return f"{self.reduced} {self.sign} {str(self.bound).removesuffix('.0')}"

    def holds(self, measured: Measured) -> BoolArray:
        """(D,)."""
        return _SIGNS[self.sign](measured.value(str(self.reduced)), self.bound)


@dataclass(frozen=True)
class Word:
    """A condition on the rows of a design; one of :data:`WORDS`."""

    word: str

    def __str__(self) -> str:
        return self.word

    def holds(self, measured: Measured) -> BoolArray:
        """(D,)."""
        return WORDS[self.word](measured.motion)


def _whole_cycle(motion: FamilyMotion) -> BoolArray:
    return np.asarray(motion.found.all(axis=1))


def _no_dead_point(motion: FamilyMotion) -> BoolArray:
    beyond = [Status.OUT_OF_REACH.code, Status.OUT_OF_CIRCUIT.code]
    stopped = np.isin(motion.status, beyond).any(axis=1)
    return np.asarray(motion.found.any(axis=1) & ~stopped)


def _certified(motion: FamilyMotion) -> BoolArray:
    return np.asarray(motion.certified.all(axis=1))


#: Conditions by name: all rows found; no row beyond a dead point; all rows proved.
WORDS: Mapping[str, Callable[[FamilyMotion], BoolArray]] = {
    "whole cycle": _whole_cycle,
    "no dead point": _no_dead_point,
    "certified": _certified,
}


Condition = Comparison | Word


def read_condition(text: str) -> Condition:
    """A condition from text: a word of :data:`WORDS`, or a comparison.

    A plain quantity is compared at every row found: ``mu >= 40`` is ``min(mu) >= 40``.

    Raises
    ------
    InputError
        If the text is not a condition.
    """
    folded = " ".join(text.split())
    if folded in WORDS:
        return Word(folded)
    parts = _COMPARISON.fullmatch(folded)
    if parts is None:
        known = ", ".join(f'"{word}"' for word in WORDS)
        raise InputError(
            f'must be {known} or a comparison such as "mu >= 40" or "stroke(rocker) <= 60", '
            f'got "{text}"'
        )
    left = parts["left"].strip()
    if "(" in left:
        call = Call.read(left)
    else:
        # a bound holds at every row if it holds at the worst one
        call = Call("min" if parts["sign"].startswith(">") else "max", left)
    return Comparison(call, parts["sign"], _number(parts["bound"].strip(), text))


def _number(text: str, whole: str) -> float:
    try:
        bound = float(text)
    except ValueError:
        bound = math.nan
    if not math.isfinite(bound):
        raise InputError(f'"{text}" in "{whole}" must be a number, as in "mu >= 40"')
    return bound


# ----------------------------------------------------------------------
# The designs of a study from the ``[dimensions]`` of its plan.


_RANGE = frozenset({"from", "to"})
_LEVELS = _RANGE | {"levels"}
_TRIANGLE = _RANGE | {"likeliest"}
_NORMAL = frozenset({"mean", "deviation"})

#: For each sampling: required values of a plan, and keys without effect.
_NEEDED = {
    "grid": ((), ("count", "seed", "table", "columns")),
    "random": (("count", "seed"), ("table", "columns")),
    "latin-hypercube": (("count", "seed"), ("table", "columns")),
    "table": (("table",), ("count", "seed")),
}
_WANTED = {
    "grid": "values: [40, 50, 60] or { from = 40, to = 60, levels = 3 }",
    "random": "a distribution: { from = 36, to = 44 }, { mean = 40, deviation = 0.1 }, "
    "{ from = 36, to = 44, likeliest = 41 }, or equally likely values: [40, 50, 60]",
    "latin-hypercube": "a range: { from = 36, to = 44 }",
    "table": "one number for all designs: varied numbers are in the table",
}
_DOES = {
    "grid": "a grid is every combination of its values",
    "random": "random designs are drawn",
    "latin-hypercube": "random designs are drawn",
    "table": "designs are listed in the table",
}


def choose_values(
    content: Mapping[str, Any], folder: Path, problems: Problems
) -> tuple[Plan, Mapping[str, float]] | None:
    """The varied and the constant numbers; ``None`` after problems.

    Parameters
    ----------
    content : Mapping
        A plan of checked structure.
    folder : Path
        The folder of the table.
    """
    before = len(problems)
    sampling = content["sampling"]
    needed, useless = _NEEDED[sampling]
    for key in needed:
        if key not in content:
            problems.add((key,), f'is missing: sampling = "{sampling}" needs it')
    for key in useless:
        if key in content:
            problems.add((key,), f"has no effect: {_DOES[sampling]}; leave it out")
    given = content.get("dimensions", {})
    constants = {name: float(entry) for name, entry in given.items() if _is_number(entry)}
    varied = {name: entry for name, entry in given.items() if name not in constants}
    read = {
        "grid": _levels,
        "random": read_distribution,
        "latin-hypercube": _range,
        "table": _nothing,
    }[sampling]
    found = {name: _read(name, entry, sampling, read, problems) for name, entry in varied.items()}
    if not varied and sampling != "table":
        problems.add(("dimensions",), f"is empty: give {_WANTED[sampling]}")
    # only valid dimensions reach the plan, whose errors would repeat those reported
    if len(problems) > before:
        return None
    try:
        plan = _plan(content, folder, found)
    except InputError as error:
        problems.add(("table",) if sampling == "table" else ("dimensions",), str(error))
        return None
    for name in set(plan) & set(constants):
        problems.add(("dimensions", name), "is a column of the table too: leave one out")
    if not plan.count:
        problems.add(("table",), "has no rows: a study needs at least one design")
    return None if len(problems) > before else (plan, constants)


def values_between(plan: Plan, start: int, stop: int) -> dict[str, Array]:
    """The designs from ``start`` to ``stop`` (excluded), (stop - start,) each."""
    pieces = [
        {
            # random values are drawn in chunks of fixed size, so that a design does not depend on
            # the chunks of the study
            name: values[max(start - k * CHUNK, 0) : stop - k * CHUNK]
            for name, values in _chunk_of(plan, k).items()
        }
        for k in range(start // CHUNK, -(-stop // CHUNK))
    ]
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in plan}


@lru_cache(maxsize=2)
def _chunk_of(plan: Plan, k: int) -> Mapping[str, Array]:
    """A chunk of a plan, cached: several of the smaller chunks of a study use it."""
    return plan.chunk(k)


def _plan(content: Mapping[str, Any], folder: Path, found: Mapping[str, Any]) -> Plan:
    match content["sampling"]:
        case "grid":
            return grid(found)
        case "random":
            return random(content["count"], found, content["seed"])
        case "latin-hypercube":
            return latin_hypercube(content["count"], found, content["seed"])
        case _:
            return from_table(folder / content["table"], content.get("columns"))


def _read(
    name: str,
    entry: Any,
    sampling: str,
    read: Callable[[Any], Any],
    problems: Problems,
) -> Any:
    """The distribution or values of one dimension; ``None`` after a problem."""
    key = ("dimensions", name)
    try:
        found = read(entry)
    except InputError as error:
        problems.add(key, str(error))
        return None
    if found is None:
        got = "a list" if isinstance(entry, list) else ", ".join(entry) or "an empty table"
        problems.add(key, f'sampling = "{sampling}" needs {_WANTED[sampling]}; got {got}')
    return found


def _is_number(entry: Any) -> bool:
    return isinstance(entry, int | float)


def _ends(entry: Mapping[str, float]) -> tuple[float, float]:
    low, high = float(entry["from"]), float(entry["to"])
    if low > high:
        raise InputError(f"from = {low:g} must not be larger than to = {high:g}")
    return low, high


def _levels(entry: Any) -> Array | None:
    if isinstance(entry, list):
        return np.array(entry, dtype=float)
    if set(entry) != _LEVELS:
        return None
    # NumPy would silently keep the lower end only
    if entry["levels"] == 1 and entry["from"] != entry["to"]:
        raise InputError("levels = 1 cannot include both ends of the range: use two or more levels")
    low, high = _ends(entry)
    return np.linspace(low, high, entry["levels"])


def read_distribution(entry: Any) -> Distribution | None:
    """What an entry of random designs is drawn from; ``None`` if it is none of these."""
    if isinstance(entry, list):
        values = np.array(entry, dtype=float)
        return lambda generator, count: values[generator.integers(len(values), size=count)]
    if set(entry) == _RANGE:
        return Uniform(*_ends(entry))
    if set(entry) == _TRIANGLE:
        low, peak, high = (float(entry[key]) for key in ("from", "likeliest", "to"))
        if not low <= peak <= high or low == high:
            raise InputError(
                "a triangle needs from <= likeliest <= to and from < to, "
                f"got {low:g}, {peak:g}, {high:g}"
            )
        return lambda generator, count: generator.triangular(low, peak, high, count)
    if set(entry) == _NORMAL:
        return Normal(float(entry["mean"]), float(entry["deviation"]))
    return None


def _range(entry: Any) -> tuple[float, float] | None:
    return _ends(entry) if not isinstance(entry, list) and set(entry) == _RANGE else None


def _nothing(entry: Any) -> None:
    return None


# ----------------------------------------------------------------------
# The task of a worker: solve some designs and return the values to store.


_MOST_PROBLEMS = 20  # distinct reasons recorded for one part
_FURTHER = "further reasons"


def linkwork_version() -> str:
    """The running version of Linkwork."""
    try:
        return version("linkwork")
    except PackageNotFoundError:  # a source tree that is not installed
        return "unknown"


def passes_name(condition: str) -> str:
    """The name of the array of a filter's results."""
    return f"passes.{condition}"


@dataclass(frozen=True, kw_only=True)
class Job:
    """The computation for every design; sent to workers.

    Parameters
    ----------
    description : Description
        The mechanism, with the study's range of its input.
    keep : tuple of str
        Quantities at every row.
    reductions : Mapping[str, Call]
        One number per design, by the name of its array.
    filters : Mapping[str, Condition]
        Conditions on a design, by name.
    certify : bool
    device : str
        ``"cpu"`` or ``"gpu"``; every worker needs this device.
    version : str
        Version of Linkwork; a worker with another version rejects the job.
    """

    description: Description
    keep: tuple[str, ...]
    reductions: Mapping[str, Call]
    filters: Mapping[str, Condition]
    certify: bool
    device: str
    version: str


@dataclass(frozen=True, kw_only=True)
class Part:
    """The results of D consecutive designs.

    Parameters
    ----------
    arrays : Mapping[str, (D,) or (D, R)]
        By the names of the store's arrays.
    rows : Mapping[str, int]
        Number of rows by status, of designs that could be built.
    problems : Mapping[str, int]
        Number of designs that could not be built, by reason.
    """

    arrays: Mapping[str, AnyArray]
    rows: Mapping[str, int]
    problems: Mapping[str, int]


def compute_part(job: Job, values: Mapping[str, Array | float]) -> Part:
    """Compute the results of some designs.

    Parameters
    ----------
    values : Mapping[str, (D,) or number]
        The varied numbers, in file units.

    Raises
    ------
    InputError
        If the version of Linkwork differs from that of the main process.
    """
    # results of two versions may differ by rounding: a store must not mix them
    if job.version != linkwork_version():
        raise InputError(
            f"the study was started with Linkwork {job.version}, a worker has "
            f"{linkwork_version()}: install the same version everywhere"
        )
    family = family_of(_model(job.description), values)
    built = family.designs.problem == 0
    # one thread, since the processes of a study already share the cores
    motion = family.sweep(certify=job.certify, threads=1, device=job.device)
    measured = Measured(motion)
    passes = {name: built & condition.holds(measured) for name, condition in job.filters.items()}
    passed = np.logical_and.reduce([built, *passes.values()])
    arrays: dict[str, AnyArray] = {
        "built": built,
        "found": motion.found.sum(axis=1, dtype=np.int32),
        "certified": motion.certified.sum(axis=1, dtype=np.int32),
        "passed": passed,
    }
    arrays |= {passes_name(name): values for name, values in passes.items()}
    arrays |= {name: measured.value(str(call)) for name, call in job.reductions.items()}
    for name in job.keep:
        # designs that do not pass are left out, so that the store compresses
        arrays[name] = np.where(passed[:, None], measured[name], np.nan)
    if job.keep:
        arrays["status"] = motion.status
    return Part(arrays=arrays, rows=_rows(motion.status[built]), problems=_problems(family))


# a worker computes many parts of one study, and building a model takes long
@lru_cache(maxsize=2)
def _model(description: Description) -> Model:
    return as_described(description)


def _rows(status: AnyArray) -> dict[str, int]:
    """Rows by status, in the order of codes."""
    codes, numbers = np.unique(status, return_counts=True)
    pairs = zip(codes.tolist(), numbers.tolist(), strict=True)
    return {Status.of_code(code).name: number for code, number in pairs}


def _problems(family: Family) -> dict[str, int]:
    """Designs that cannot be built by reason, the most frequent first."""
    designs = family.designs
    numbers = designs.problem[designs.problem > 0]
    counts = Counter(designs.problems[int(number)] for number in numbers)
    # ties by name, so that the order does not depend on the chunks
    ordered = sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))
    kept = dict(ordered[:_MOST_PROBLEMS])
    rest = sum(count for _, count in ordered[_MOST_PROBLEMS:])
    return {**kept, **({_FURTHER: rest} if rest else {})}


# ----------------------------------------------------------------------
# A study: mechanism, designs, kept quantities and storage.


#: The axis of designs.
DESIGN = "design"

_LARGEST_CHUNK = 16_384
_SMALLEST_CHUNK = 2048
_CHUNK_BYTES = 64 << 20  # target size of the arrays of one chunk
_CHUNKS_WANTED = 16  # chunks of a small study, for several workers


@dataclass(frozen=True)
class Variable:
    """An array of the store: over designs, over designs and inputs, or over inputs alone.

    ``fill`` marks values not computed; ``values`` are known in advance.
    """

    name: str
    axes: tuple[str, ...]
    attributes: Mapping[str, Any]
    dtype: str = "float64"
    fill: Any = np.nan
    values: Array | None = None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Study:
    """A study as planned; made by :func:`~linkwork.families.study.read_plan`.

    Parameters
    ----------
    name : str
    text : str
        The text of the plan.
    mechanism_text : str
        The text of the mechanism's file.
    model : Model
        The mechanism with the study's range of its input.
    plan : Plan
        The plan of the varied numbers.
    constants : Mapping[str, float]
        Changed numbers that are the same for all designs.
    job : Job
        The computation for every design.
    units : Mapping[str, str]
        Units of stored quantities and numbers of motions, by array name.
    chunk_size : int
        Number of designs computed and stored together.
    identity : Mapping[str, object]
        All data on which results depend, with the keys of the plan, in JSON types.
    """

    name: str
    text: str
    mechanism_text: str
    model: Model
    plan: Plan
    constants: Mapping[str, float]
    job: Job
    units: Mapping[str, str]
    chunk_size: int
    identity: Mapping[str, Any]

    def __repr__(self) -> str:
        return (
            f'<Study "{self.name}" of "{self.job.description.name}": {self.plan.count} designs × '
            f"{len(self.model.rows_in_file_units)} inputs in {self.chunks} chunks>"
        )

    @property
    def chunks(self) -> int:
        """The number of chunks; the last one may be smaller."""
        # rounded up
        return -(-self.plan.count // self.chunk_size)

    def designs_of(self, k: int) -> range:
        """The designs of a chunk."""
        start = k * self.chunk_size
        return range(start, min(start + self.chunk_size, self.plan.count))

    def count_in(self, chunks: AbstractSet[int]) -> int:
        """The number of designs in some chunks."""
        count = len(chunks) * self.chunk_size
        if self.chunks - 1 in chunks:  # the last one may be smaller
            count -= self.chunks * self.chunk_size - self.plan.count
        return count

    def varied(self, k: int) -> dict[str, Array]:
        """The varied numbers of a chunk, in file units, (designs,) each."""
        designs = self.designs_of(k)
        return values_between(self.plan, designs.start, designs.stop)

    def values(self, k: int) -> Mapping[str, Array | float]:
        """All changed numbers of a chunk: the varied ones and the constants."""
        return {**self.varied(k), **self.constants}

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs; the first one is the axis of rows."""
        return tuple(variable.name for variable in self.model.equations.inputs)

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """Every array of the store."""
        one, lead = (DESIGN,), self.inputs[:1]
        inputs = zip(self.inputs, self.model.rows_in_file_units.T, strict=True)
        units = self.model.input_units
        found = [Variable(x, lead, _about(units[x]), values=values) for x, values in inputs]
        found += [Variable(name, one, _about(self._unit_of_number(name))) for name in self.plan]
        truths = {
            "built": "whether the design can be built",
            "passed": "built, and passed every filter",
            **{passes_name(name): str(x) for name, x in self.job.filters.items()},
        }
        counts = {"found": "rows with a position", "certified": "rows that are proved"}
        found += [Variable(name, one, _about("", x), "bool", False) for name, x in truths.items()]
        found += [Variable(name, one, _about("", x), "int32", -1) for name, x in counts.items()]
        found += [
            Variable(name, one, _about(self.units[name], str(reduced)))
            for name, reduced in self.job.reductions.items()
        ]
        if not self.job.keep:
            return tuple(found)
        axes = (DESIGN, *lead)
        note = "missing where there is no position or the design did not pass"
        found += [Variable(name, axes, _about(self.units[name], note)) for name in self.job.keep]
        codes = {
            "flag_values": [status.code for status in Status],
            "flag_meanings": " ".join(status.name for status in Status),
        }
        return (*found, Variable("status", axes, codes, "int8", -1))

    def _unit_of_number(self, name: str) -> str:
        table = number_named(self.job.description, name).table
        if table in ("lengths", "points", "sliders"):
            return self.job.description.length
        return self.job.description.angle.value if table == "angles" else ""


def _about(unit: str, description: str = "") -> dict[str, str]:
    """The attributes of an array."""
    return ({"units": unit} if unit else {}) | ({"description": description} if description else {})


def usual_chunk(count: int, rows: int, columns: int) -> int:
    """The default number of designs computed together.

    Parameters
    ----------
    count : int
        Number of designs of the study.
    rows, columns : int
        Size of the arrays of one design: numbers of rows and of quantities.
    """
    # 8 bytes for each float64
    fitting = max(_CHUNK_BYTES // (8 * rows * columns), 1)
    shared = max(-(-count // _CHUNKS_WANTED), _SMALLEST_CHUNK)
    # a power of two: chunks fill the lanes of the kernels exactly
    return 1 << (min(fitting, shared, _LARGEST_CHUNK).bit_length() - 1)
