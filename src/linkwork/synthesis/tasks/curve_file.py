"""The curve of a task: points in a CSV file."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import MechanismError, Problem
from linkwork.core.foundation.rounding import EQUAL_ROWS
from linkwork.core.foundation.values import as_told
from linkwork.core.textfile.toml_text import bytes_of, text_of

_COLUMNS = ("x", "y", "input")
FEWEST = 5  # points of a curve
#: Powers of larger numbers are beyond floating point, and those of the inverse of smaller ones.
LARGEST = 1e12
_MOST = 2000  # points: beyond, a fit takes minutes and gains nothing


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A curve in file units.

    Parameters
    ----------
    points : tuple of (float, float)
        In order of travel [length].
    inputs : tuple of float
        Inputs at the points; none: free timing [file's angle unit].
    closed : str
        closed, open or partial; "": by the distance of the ends.
    file, text : str
        The file, as the task names it, and its text.
    lines : tuple of int
        The lines of the points in the file.
    note : str
        What a summary adds: which line repeats the first point of a closed curve, and is left out.
    """

    points: tuple[tuple[float, float], ...]
    inputs: tuple[float, ...] = ()
    closed: str = ""
    file: str = ""
    text: str = ""
    lines: tuple[int, ...] = ()
    note: str = ""


def read_curve(table: Mapping[str, Any], folder: Path | None, turn: float = 360.0) -> Curve:
    """The curve of a table of a task; a last point that repeats the first one of a closed curve
    counts once.

    ``turn``: in the unit of the inputs.

    Raises
    ------
    MechanismError
        With the line of the file that is no point.
    """
    name = table["file"]
    path = Path(name) if folder is None else folder / name
    text = text_of(bytes_of(path, str(path)), str(path))
    rows = _number_rows(text, str(path))
    timed = table.get("timing", "free") == "as given"
    if timed and any(len(row) < len(_COLUMNS) for _, row in rows):
        line = next(line for line, row in rows if len(row) < len(_COLUMNS))
        raise _problem(("curve", "timing"), f"needs a third column, input: line {line} has none")
    closed, note = table.get("closed", ""), ""
    if closed in ("", "closed") and _is_repeated([row for _, row in rows], timed, turn):
        line, _ = rows.pop()
        note = f'; line {line} of "{name}" repeats the first point, which counts once'
    if not FEWEST <= len(rows) <= _MOST:
        count = f"{len(rows)} point{'' if len(rows) == 1 else 's'}"
        message = f'"{name}" has {count}: a curve needs {FEWEST} to {_MOST}'
        raise _problem(("curve", "file"), message)
    if message := out_of_bounds(np.array([complex(row[0], row[1]) for _, row in rows])):
        raise _problem(("curve", "file"), f'"{name}" {message}')
    return Curve(
        points=tuple((row[0], row[1]) for _, row in rows),
        inputs=tuple(row[2] for _, row in rows) if timed else (),
        closed=closed,
        file=name,
        text=text,
        lines=tuple(line for line, _ in rows),
        note=note,
    )


def out_of_bounds(points: ComplexArray) -> str:
    """Why points (N,) are too large or too close to compute with, in words; "" if they are not.

    Points all at one place have another problem.
    """
    largest = np.abs([points.real, points.imag]).max(initial=0.0)
    if largest > LARGEST:
        return f"goes to {largest:g}, beyond ±{LARGEST:g}: choose a larger unit"
    size = max(np.ptp(points.real), np.ptp(points.imag))
    if 0.0 < size < 1.0 / LARGEST:
        return f"is {size:g} in size, less than {1.0 / LARGEST:g}: choose a smaller unit"
    return ""


def _is_repeated(rows: list[list[float]], timed: bool, turn: float) -> bool:
    """Whether the last row is the first one again, of timed ones a turn later."""
    if len(rows) < 2 or rows[-1][:2] != rows[0][:2]:
        return False
    return not timed or abs(abs(rows[-1][2] - rows[0][2]) - turn) <= EQUAL_ROWS * turn


def _number_rows(text: str, name: str) -> list[tuple[int, list[float]]]:
    """Rows of numbers with their lines; the first row may be a header, # begins a comment."""
    rows: list[tuple[int, list[float]]] = []
    for line, cells in enumerate(csv.reader(io.StringIO(text)), start=1):
        if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
            continue
        try:
            row = [float(cell) for cell in cells]
        except ValueError:
            if not rows and [cell.strip().lower() for cell in cells] in (
                list(_COLUMNS[:2]),
                list(_COLUMNS),
            ):
                continue
            shown, parted = as_told(",".join(cells)), ";" in cells[0] or "\t" in cells[0]
            message = f'line {line} of "{name}" holds {shown}: write numbers'
            message += ", with commas between them and points for decimals" * parted
            raise _problem(("curve", "file"), message) from None
        if not 2 <= len(row) <= len(_COLUMNS) or not all(map(math.isfinite, row)):
            message = f'line {line} of "{name}" is no point: give x, y and, if timed, input'
            raise _problem(("curve", "file"), message)
        rows.append((line, row))
    return rows


def _problem(key: tuple[str, ...], message: str) -> MechanismError:
    return MechanismError([Problem(key=key, message=message)], "the task")
