"""The summary of a store: counts, ranges and histograms, also of an unfinished study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.files import as_path
from linkwork.families.study.packages import check_packages
from linkwork.families.study.store import StoredChunk, attributes_of, open_arrays, read_chunks
from linkwork.families.study.study import passes_name

__all__ = ["OutputSummary", "Summary", "summary_of"]

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
    repaired : tuple of int or str
        Damaged chunks that the run has computed again, and metadata that it has written again.
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
    repaired: tuple[int | str, ...] = ()

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
    sound, damaged = read_chunks(path)
    entries = [entry for _, entry in sorted(sound.items())]
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
        damaged=tuple(sorted(damaged)),
    )


def _pieces(array: Any, entries: list[StoredChunk]) -> Iterator[AnyArray]:
    """The values of finished chunks, one at a time."""
    for entry in entries:
        yield array[entry.start : entry.stop]


def _values(name: str, arrays: Any, entries: list[StoredChunk]) -> Iterator[Array]:
    """The available values of an output in each chunk, of designs that passed."""
    for values, passed in zip(
        _pieces(arrays[name], entries), _pieces(arrays["passed"], entries), strict=True
    ):
        there = values[passed]
        yield there[np.isfinite(there)]


def _output(name: str, arrays: Any, entries: list[StoredChunk]) -> OutputSummary:
    count, total, least, most = 0, 0.0, np.inf, -np.inf
    # two passes, since the ends of the bins are known only after the first
    for values in _values(name, arrays, entries):
        count += values.size
        # chunk by chunk: the store may be larger than memory
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
