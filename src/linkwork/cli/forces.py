"""``linkwork forces``"""

from __future__ import annotations

from dataclasses import replace

import click

from linkwork.api import Mechanism
from linkwork.cli import picture
from linkwork.cli.forces_page import motion_forces_lines, position_forces_lines, reactions_data
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.motion_page import failure_line
from linkwork.cli.options import (
    at_option,
    columns_option,
    configuration_option,
    debug_option,
    file_argument,
    input_values,
    json_option,
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_table
from linkwork.cli.terminal import print_json, print_lines, print_page, progress
from linkwork.drawing.scene_options import SceneOptions
from linkwork.foundation.errors import InputError
from linkwork.results.reactions import ForceStatus
from linkwork.results.stall import Stall

__all__ = ["forces"]


@click.command
@file_argument
@at_option
@configuration_option
@columns_option("Print, write and plot only this quantity of forces.")
@click.option("--csv", metavar="PATH", help="Write the table of all rows; - is standard output.")
@click.option("--draw", metavar="PATH", help="Draw the forces at one position, as by draw.")
@click.option("--plot", metavar="PATH", help="Plot the efforts over the input.")
@set_option
@json_option
@debug_option
@click.pass_context
def forces(
    context: click.Context,
    file: str,
    at: tuple[str, ...],
    configuration: str | None,
    names: tuple[str, ...],
    csv: str | None,
    draw: str | None,
    plot: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute the efforts of the inputs and the reactions of all joints.

    Masses, gravity, loads and springs of the file load the mechanism. With a
    speed of the input masses have inertia; without one it is at rest.

    \b
      linkwork forces press.toml
      linkwork forces press.toml --at 60 --draw forces.png
      linkwork forces press.toml --columns crank.effort --plot torque.png
      linkwork forces press.toml --csv forces.csv
    """
    for name in (draw, plot):
        if name is not None:
            picture.check_picture(name)
    if at and plot is not None:
        raise InputError("--plot shows a whole motion: leave out --at")
    check_outputs(file, csv, draw, plot, as_json=as_json)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    moves = bool(mechanism.description.inputs)
    if plot is not None and not moves:
        raise InputError(f'"{mechanism.name}" has no input, so that --plot has no motion to show')
    motion = None
    stalls: tuple[Stall, ...] = ()
    if values is None and moves:
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
        found = mechanism.forces(motion=motion)
        if ForceStatus.SELF_LOCKING in found.statuses:
            with progress("locating stalls"):
                stalls = mechanism.stalls(motion=motion, configuration=configuration)
    else:
        found = mechanism.forces(values, configuration=configuration)
    table = found.table(*names)
    written = write_table(csv, table)
    if draw is not None:
        written.append(_drawn(mechanism, values, configuration, draw))
    if plot is not None and motion is not None:
        written.append(picture.write_plot(motion, names or found.efforts, plot))
    if as_json:
        print_json(reactions_data(found, table, stalls))
    elif csv != "-":
        page = (
            position_forces_lines(found, names)
            if motion is None
            else motion_forces_lines(found, motion, names, stalls)
        )
        print_page(page, written)
    if motion is not None and not motion.found.all():
        print_lines(failure_line(motion), err=True)
        context.exit(1)


def _drawn(
    mechanism: Mechanism, values: dict[str, float] | None, configuration: str | None, path: str
) -> str:
    """Draw one position with its forces; returns a line about it."""
    picture.check_points(mechanism)
    here = mechanism.solve(values, configuration=configuration)
    arrows = mechanism.forces(here.input, configuration=configuration).arrows
    options = replace(SceneOptions(), forces=arrows)
    with progress("drawing"):
        picture.write(mechanism.scene(values, configuration=configuration, options=options), path)
    return f"Wrote {path}: the forces of pins and loads."
