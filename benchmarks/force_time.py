"""Forces over a table, and motions in time beside Exudyn and a stabilised integrator."""

from __future__ import annotations

import time

import linkwork as lw
from benchmarks.motions.comparison import compare
from benchmarks.timing import bar, interleaved

__all__ = ["measure"]


def measure(repeats: int = 15) -> bool:
    """Limits: processor time over that of the certified sweep; over that of Exudyn, which may have
    a thousand times the error.
    """
    print("forces: processor time, one thread")
    held = _rows(repeats)
    return compare() and held


def _rows(repeats: int) -> bool:
    """All efforts and reactions of 361 four-bar rows."""
    bar_linkage = lw.example("four-bar").changed(
        masses={k: lw.Mass(mass=1.0, shape="rod") for k in ("crank", "coupler", "rocker")},
        gravity=lw.Gravity(),
        inputs=lw.Input(link="crank", from_=0, to=360, step=1, speed="60 rpm"),
    )
    for _ in range(10):  # from then on with kernels
        bar_linkage.sweep()
    motions = [bar_linkage.sweep() for _ in range(repeats + 1)]
    new = iter(motions)  # places of a motion are computed once
    sweep, alone, both = interleaved(
        [bar_linkage.sweep, lambda: bar_linkage.forces(motion=next(new)), bar_linkage.forces],
        repeats,
        time.process_time,
    )
    ratios = [b / a for a, b in zip(sweep, alone, strict=True)]
    held = bar("361 four-bar rows: all forces / certified sweep", ratios, 1.5)
    ratios = [b / a for a, b in zip(sweep, both, strict=True)]
    return bar("the same with the sweep in it / certified sweep", ratios, 2.0) and held
