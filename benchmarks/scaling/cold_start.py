"""A fresh process up to its first cycle of a four-bar, compiled code cached by earlier ones."""

from __future__ import annotations

import statistics
import subprocess
import sys
from functools import partial

from benchmarks.peers.registry import PEERS
from benchmarks.peers.work import four_bar
from benchmarks.scaling.part import Growth
from benchmarks.timing import interleaved

__all__ = ["cold_start"]


def cold_start(repeats: int) -> Growth:
    """Whole processes; the first line only imports NumPy and writes the mechanism down."""
    work = four_bar(361)
    able = [p for p in PEERS if not p.missing() and not p.cannot(work)]
    names = ["NumPy alone", *(peer.name for peer in able)]
    runs = [partial(_process, name) for name in names]
    times = interleaved(runs, repeats)
    base = statistics.median(times[0])
    medians = {name: statistics.median(t) for name, t in zip(names, times, strict=True)}
    return Growth(
        title="fresh process up to the first cycle of a four-bar, 361 rows",
        unit="ms",
        size="cycles",
        times={name: {1: 1e3 * median} for name, median in medians.items()},
        notes=[f"{name}: {median / base:.2f} × NumPy alone" for name, median in medians.items()],
    )


def _process(name: str) -> None:
    command = [sys.executable, "-m", "benchmarks.scaling.first_cycle", name]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
