"""Fair timing: interleaved repeats, medians, ratios; one line per figure with its bar."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence

__all__ = ["Clock", "bar", "interleaved", "seconds"]


Clock = Callable[[], float]


def seconds(run: Callable[[], object], clock: Clock = time.perf_counter) -> float:
    """Time of one call: wall time, unless another clock is given."""
    begin = clock()
    run()
    return clock() - begin


def interleaved(
    runs: Sequence[Callable[[], object]],
    repeats: int,
    clock: Clock = time.perf_counter,
    *,
    steady: bool = False,
) -> list[list[float]]:
    """Times of several calls measured in turn, A B A B …, after one warm-up of each.

    ``steady``: each measured call follows one of its own kind, as in work that goes on for long; a
    core that has slept through the call before needs a while to wake up.
    """
    for run in runs:
        run()
    times: list[list[float]] = [[] for _ in runs]
    for _ in range(repeats):
        for k, run in enumerate(runs):
            if steady:
                run()
            times[k].append(seconds(run, clock))
    return times


def bar(text: str, ratios: Sequence[float], limit: float) -> bool:
    """Print the median of ratios with its spread against a limit; tell whether it holds."""
    middle = statistics.median(ratios)
    held = middle <= limit
    low, high = (_ratio(ratio) for ratio in (min(ratios), max(ratios)))
    spread = f"  ({low} … {high})" if len(ratios) > 1 else ""
    print(f"  {text:<52} {_ratio(middle):>8}{spread}  bar {limit:g}  {'ok' if held else 'MISSED'}")
    return held


def _ratio(ratio: float) -> str:
    return f"{ratio:.3f}" if ratio >= 0.001 else f"{ratio:.1e}"
