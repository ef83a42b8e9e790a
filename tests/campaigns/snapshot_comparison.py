"""Two snapshots compared: words must be the same, numbers nearly so.

How near: 1e-12 of the mechanism's size, which is its largest coordinate; of an angle the larger of
itself and 1 rad; of other outputs their largest value. A position is known no better than rounding
times the condition of its equations, so that 4e-16 times the condition number of the row is added,
up to a thousandth of the size. Radii of proofs may differ by a factor of 2. Ranges and limits may
differ by their brackets, too: those say where a limit lies to rounding, or between which values it
was not located. Conditions, numbers of iterations and times are not compared, messages only on
request.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import zip_longest

import numpy as np
import numpy.typing as npt

from tests.campaigns.snapshot import Record, Snapshot

__all__ = ["Comparison", "Difference", "Tally", "compare"]

Array = npt.NDArray[np.float64]

_NEAR = 1e-12
_ROUNDING = 4e-16  # times the condition
_MOST = 1e-3  # of the size, whatever the condition
_LIMIT_OF_DESIGN = 1e-10  # ends of designs come without a bracket
_RADII = 2.0
#: Of numbers that are integrated, fitted or printed, relative to the largest of their column.
_SECTIONS = {"simulation": 1e-9, "synthesis": 1e-7, "page": 1e-6, "3mf": 1e-6, "stl": 1e-6}
_RADIAN = {"deg": 180.0 / np.pi, "rad": 1.0}
_SHOWN = 20


@dataclass(frozen=True)
class Difference:
    """One value that differs: whose, which, in which row, both values."""

    name: str
    path: str
    row: str
    before: str
    after: str

    def __str__(self) -> str:
        section, category, what = self.path.split(".")
        place = f"{self.name} | {section} {category}, {what}, {self.row}"
        return f"{place}: {self.before} | {self.after}"


@dataclass
class Tally:
    """How many values of a category were compared, how many differ, and the largest gaps.

    ``worst`` is relative to the size, ``share`` to what is allowed.
    """

    compared: int = 0
    differ: int = 0
    worst: float = 0.0
    share: float = 0.0


@dataclass
class Comparison:
    """What was compared by category, the first differences, and who is in one snapshot only."""

    tallies: dict[str, Tally] = field(default_factory=dict)
    first: list[Difference] = field(default_factory=list)
    names: set[str] = field(default_factory=set)
    common: int = 0
    only_before: list[str] = field(default_factory=list)
    only_after: list[str] = field(default_factory=list)

    @property
    def equal(self) -> bool:
        """Whether nothing differs, and there was something to compare.

        Random mechanisms of one snapshot only are no difference: it may be a larger one.
        """
        lone = [*self.only_before, *self.only_after]
        missing = any(name.startswith("library ") for name in lone)
        return not self.names and not missing and self.common > 0

    def add(self, name: str, path: str, compared: int, differing: list[Difference]) -> Tally:
        """Count values of one mechanism and path, and those that differ."""
        tally = self.tallies.setdefault(_category(path), Tally())
        tally.compared += compared
        tally.differ += len(differing)
        self.first += differing[: _SHOWN - len(self.first)]
        if differing:
            self.names.add(name)
        return tally

    def told(self) -> str:
        """A line for each category, then the first differences."""
        head = "worst gap, of the size | of what is allowed"
        lines = [f"{'':<28} {'compared':>10} {'differ':>7}  {head}"]
        for category, tally in sorted(self.tallies.items()):
            gap = f"  {tally.worst:.1e} | {tally.share:.1e}" if tally.share else ""
            lines.append(f"{category:<28} {tally.compared:>10} {tally.differ:>7}{gap}")
        lines.append(f"{self.common} mechanisms compared, {len(self.names)} differ")
        for word, names in (("first", self.only_before), ("second", self.only_after)):
            if names:
                lines.append(f"{len(names)} in the {word} snapshot only, as {', '.join(names[:3])}")
        if self.first:
            lines.append("mechanism | what: first snapshot | second snapshot")
        return "\n".join([*lines, *map(str, self.first)])


def compare(before: Snapshot, after: Snapshot, *, messages: bool = False) -> Comparison:
    """What differs between two snapshots, mechanism by mechanism."""
    found = Comparison()
    found.only_before = [name for name in before.records if name not in after.records]
    found.only_after = [name for name in after.records if name not in before.records]
    for name, record in before.records.items():
        if name in after.records:
            found.common += 1
            _compare_words(found, record, after.records[name], messages)
            _compare_numbers(found, record, after.records[name])
    return found


def _category(path: str) -> str:
    return path.rpartition(".")[0].replace(".", " ")


def _paths(one: dict[str, object], other: dict[str, object]) -> Iterator[str]:
    yield from dict.fromkeys([*one, *other])


def _compare_words(found: Comparison, before: Record, after: Record, messages: bool) -> None:
    for path in _paths({**before.words}, {**after.words}):
        if _category(path).endswith("message") and not messages:
            continue
        one, other = before.words.get(path, []), after.words.get(path, [])
        differing = []
        if one != other or (path in before.words) != (path in after.words):
            pairs = enumerate(zip_longest(one, other, fillvalue="nothing"))
            differing = [
                Difference(before.name, path, f"row {k}", a, b) for k, (a, b) in pairs if a != b
            ]
        found.add(before.name, path, max(len(one), len(other)), differing)


def _compare_numbers(found: Comparison, before: Record, after: Record) -> None:
    for path in _paths({**before.numbers}, {**after.numbers}):
        if path.endswith((" slack", ".condition")):
            continue
        one, other = before.numbers.get(path), after.numbers.get(path)
        if one is None or other is None or one.shape != other.shape:
            shapes = ["nothing" if x is None else f"shape {x.shape}" for x in (one, other)]
            found.add(before.name, path, 1, [Difference(before.name, path, "all rows", *shapes)])
            continue
        if path.endswith("radii.value"):
            allowed, size = np.fmax(one, other) / _RADII, np.ones_like(one)
        elif path.endswith("coordinates.value"):
            allowed, size = _allowed_coordinates(before, path, one)
        else:
            allowed, size = _allowed(before, path, one)
        gap = _gap(one, other)
        wrong = gap > allowed
        columns = before.words.get(f"{path.partition('.')[0]}.names.column", [])
        differing = [
            Difference(before.name, path, _row(at, columns), *map(_digits, (one[at], other[at])))
            for at in map(tuple, np.argwhere(wrong).tolist())
        ]
        tally = found.add(before.name, path, one.size, differing)
        tally.worst = max(tally.worst, float(np.max(gap / size, initial=0.0)))
        some = gap > 0.0
        tally.share = max(tally.share, float(np.max(gap[some] / allowed[some], initial=0.0)))


def _row(at: tuple[int, ...], columns: list[str]) -> str:
    """The row and, of a table of coordinates, the name of the column."""
    row, *column = at
    named = "".join(f", {columns[k] if k < len(columns) else k}" for k in column)
    return f"row {row}{named}"


def _digits(value: float) -> str:
    return f"{value:.17g}"


def _gap(one: Array, other: Array) -> Array:
    """Distances; 0 where neither has a number or both are the same infinity, ∞ where one has."""
    with np.errstate(invalid="ignore"):
        gap = np.where(one == other, 0.0, np.abs(one - other))
    gap[np.isnan(one) & np.isnan(other)] = 0.0
    return np.where(np.isnan(gap), np.inf, gap)


def _allowed(record: Record, path: str, values: Array) -> tuple[Array, Array]:
    """For ranges and limits, and what gaps are measured by."""
    size = np.fmax(1.0, np.where(np.isfinite(values), np.abs(values), 1.0))
    near = _LIMIT_OF_DESIGN if path.startswith("family.limits") else _NEAR
    if ".numbers." in path:
        near = max(_SECTIONS.get(path.partition(".")[0], _NEAR), _NEAR)
        size = np.fmax(
            size, np.max(np.where(np.isfinite(values), np.abs(values), 0.0), axis=0, initial=1.0)
        )
    slack = record.numbers.get(f"{path} slack", np.zeros(len(values)))
    slack = np.where(np.isfinite(slack), slack, 0.0)
    return near * size + slack.reshape(slack.shape + (1,) * (values.ndim - 1)), size


def _allowed_coordinates(record: Record, path: str, values: Array) -> tuple[Array, Array]:
    """For a table (rows, columns), every row with its condition."""
    section = path.partition(".")[0]
    condition = record.numbers[f"{section}.coordinates.condition"]
    size = _sizes(values, record.words[f"{section}.names.measure"])
    singular = _ROUNDING * np.nan_to_num(condition, nan=0.0, posinf=np.inf)
    return (_NEAR + np.minimum(singular, _MOST))[:, None] * size, size


def _sizes(values: Array, measures: list[str]) -> Array:
    """Of every value of a table: see the module's beginning."""
    known = np.where(np.isfinite(values), np.abs(values), 0.0)
    lengths = np.array([measure == "length" for measure in measures], dtype=bool)
    longest = float(np.max(known[:, lengths], initial=0.0)) or 1.0
    size = np.empty_like(values)
    for k, measure in enumerate(measures):
        if measure == "length":
            size[:, k] = longest
        elif measure == "number":
            size[:, k] = float(np.max(known[:, k], initial=0.0)) or 1.0
        else:
            size[:, k] = np.fmax(_RADIAN[measure], known[:, k])
    return size
