"""``linkwork plot``"""

from __future__ import annotations

from typing import Any

import click

from linkwork.api import Mechanism
from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.motion_page import answers, failure_line
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
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import print_lines, print_written, progress
from linkwork.drawing.charts.plotting import (
    CIRCUIT_KINDS,
    PlotKind,
    circuits_plot,
    motion_plot,
)
from linkwork.drawing.charts.theme import THEMES
from linkwork.drawing.theme import theme_named
from linkwork.foundation.errors import InputError
from linkwork.foundation.policy import ChangePointPolicy
from linkwork.results.circuits import Circuits

__all__ = ["plot"]


@click.command
@file_argument
@click.option(
    "-o", "--output", metavar="PATH", required=True, help="Picture file: .png, .svg, .pdf or .tikz."
)
@columns_option(
    "Column of the table to plot; a point for path and hodograph; a pin for transmission. "
    "Default: unknowns and outputs, traced points, all pins."
)
@click.option(
    "--kind",
    type=click.Choice([kind.value for kind in PlotKind]),
    default=PlotKind.CURVES.value,
    show_default=True,
    help="Kind of plot.",
)
@click.option("--against", metavar="NAME", default="", help="Plot over this column or over time.")
@click.option("--wrapped", is_flag=True, help="Reduce angles to one turn.")
@click.option(
    "--theme", type=click.Choice(list(THEMES)), default="light", show_default=True, help="Colours."
)
@range_options
@configuration_option
@through_option
@change_points_option
@set_option
@json_option
@debug_option
@click.pass_context
def plot(
    context: click.Context,
    /,
    file: str,
    output: str,
    names: tuple[str, ...],
    kind: str,
    against: str,
    wrapped: bool,
    theme: str,
    as_json: bool,
    changes: tuple[str, ...],
    **sweeping: Any,
) -> None:
    """Plot columns, paths, hodographs, transmission angles or circuits.

    \b
    curves        columns over the input, over time or over another column
    polar         columns as radii over the input angle
    path          paths of points in the plane
    hodograph     tips of the velocity and acceleration vectors of a point
    transmission  transmission angles with the band of 40 to 140 degrees
    circuits      unknowns over the input for every circuit, limits marked
    branches      as circuits, with one panel for each branch

    \b
      linkwork plot rapier.toml -o s16.png --columns s16 --columns s16.d1
      linkwork plot fourbar.toml -o time.svg --columns B.velocity --against time
      linkwork plot jansen.toml -o foot.png --kind hodograph --columns F
      linkwork plot rapier.toml -o quality.png --columns condition
    """
    picture.check_picture(output)
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    colours = theme_named(theme, THEMES)
    if kind in [which.value for which in CIRCUIT_KINDS]:
        found = _circuits(mechanism, kind, {"against": against, "wrapped": wrapped, **sweeping})
        with progress("drawing"):
            picture.write(circuits_plot(found, names, kind=kind), output, theme=colours)
        print_written(output, as_json)
        return
    with progress("sweeping") as tell:
        motion = mechanism.sweep(progress=tell, **sweeping)
    if motion.found.any():
        with progress("drawing"):
            chart = motion_plot(motion, names, kind=kind, against=against, wrapped=wrapped)
            picture.write(chart, output, theme=colours)
        print_written(output, as_json)
    if not motion.found.all():
        print_lines(failure_line(motion), err=True)
        context.exit(0 if answers(motion, through=sweeping["through"]) else 1)


def _circuits(mechanism: Mechanism, kind: str, options: dict[str, Any]) -> Circuits:
    """Find the circuits; reject options of a sweep, which have no effect on whole circuits."""
    options["change_points"] = options["change_points"] != ChangePointPolicy.STOP.value
    spelled = {"start": "from", "stop": "to"}
    ignored = [
        f"--{spelled.get(name, name).replace('_', '-')}"
        for name, value in options.items()
        if value not in ("", None, False)
    ]
    if ignored:
        raise InputError(
            f"--kind {kind} shows whole circuits: leave out {', '.join(sorted(ignored))}"
        )
    with progress("following circuits") as tell:
        return mechanism.circuits(progress=tell)
