"""Nine points: a task on all cores, and all cores of one process against a process for each."""

from __future__ import annotations

import multiprocessing
import os
import time
from functools import partial
from multiprocessing.synchronize import Barrier
from typing import Any

import numpy as np

import linkwork as lw
from benchmarks.timing import bar, seconds
from linkwork.core.foundation.loading import cores

__all__ = ["measure"]

_EACH = 8  # tasks of a process
_TASK = 3.0  # s of wall time, proofs and defects included
_SHARE = 0.9  # of the speed of processes side by side


def measure(repeats: int = 3) -> bool:
    """Limits: seconds of a task; the time of one process with all cores over that of processes
    side by side, each with one core and its share of the same tasks.
    """
    count = cores()
    number = _EACH * count
    print(f"nine random points, {number} tasks on {count} cores, with proofs and defects")
    _solve(0)
    tasks, ratios = [], []
    for _ in range(repeats):
        together = seconds(partial(_solve_all, range(number)))
        tasks.append(together / number)
        ratios.append(together / _side_by_side(count))
    held = bar("a task [s]", tasks, _TASK)
    return bar("all cores in one process / a process for each", ratios, 1.0 / _SHARE) and held


def _side_by_side(count: int) -> float:
    """Wall time of the same tasks, shared out to processes with one core each."""
    context = multiprocessing.get_context("spawn")
    with context.Manager() as manager:
        begin, times = context.Barrier(count), manager.list()
        processes = [
            context.Process(
                target=_alone, args=(core, range(k, _EACH * count, count), begin, times)
            )
            for k, core in enumerate(sorted(os.sched_getaffinity(0)))
        ]
        for process in processes:
            process.start()
        for process in processes:
            process.join()
        return float(max(times))


def _alone(core: int, numbers: range, begin: Barrier, times: Any) -> None:
    os.sched_setaffinity(0, {core})
    _solve(0)
    begin.wait()
    start = time.perf_counter()
    _solve_all(numbers)
    times.append(time.perf_counter() - start)


def _solve_all(numbers: range) -> None:
    for number in numbers:
        _solve(number)


def _solve(number: int) -> None:
    points = np.random.default_rng(number).uniform(-1.0, 1.0, (9, 2))
    lw.Task.path([tuple(map(float, point)) for point in points]).solve()
