"""Programs that are run, and compared with the motion that they compute again."""

from __future__ import annotations

import csv
import io
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind

__all__ = ["RUNNERS", "columns_of", "largest_differences"]

_TIME = 300  # seconds


def _command(file: Path) -> list[str]:
    """How a program is run; C is compiled first, with all warnings as errors."""
    match file.suffix:
        case ".py":
            return [sys.executable, str(file)]
        case ".js":
            return ["node", str(file)]
        case ".m":
            return ["octave-cli", "-q", "--path", str(file.parent), "--eval", file.stem]
    built = file.with_suffix("")
    flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror"]
    command = ["cc", *flags, str(file), "-o", str(built), "-lm"]
    subprocess.run(command, check=True, timeout=_TIME)
    return [str(built)]


_PROGRAMS = {".py": sys.executable, ".js": "node", ".c": "cc", ".m": "octave-cli"}
#: Suffixes of programs that this machine can run.
RUNNERS = {suffix for suffix, program in _PROGRAMS.items() if shutil.which(program)}


def columns_of(file: Path) -> tuple[dict[str, Array], list[str]]:
    """The columns that a program prints, (R,) each, and the statuses."""
    command = _command(file)
    done = subprocess.run(command, check=True, capture_output=True, timeout=_TIME)
    head, *rows = csv.reader(io.StringIO(done.stdout.decode("utf-8")))
    numbers = np.array([[float(x) for x in row[:-1]] for row in rows])
    return dict(zip(head[:-1], numbers.T, strict=True)), [row[-1] for row in rows]


def largest_differences(columns: dict[str, Array], motion: Motion) -> dict[str, float]:
    """By how much each column differs from the motion's, relative to its largest value.

    What is 0 in all rows is computed to rounding: the largest value of an angle counts as one
    radian at least, that of a length or coordinate as the largest of all of them.

    Derivatives are computed with the inverse of the Jacobian, and second ones with its square:
    their differences are divided by the condition of the row, or its square. Infinite where only
    one of the two has a position.
    """
    asked = {name: motion.quantity(name) for name in columns}
    lengths = [
        float(np.nanmax(np.abs(columns[name]), initial=0.0))
        for name, column in asked.items()
        if column.own.kind is Kind.LENGTH and column.rate is None
    ]
    longest = max(lengths, default=0.0) or 1.0
    found = {}
    for name, own in columns.items():
        right = np.asarray(motion[name])[motion.asked]
        order = {"d1": 1, "d2": 2}.get(name.rpartition(".")[2], 0)
        if (np.isnan(own) != np.isnan(right)).any():
            found[name] = np.inf
            continue
        kind, is_rate = asked[name].own.kind, asked[name].rate is not None
        least = 1.0 if is_rate else 1.0 / motion.units.scale(kind)
        least = longest if kind is Kind.LENGTH else least
        size = max(float(np.nanmax(np.abs(right), initial=0.0)), least)
        away = np.abs(own - right) / size / motion.condition[motion.asked] ** order
        found[name] = float(np.nanmax(away, initial=0.0))
    return found
