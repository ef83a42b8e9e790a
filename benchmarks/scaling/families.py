"""Time per position of families: of one design up to a hundred thousand, and by cores."""

from __future__ import annotations

import statistics
from functools import partial

from benchmarks.peers.linkwork_sweep import family_of
from benchmarks.peers.registry import chosen
from benchmarks.peers.work import four_bar_family
from benchmarks.scaling.part import Growth, grown
from benchmarks.timing import interleaved
from linkwork.core.foundation.loading import cores

__all__ = ["family_sizes", "threads"]

SIZES = (1, 10, 100, 1_000, 10_000, 100_000)
ROWS = 200
MANY = 50_000  # designs that cores share


def family_sizes(repeats: int) -> Growth:
    """Four-bars with 200 inputs each, one thread."""
    return grown(
        title=f"families of four-bars, {ROWS} inputs each",
        unit="ns per position",
        size="designs",
        works=[(size, four_bar_family(size, ROWS)) for size in SIZES],
        peers=chosen(["family", "compiled, certified", "Ensemble", "NumPy"]),
        repeats=repeats,
        most={"pylinkage Ensemble": 10_000, "NumPy dyads": 10_000},
    )


def threads(repeats: int) -> Growth:
    """Wall time with one thread, with two, and so on up to all cores."""
    family = family_of(four_bar_family(MANY, ROWS))
    most = cores()
    counts = sorted({1, most, *(2**k for k in range(1, 10) if 2**k < most)})
    times: dict[str, dict[int, float]] = {}
    for name, certify, compiled in (
        ("family", False, False),
        ("family, certified", True, False),
        ("compiled", False, True),
        ("compiled, certified", True, True),
    ):
        run = partial(family.sweep, certify=certify, specialised=compiled)
        runs = [partial(run, threads=count) for count in counts]
        found = interleaved(runs, repeats)
        times[name] = {
            count: 1e9 * statistics.median(own) / (MANY * ROWS)
            for count, own in zip(counts, found, strict=True)
        }
    return Growth(
        title=f"a family of {MANY:,} four-bars, {ROWS} inputs each, wall time",
        unit="ns per position",
        size="threads",
        times=times,
    )
