"""Four-bars fitted to timed points: Linkwork's fit, and the optimisers of pylinkage on them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import process_time

from benchmarks.peers.pylinkage_path import OPTIMISERS, PathFit, installed
from tests.campaigns.improvement import CURVES, Curve, solve_curve_task, squares

__all__ = ["measure"]

_TASKS = ("18 timed", "12 timed", "25 timed")
_WITHIN = 1.0001  # of the best known value


@dataclass(frozen=True, kw_only=True)
class _Result:
    """The best sum of squares of some runs, and their processor time."""

    best: float
    seconds: float
    runs: int = 1
    evaluations: int = 0


def measure() -> bool:
    """Limits: the best value known; the best sum of squares over that of each optimiser, which has
    as much processor time or more and is run again with other random numbers until then.
    """
    there = installed()
    told = f"pylinkage {there}" if there else "pylinkage is not installed (pip install pylinkage)"
    print(f"path tasks: sums of squares, processor time, ratios Linkwork / peer; {told}")
    held = True
    for curve in CURVES:
        if curve.name in _TASKS:
            held = _task(curve, bool(there)) and held
    return held


def _task(curve: Curve, with_peer: bool) -> bool:
    own = _linkwork(curve)
    held = own.best <= curve.best * _WITHIN
    print(
        f"  {curve.name}: Linkwork {own.best:.6g} in {own.seconds:.2f} s, "
        f"best known {curve.best:.6g}  {'ok' if held else 'MISSED'}",
        flush=True,
    )
    for name, optimise in OPTIMISERS.items() if with_peer else ():
        fit = PathFit(curve.points, math.radians(curve.step))
        best, runs, begin = math.inf, 0, process_time()
        while not runs or process_time() - begin < own.seconds:
            runs += 1
            best = min(best, fit.best(optimise(fit, runs)))
        peer = _Result(best=best, seconds=process_time() - begin, runs=runs, evaluations=fit.count)
        better = own.best <= peer.best
        held = held and better
        print(
            f"    {name:<26} {peer.best:.4g} in {peer.seconds:.2f} s, {runs} runs, "
            f"{peer.evaluations} evaluations: error {own.best / peer.best:.2g}, "
            f"time {own.seconds / peer.seconds:.2g}  {'ok' if better else 'MISSED'}",
            flush=True,
        )
    return held


def _linkwork(curve: Curve) -> _Result:
    solve_curve_task(curve, 8)  # imports
    begin = process_time()
    found = solve_curve_task(curve, curve.starts)
    seconds = process_time() - begin
    totals = [squares(design, curve.points) for design in found.of_loops if design.delivered]
    return _Result(best=min(totals, default=math.inf), seconds=seconds)
