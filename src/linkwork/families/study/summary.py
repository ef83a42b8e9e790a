"""The summary of a store: counts, ranges and histograms, also of an unfinished study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.files import as_path
from linkwork.families.study.packages import check_packages
from linkwork.families.study.store import attributes_of, open_arrays, read_chunks
from linkwork.families.study.study import passes_name

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
