"""Picture files of the commands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from linkwork import wings
from linkwork.core import drawing
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.options import (
    at_option,
    change_points_option,
    check_outputs,
    columns_option,
    configuration_option,
    file_argument,
    force_option,
    forces_of,
    input_values,
    range_options,
    read_mechanism,
    set_option,
    shown_source,
    through_option,
    write_bytes,
    write_table,
)
from linkwork.core.commands.solve import residual_measure
from linkwork.core.commands.terminal import (
    bad,
    debug_option,
    fields,
    json_option,
    print_json,
    print_lines,
    print_written,
    progress,
    sentence,
    table_lines,
    title_lines,
    wrapped,
)
from linkwork.core.foundation.arrays import Array, FrozenDict
from linkwork.core.foundation.statuses import Status
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.motion.solving import solve_round_start
from linkwork.core.results.listing import (
    evidence_fields,
    how_many,
    limit_fields,
    range_columns,
    range_text,
    short,
    status_fields,
)
from linkwork.core.results.motion import Motion, table_of
from linkwork.core.results.position import Position
from linkwork.core.results.tables import Table

_FURTHER = 4  # further positions drawn in a sweep: every fifth of a crank's turn


def check_points(mechanism: Mechanism) -> None:
    """Reject a mechanism without points before any computation.

    Raises
    ------
    InputError
        If the mechanism has no points.
    """
    if not mechanism.model.compiled.points.names:
        raise drawing.no_points(mechanism.name)


def write_plot(motion: Motion, names: Sequence[str], path: str, over: str = "the input") -> str:
    """Plot columns, or unknowns and outputs, if there are positions; returns a line about it."""
    if not motion.found.any():
        return f"Did not write {path}: there is no position to plot."
    with progress("drawing"):
        drawing.write(wings.use("writers.charts.plane").motion_plot(motion, names), path)
    return f"Wrote {path}: {', '.join(names) or 'unknowns and outputs'} over {over}."


def sweep_scene(position: Position, motion: Motion) -> drawing.Scene:
    """The start position of a sweep, faint further positions, its limits and the traced paths."""
    if not motion.found.any():
        return drawing.scene_of(position)
    return drawing.scene_of(position, motion, options=drawing.SceneOptions(further=_FURTHER))


# ----------------------------------------------------------------------
# A motion as a page of text: counts of positions, limits, evidence, ranges.


def motion_lines(
    motion: Motion, measure: str, columns: Sequence[str] = (), numbers: Sequence[str] = ()
) -> list[str]:
    """The summary of a motion; ``measure`` is printed after residuals.

    ``columns`` instead of unknowns, outputs and traced points; ``numbers`` of the whole motion.
    """
    head = f"{range_text(motion)}: {how_many(motion)}"
    lines = [*title_lines(motion.mechanism), *sentence(str, head)]
    pairs = [*status_fields(motion), *limit_fields(motion)]
    if motion.found.any():
        pairs += evidence_fields(motion, measure)
        pairs += _numbers(motion, numbers)
    lines += fields(pairs, {s.label: bad for s in motion.counts if not s.ok})
    ranges = table_lines(range_columns(motion, columns)) if motion.found.any() else []
    return [*lines, "", *ranges] if ranges else lines


def range_lines(
    motion: Motion, columns: Sequence[str], between: Mapping[str, Array] = FrozenDict()
) -> list[str]:
    """The smallest and largest values of columns, as in :func:`motion_lines`; ``between``: further
    values of inputs and columns.
    """
    ranges = range_columns(motion, columns, between=between) if motion.found.any() else []
    return table_lines(ranges)


def answers(motion: Motion, *, through: bool) -> bool:
    """Whether nothing that was asked for is missing.

    Around a whole circuit the inputs that it does not reach are an answer.
    """
    misses = {status for status in motion.counts if not status.ok}
    return not misses or (through and misses == {Status.OUT_OF_CIRCUIT})


def failure_line(motion: Motion) -> list[str]:
    """How many rows were not found, in one sentence."""
    missing = int((motion.asked & ~motion.found).sum())
    return sentence(bad, f"{missing} of {int(motion.asked.sum())} positions were not found")


def _numbers(motion: Motion, names: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Numbers of the whole motion with their units."""
    for name in names:
        unit = motion.quantities.find_of_motion(name).unit
        value = f"{short(motion.value(name))} {unit}".rstrip()
        yield name, f"{value}, of the rows" if motion.is_of_rows(name) else value


# ----------------------------------------------------------------------
# ``linkwork sweep``


@click.command("sweep")
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
def sweep_command(
    context: click.Context,
    file: str,
    from_: Number | None,
    to: Number | None,
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
            drawing.check_picture(name)
    check_outputs(file, csv, draw, plot, workbook=xlsx, as_json=as_json)
    if xlsx is not None:
        wings.use("writers.workbook.workbook").check_xlsxwriter()
    mechanism = read_mechanism(file, changes)
    if draw is not None:
        check_points(mechanism)
    columns, numbers = _split_names(mechanism, names)
    with progress("sweeping") as tell:
        motion = mechanism.sweep(
            from_=from_,
            to=to,
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
        written.append(write_plot(motion, columns, plot))
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


def _scene(mechanism: Mechanism, motion: Motion, configuration: str | None) -> drawing.Scene | None:
    """The picture of the motion; None if there is no start to draw."""
    start = mechanism.solve(configuration=configuration)
    if not start.status.ok:
        return None
    model = mechanism.model if configuration is None else mechanism.model.from_position(start)
    return sweep_scene(solve_round_start(model, motion, start), motion)


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
    motion: Motion, table: Table, page: drawing.Scene | None, csv: str | None, draw: str | None
) -> list[str]:
    """Write the requested files; returns one line about each."""
    said = write_table(csv, table)
    if draw is not None and page is not None:
        with progress("drawing"):
            drawing.write(page, draw)
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
        found = wings.use("writers.workbook.workbook").workbook_of(
            mechanism.model, motion, columns, tell
        )
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


# ----------------------------------------------------------------------
# ``linkwork draw``


@click.command("draw")
@file_argument
@click.option(
    "-o", "--output", metavar="PATH", required=True, help="Picture file: .png, .svg, .pdf or .tikz."
)
@at_option
@configuration_option
@set_option
@click.option("--vectors", is_flag=True, help="Draw the loop equations as vectors, head to tail.")
@click.option("--velocities", is_flag=True, help="Draw the velocities of the points.")
@click.option("--accelerations", is_flag=True, help="Draw the accelerations of the points.")
@force_option
@click.option("--centres", is_flag=True, help="Draw the instant centres of all pairs of links.")
@click.option(
    "--centrodes",
    "centrodes",
    metavar="LINK",
    multiple=True,
    help="Draw the fixed and the moving centrode of a link; may be repeated.",
)
@click.option(
    "--dimensions", is_flag=True, help="Draw dimension lines of lengths, radii and the input."
)
@click.option(
    "--trace",
    "traces",
    metavar="POINT",
    multiple=True,
    help="Draw the path of this point instead of those in the file's [trace]; may be repeated.",
)
@click.option("--speed", is_flag=True, help="Colour the paths by the points' speed.")
@click.option("--link-names", is_flag=True, help="Label the links with their names.")
@click.option(
    "--theme",
    type=click.Choice(("light", "dark")),
    default="light",
    help="Colours of the page: light (the default) or dark.",
)
@json_option
@debug_option
def draw_command(
    file: str,
    output: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    vectors: bool,
    traces: tuple[str, ...],
    forces: tuple[str, ...],
    theme: str,
    as_json: bool,
    **shown: Any,
) -> None:
    """Draw one position, with the paths of the traced points.

    \b
      linkwork draw rapier.toml -o rapier.png
      linkwork draw rapier.toml -o rapier.svg --at 120 --vectors
      linkwork draw fourbar.toml -o crossed.png --configuration crossed
      linkwork draw fourbar.toml -o load.svg --force "B=0,-981 N"
      linkwork draw fourbar.toml -o poles.pdf --centres --centrodes coupler
    """
    drawing.check_picture(output)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    if not vectors:
        check_points(mechanism)
    values = input_values(mechanism, at)
    options = drawing.SceneOptions(forces=forces_of(mechanism, forces), **shown)
    with progress("sweeping") as tell:
        scene = mechanism.scene(
            values,
            configuration=configuration,
            vectors=vectors,
            traces=traces or None,
            options=options,
            progress=tell,
        )
    with progress("drawing"):
        drawing.write(scene, output, theme=drawing.THEMES[theme])
    print_written(output, as_json)
