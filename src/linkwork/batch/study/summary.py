"""The summary of a store: counts, ranges and histograms, also of an unfinished study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.batch.study.chunk_manifest import Entry, read_entries
from linkwork.batch.study.job import passes_name
from linkwork.batch.study.store import attributes_of
from linkwork.batch.study.zarr_files import check_packages, open_arrays
from linkwork.foundation.arrays import AnyArray, Array

__all__ = ["OutputSummary", "Summary", "summary_of"]

_BINS = 12
_SAME_VALUE = 1e-12  # of their size: values that differ by less are one and the same


@dataclass(frozen=True, kw_only=True)
class OutputSummary:
    """The values of one output of the designs that passed.

    Parameters
    ----------
    name, unit : str
    count : int
        Of the values that there are.
    least, mean, most : float
        NaN where there are none.
    histogram : tuple of int
        How many lie in each of equal parts from ``least`` to ``most``; one part where all values
        are the same to rounding.
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
    """What is known of a study from its store.

    Parameters
    ----------
    name, mechanism : str
    designs, computed : int
        Designs of the plan, and those in the store.
    inputs : int
        Rows of each design.
    built, passed : int
        Designs that could be built, and those that passed every filter.
    filters : Mapping[str, (str, int)]
        By name: the condition, and the designs that pass it.
    rows : Mapping[str, int]
        Rows of designs that were built, by status.
    certified : int
        Rows that are proved.
    problems : Mapping[str, int]
        Why so many designs could not be built.
    outputs : tuple of OutputSummary
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

    def to_dict(self) -> dict[str, Any]:
        """As JSON would hold it."""
        return asdict(self)


def summary_of(store: Path | str) -> Summary:
    """The summary of a study's store, finished or not.

    Raises
    ------
    InputError
        If it is no store of a study.
    """
    path = Path(store)
    known = attributes_of(path)
    check_packages()
    identity = known["linkwork_identity"]
    entries = [entry for _, entry in sorted(read_entries(path).items())]
    arrays = open_arrays(path)
    rows: Counter[str] = Counter()
    problems: Counter[str] = Counter()
    for entry in entries:
        rows.update(entry.rows)
        problems.update(entry.problems)

    def total(name: str) -> int:
        return sum(int(values.sum()) for values in _pieces(arrays[name], entries))

    return Summary(
        name=known["title"],
        mechanism=known["mechanism_name"],
        designs=identity["count"],
        computed=sum(entry.stop - entry.start for entry in entries),
        inputs=identity["input"]["rows"],
        built=total("built"),
        passed=total("passed"),
        filters={
            name: (condition, total(passes_name(name)))
            for name, condition in identity["filters"].items()
        },
        rows=dict(rows.most_common()),
        certified=total("certified"),
        problems=dict(problems.most_common()),
        outputs=tuple(
            _output(name, arrays, entries) for name in (*identity["reductions"], *identity["keep"])
        ),
    )


def _pieces(array: Any, entries: list[Entry]) -> Iterator[AnyArray]:
    """The values of finished chunks, one at a time."""
    for entry in entries:
        yield array[entry.start : entry.stop]


def _values(name: str, arrays: Any, entries: list[Entry]) -> Iterator[Array]:
    """What there is of an output in each chunk, of designs that passed."""
    for values, passed in zip(
        _pieces(arrays[name], entries), _pieces(arrays["passed"], entries), strict=True
    ):
        there = values[passed]
        yield there[np.isfinite(there)]


def _output(name: str, arrays: Any, entries: list[Entry]) -> OutputSummary:
    count, total, least, most = 0, 0.0, np.inf, -np.inf
    # two passes, since the ends of the bins are known only after the first
    for values in _values(name, arrays, entries):
        count += values.size
        # one chunk after the other: the store may be larger than memory
        total += float(values.sum())
        least = min(least, float(values.min(initial=np.inf)))
        most = max(most, float(values.max(initial=-np.inf)))
    bins = np.zeros(_BINS, dtype=int)
    spread = count > 0 and most - least > _SAME_VALUE * max(abs(least), abs(most))
    if spread:
        for values in _values(name, arrays, entries):
            bins += np.histogram(values, _BINS, (least, most))[0]
    return OutputSummary(
        name=name,
        unit=arrays[name].attrs.get("units", ""),
        count=count,
        least=least if count else np.nan,
        mean=total / count if count else np.nan,
        most=most if count else np.nan,
        histogram=tuple(bins.tolist()) if spread else ((count,) if count else ()),
    )
