"""Tasks of nine random points, solved as a user solves them: losses, defects and time."""

from __future__ import annotations

import time
from collections import Counter
from functools import cache

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import normal_numbers
from linkwork.synthesis.task_objects import Task

__all__ = ["nine_point_campaign"]

_TRIPLES = 1442


@cache
def _warm_up() -> None:
    """Load the compiled code, which a process does once."""
    _task(0).solve()


def _task(part: int) -> Task:
    z = normal_numbers(np.random.default_rng([51, part]), 9)
    return Task.path(np.column_stack([z.real, z.imag]).tolist())


def nine_point_campaign(part: int) -> tuple[Counter[str], list[str]]:
    """One task; every lost triple is named, and a list called complete without all is false."""
    _warm_up()
    begin = time.process_time()
    found = _task(part).solve()
    spent = time.process_time() - begin
    lost = _TRIPLES - found.complex
    counts: Counter[str] = Counter(
        {
            "tasks": 1,
            "triples found": found.complex,
            "triples lost": lost,
            "tasks with all triples": lost == 0,
            "real triples": found.real,
            "proved triples": found.proved,
            "four-bars without defects": found.sound,
            "milliseconds of processor time": round(1e3 * spent),
        }
    )
    counts[f"tasks of {int(spent) + 1} processor seconds at most"] += 1
    if lost:
        counts[f"task {part} lost {lost}"] += 1
    wrong = lost and found.completeness.complete
    return counts, [f"task {part}: complete without {lost}"] if wrong else []
