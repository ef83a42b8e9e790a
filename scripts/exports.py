"""Programs, robots, plates, pictures, reports of all library mechanisms; see `scripts/exports`."""

from __future__ import annotations

import sys
import tempfile
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import click

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from scripts.plates import READERS as PLATES, compared_plates
from scripts.reports import READERS as REPORTS, read_report
from scripts.robots import LOADERS, compared_robot
from scripts.tex_pictures import compared_picture, has_latex
from tests.readers.round_trips import robot_round_trip, round_trip
from tests.writers.running import RUNNERS, columns_of, largest_differences

_SUFFIXES = (".py", ".js", ".c", ".m", ".st", ".tikz", *LOADERS, *PLATES, *REPORTS)
#: Formats that are read back: no other program is needed.
_BACK = ("pmks", "pylinkage", "pyslvs", "back.mjcf")


def _compared(name: str, suffix: str, folder: Path) -> str:
    """The largest differences of values and derivatives, or why there is no program."""
    if suffix in _BACK:
        back = robot_round_trip(name) if suffix == "back.mjcf" else round_trip(name, suffix)
        return back if isinstance(back, str) else f"{back.rows} rows, points {back.difference:.1e}"
    if suffix in REPORTS:
        return read_report(name, suffix, folder)
    if suffix in LOADERS:
        return compared_robot(name, suffix)
    if suffix in PLATES:
        return compared_plates(name, suffix)
    if suffix == ".tikz":
        return compared_picture(name, folder)
    mechanism, file = lw.example(name), folder / f"solver{suffix}"
    # its parser is slow; of several inputs no range can be replaced
    few = suffix == ".st" and len(mechanism.description.inputs) == 1
    motion = mechanism.sweep(from_=60, to=62, step=1) if few else mechanism.sweep()
    try:
        mechanism.write(file, motion=motion)
    except InputError as error:
        return f"refused: {str(error).partition(': ')[2]}"
    if suffix == ".st":
        return _parsed(file)
    columns, statuses = columns_of(file)
    same = [s == "found" for s in statuses] == motion.found[motion.asked].tolist()
    found = largest_differences(columns, motion)
    rates = {name: x for name, x in found.items() if name.endswith((".d1", ".d2"))}
    values = {name: x for name, x in found.items() if name not in rates}
    shown = (f"{max(part.values(), default=0.0):.1e}" for part in (values, rates))
    return f"{len(statuses)} rows, values {', derivatives '.join(shown)}" + (
        "" if same else " WRONG"
    )


def _parsed(file: Path) -> str:
    """Whether an independent parser, the package blark, reads a program."""
    parsed = import_module("blark.parse").parse_source_code(file.read_text("utf-8"))
    return "syntax right" if parsed.exception is None else f"SYNTAX {parsed.exception}"


def main() -> None:
    """Compare programs in the languages that this machine can run."""
    wanted = [x for x in sys.argv[1:] if x in _SUFFIXES + _BACK] or _SUFFIXES + _BACK
    names = [x for x in sys.argv[1:] if x not in _SUFFIXES + _BACK]
    names = names or [n for n in lw.examples() if lw.example(n).description.inputs]
    parser = {".st"} if find_spec("blark") else set[str]()
    parser |= {".tikz"} if has_latex() else set[str]()
    parser |= {
        suffix for suffix, package in (LOADERS | PLATES | REPORTS).items() if find_spec(package)
    }
    for suffix in wanted:
        if suffix not in RUNNERS | parser | set(_BACK):
            click.echo(f"{suffix}: SKIPPED, nothing here runs it")
            continue
        with tempfile.TemporaryDirectory() as folder:
            for name in names:
                click.echo(f"{suffix} {name:28s} {_compared(name, suffix, Path(folder))}")


if __name__ == "__main__":
    main()
