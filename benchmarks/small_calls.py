"""Calls of a millisecond: one cycle, a few designs, circuits; and the call around the kernel."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

import linkwork as lw
from benchmarks.timing import bar, interleaved
from linkwork.families import Family, compile_kernels

__all__ = ["measure"]

_CYCLES = {"four-bar": 0.4, "jansen-leg": 0.8, "rapier-drive": 0.5}
_COLD = {"four-bar": 3.5, "stephenson-far-crank": 5.0, "jansen-leg": 12.0, "double-butterfly": 40.0}


def measure(repeats: int = 15) -> bool:
    """Limits: in 1,000 ``numpy.linalg.solve`` of 8×8 in the same run, with kernels loaded; cold
    circuits in whole processes that import NumPy.
    """
    print("small calls / 1,000 numpy.linalg.solve of 8x8")
    rng = np.random.default_rng(8)
    matrices, right = rng.normal(size=(1000, 8, 8)), rng.normal(size=(1000, 8))

    def reference() -> None:
        for matrix, vector in zip(matrices, right, strict=True):
            np.linalg.solve(matrix, vector)

    runs: list[tuple[str, Callable[[], object], float]] = []
    compile_kernels()
    for name, limit in _CYCLES.items():
        mechanism = lw.example(name)
        for _ in range(10):  # from then on with kernels
            mechanism.sweep()
        runs.append((f"{name}: 361 certified rows", mechanism.sweep, limit))
    four_bar = lw.example("four-bar")
    runs.append(("four-bar: circuits", four_bar.circuits, 1.5))
    prepared = _few_designs(four_bar, 12)
    runs.append(("12 designs x 61 rows, prepared", prepared.sweep, 0.15))
    lengths = dict(prepared.designs.dimensions)
    turn = _one_turn(four_bar)
    runs.append(("12 designs x 61 rows, made", lambda: turn.family(lengths).sweep(), 0.3))
    unit, *times = interleaved([reference, *(run for _, run, _ in runs)], repeats)
    held = True
    for (text, _, limit), own in zip(runs, times, strict=True):
        held = bar(text, [b / a for a, b in zip(unit, own, strict=True)], limit) and held
    return _cold_circuits(min(repeats, 7)) and held


def _few_designs(mechanism: lw.Mechanism, count: int) -> Family:
    lengths = np.random.default_rng(1).uniform(39.9, 40.1, count)
    return _one_turn(mechanism).family({"O2 A": lengths})


def _one_turn(mechanism: lw.Mechanism) -> lw.Mechanism:
    (own,) = mechanism.description.inputs
    return mechanism.changed(inputs=(replace(own, from_=0.0, to=360.0, step=6.0),))


def _cold_circuits(repeats: int) -> bool:
    """Whole processes with an empty cache of start sets."""
    held = True
    with tempfile.TemporaryDirectory() as folder:
        kept = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        environment = kept | {"PYTHONPYCACHEPREFIX": folder}

        def python(code: str) -> None:
            with tempfile.TemporaryDirectory() as empty:
                own = environment | {"LINKWORK_CACHE": empty}
                subprocess.run([sys.executable, "-c", code], check=True, env=own)

        for name, limit in _COLD.items():
            code = f"import linkwork as lw; lw.example({name!r}).circuits()"
            numpy_, cold = interleaved(
                [partial(python, "import numpy"), partial(python, code)], repeats
            )
            ratios = [b / a for a, b in zip(numpy_, cold, strict=True)]
            held = bar(f"{name}: cold circuits / import numpy", ratios, limit) and held
    return held
