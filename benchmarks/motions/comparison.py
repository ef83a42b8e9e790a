"""Every program on every motion, each in a process of its own, with limits for Linkwork."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib import util

from benchmarks.motions.cases import CASES, PROGRAMS
from benchmarks.single_thread import environment
from benchmarks.timing import bar

__all__ = ["compare"]

_PATIENCE = 30.0  # s of a program on one motion
_NEEDS = {"Exudyn": "exudyn", "Baumgarte": "scipy"}


def compare() -> bool:
    """Print processor times and errors; limits: Exudyn's time, and a thousandth of its error."""
    held = True
    for case in CASES:
        found = {}
        for program in PROGRAMS:
            answer = _run(case, program)
            if isinstance(answer, str):
                print(f"  {case:<12} {program:<10} {answer}")
                continue
            found[program] = answer
            seconds, error = answer
            took, unit = f"{seconds:7.3f} s", CASES[case].unit
            print(f"  {case:<12} {program:<10} {took}   error {error:.1e} {unit}")
        if "Linkwork" not in found:
            held = False
        elif "Exudyn" in found:
            (own, error), (other, its) = found["Linkwork"], found["Exudyn"]
            held = bar(f"{case}: time / Exudyn's", [own / other], 1.0) and held
            held = bar(f"{case}: error / Exudyn's", [error / its], 1e-3) and held
    return held


def _run(case: str, program: str) -> tuple[float, float] | str:
    """Processor time [s] and error, or why there is none."""
    needed = _NEEDS.get(program)
    if needed is not None and util.find_spec(needed) is None:
        return f"is not compared: {needed} is not installed"
    command = [sys.executable, "-m", "benchmarks.motions", case, program]
    try:
        done = subprocess.run(
            command, env=environment(), capture_output=True, text=True, timeout=_PATIENCE,
            check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"is stopped after {_PATIENCE:g} s"
    if done.returncode:
        said = done.stderr.strip().splitlines() or [f"exit code {done.returncode}"]
        return f"fails: {said[-1][:200]}"
    seconds, error = json.loads(done.stdout.splitlines()[-1])
    return seconds, error
