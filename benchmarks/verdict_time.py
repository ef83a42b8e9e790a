"""Verdicts on positions of every mechanism of the library against all of its circuits."""

from __future__ import annotations

import time
from collections import Counter
from functools import partial

import linkwork as lw
from benchmarks.timing import bar, seconds
from linkwork.families import compile_kernels
from tests.campaigns.library_defects import JudgedCase, judged_change, library_cases

__all__ = ["measure"]

_CASES = 24  # of a mechanism
_LIMIT = 50.0  # ms of processor time; docs/benchmarks.md gives the causes of longer ones


def measure(repeats: int = 2) -> bool:
    """Limits: milliseconds of the slowest verdict of each mechanism, with compiled code at hand."""
    compile_kernels()
    print("slowest verdict on positions of a mechanism [ms], and all of its circuits")
    held = True
    for number, name in enumerate(lw.examples()):
        mechanism = lw.example(name)
        cases = list(library_cases(mechanism, _CASES, number))
        if not cases:
            continue
        wrong, times = Counter[str](), []
        for case in cases:
            wrong["false"] += judged_change(mechanism, case) != case.change
            times.append(_best(mechanism, case, repeats))
        circuits = seconds(partial(_all_circuits, mechanism, cases[0].point), time.process_time)
        text = f"{name}: {wrong['false']} of {len(cases)} differ, circuits {1e3 * circuits:.0f} ms"
        held = bar(text, [1e3 * max(times)], _LIMIT) and held
    return held


def _best(mechanism: lw.Mechanism, case: JudgedCase, repeats: int) -> float:
    run = partial(judged_change, mechanism, case)
    return min(seconds(run, time.process_time) for _ in range(repeats))


def _all_circuits(mechanism: lw.Mechanism, point: str) -> None:
    """All circuits, with the places of a point along them."""
    for circuit in mechanism.circuits(certify=False):
        assert len(circuit.motion.trace(point))
