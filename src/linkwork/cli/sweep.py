"""``linkwork sweep``"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from linkwork.api import Mechanism
from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism, shown_source
from linkwork.cli.motion_page import answers, failure_line, motion_lines
from linkwork.cli.options import (
    change_points_option,
    columns_option,
    configuration_option,
    debug_option,
    file_argument,
    json_option,
    range_options,
    set_option,
    through_option,
)
from linkwork.cli.output_file import check_outputs, write_bytes, write_table
from linkwork.cli.position_page import residual_measure
from linkwork.cli.terminal import print_json, print_lines, progress, wrapped
from linkwork.drawing.scene import Scene
from linkwork.export import check_xlsxwriter, workbook_of
from linkwork.mechanism.dimensions import Number
from linkwork.motion import solve_round_start
from linkwork.results.motion import Motion
from linkwork.results.motion_table import table_of
from linkwork.results.table import Table

__all__ = ["sweep"]


@click.command
@file_argument
@range_options
@configuration_option
@through_option
@change_points_option
@click.option(
    "--limits-of",
    metavar="NAME",
    multiple=True,
    help="Locate the maxima and minima of NAME; may be repeated.",
)
@columns_option("Write and plot only this column; a number such as stroke(s16) is printed.")
@click.option("--no-certificates", is_flag=True, help="Skip the proofs (faster).")
@click.option("--csv", metavar="PATH", help="Write the table of all rows; - is standard output.")
@click.option("--xlsx", metavar="PATH", help="Write a workbook whose formulas solve the cycle.")
@click.option("--draw", metavar="PATH", help="Draw the motion as .png, .svg, .pdf or .tikz.")
@click.option("--plot", metavar="PATH", help="Plot unknowns and outputs over the input.")
@set_option
@json_option
@debug_option
@click.pass_context
def sweep(
    context: click.Context,
    file: str,
    start: Number | None,
    stop: Number | None,
    step: Number | None,
    configuration: str | None,
    through: bool,
    change_points: str,
    limits_of: tuple[str, ...],
    names: tuple[str, ...],
    no_certificates: bool,
    csv: str | None,
    xlsx: str | None,
    draw: str | None,
    plot: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Solve the whole cycle, following the branch of the initial guess.

    Prints a summary. Rows without a position stay in the table with the
    reason.

    \b
      linkwork sweep rapier.toml
      linkwork sweep rapier.toml --csv rapier.csv --draw rapier.png
      linkwork sweep rapier.toml --xlsx rapier.xlsx --plot curves.png
      linkwork sweep rapier.toml --from 90 --to 180 --step 0.5 --csv - | head
      linkwork sweep rapier.toml --through --limits-of s16
      linkwork sweep rapier.toml --columns s16.d1 --columns "stroke(s16)"
    """
    for name in (draw, plot):
        if name is not None:
            picture.check_picture(name)
    check_outputs(file, csv, draw, plot, workbook=xlsx, as_json=as_json)
    if xlsx is not None:
        check_xlsxwriter()
    mechanism = read_mechanism(file, changes)
    if draw is not None:
        picture.check_points(mechanism)
    columns, numbers = _split_names(mechanism, names)
    with progress("sweeping") as tell:
        motion = mechanism.sweep(
            start=start,
            stop=stop,
            step=step,
            configuration=configuration,
            through=through,
            change_points=change_points,
            limits_of=limits_of,
            certify=not no_certificates,
            progress=tell,
        )
    with progress("drawing"):
        page = None if draw is None else _scene(mechanism, motion, configuration)
    table = table_of(motion, *columns)
    written = _written(motion, table, page, csv, draw)
    if plot is not None:
        written.append(picture.write_plot(motion, columns, plot))
    if xlsx is not None:
        written += _written_workbook(mechanism, motion, columns, xlsx)
    if as_json:
        print_json(_data(motion, table, numbers))
    elif csv != "-":
        page_lines = motion_lines(motion, residual_measure(mechanism), columns, numbers)
        print_lines([*page_lines, "", *(written or _hint(file, motion))])
    if not motion.found.all():
        if as_json or csv == "-":
            print_lines(failure_line(motion), err=True)
        context.exit(0 if answers(motion, through=through) else 1)


def _scene(mechanism: Mechanism, motion: Motion, configuration: str | None) -> Scene | None:
    """The picture of the motion; None if there is no start to draw."""
    start = mechanism.solve(configuration=configuration)
    if not start.status.ok:
        return None
    model = mechanism.model if configuration is None else mechanism.model.from_position(start)
    return picture.sweep_scene(solve_round_start(model, motion, start), motion)


def _split_names(mechanism: Mechanism, names: tuple[str, ...]) -> tuple[list[str], list[str]]:
    """Split the requested names into columns and numbers of the whole motion; check both."""
    quantities = mechanism.model.quantities
    numbers = [name for name in names if "(" in name]
    columns = [name for name in names if name not in numbers]
    for name in numbers:
        quantities.find_of_motion(name)
    for name in columns:
        quantities.find(name).check_rate(mechanism.model.speed)
    return columns, numbers


def _written(
    motion: Motion, table: Table, page: Scene | None, csv: str | None, draw: str | None
) -> list[str]:
    """Write the requested files; returns one line about each."""
    said = write_table(csv, table)
    if draw is not None and page is not None:
        with progress("drawing"):
            picture.write(page, draw)
        moving = ", and the motion faintly" if motion.found.any() else ""
        said.append(f"Wrote {draw}: the start position{moving}.")
    elif draw is not None:
        said.append(f"Did not write {draw}: there is no position to draw.")
    return said


def _written_workbook(
    mechanism: Mechanism, motion: Motion, columns: list[str], path: str
) -> list[str]:
    """Write the workbook; returns lines about it and its values that do not recalculate."""
    with progress("writing the workbook") as tell:
        found = workbook_of(mechanism.model, motion, columns, tell)
    write_bytes(path, [found.content])
    rows = int(motion.asked.sum())
    said = [f"Wrote {path}: {rows} rows with formulas; edit a yellow cell to solve them again."]
    for notice in found.notices:
        said += wrapped(f"  {notice}.")
    return said


def _hint(file: str, motion: Motion) -> list[str]:
    """A suggestion of the next command."""
    if not motion.found.any():
        return wrapped(f"To see the iterations: linkwork solve {shown_source(file)} --show-steps")
    stem = "cycle" if shown_source(file) in ("-", "LINK") else Path(file).stem
    return wrapped(f"For the table add --csv {stem}.csv, for a picture --draw {stem}.png.")


def _data(motion: Motion, table: Table, numbers: list[str]) -> dict[str, Any]:
    values = {name: motion.value(name) for name in numbers}
    return {
        "mechanism": motion.mechanism,
        "units": dict(table.units),
        "columns": {name: column.tolist() for name, column in table.columns.items()},
        **({"numbers": values} if numbers else {}),
        "limits": [limit.to_dict() for limit in motion.limits],
        "output_limits": [asdict(extreme) for extreme in motion.output_limits],
        "circuit": None if motion.circuit is None else motion.circuit.name,
        **({} if motion.failure is None else {"failure": motion.failure.to_dict()}),
        "counts": {status.name: count for status, count in motion.counts.items()},
    }
