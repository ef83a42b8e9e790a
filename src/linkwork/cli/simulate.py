"""``linkwork simulate``"""

from __future__ import annotations

from dataclasses import asdict

import click

from linkwork.api import Mechanism
from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    at_option,
    columns_option,
    debug_option,
    file_argument,
    input_values,
    json_option,
    number_or_formula,
    set_option,
    straight_option,
)
from linkwork.cli.output_file import check_outputs, write_table
from linkwork.cli.simulation_page import equilibria_lines, motion_data, simulation_lines
from linkwork.cli.terminal import print_json, print_lines, print_page, progress
from linkwork.foundation.errors import InputError
from linkwork.mechanism.dimensions import Number

__all__ = ["simulate"]


@click.command
@file_argument
@click.option("--until", type=float, metavar="SECONDS", help="The last time.")
@click.option("--step", type=float, metavar="SECONDS", help="Between rows; default 400 rows.")
@at_option
@click.option(
    "--start-speed",
    "start_speeds",
    metavar="[INPUT=]SPEED",
    multiple=True,
    help='Of the input: "60 rad/s", default 0; of several "left=60 rad/s", once for each.',
)
@straight_option
@click.option("--equilibria", is_flag=True, help="List the positions of rest, and no motion.")
@columns_option("Print, write and plot only this quantity.")
@click.option("--no-certificates", is_flag=True, help="Skip the proofs (faster).")
@click.option("--csv", metavar="PATH", help="Write the table of all rows; - is standard output.")
@click.option("--plot", metavar="PATH", help="Plot the quantities over time.")
@set_option
@json_option
@debug_option
@click.pass_context
def simulate(
    context: click.Context,
    file: str,
    until: float | None,
    step: float | None,
    at: tuple[str, ...],
    start_speeds: tuple[str, ...],
    change_points: str,
    equilibria: bool,
    names: tuple[str, ...],
    no_certificates: bool,
    csv: str | None,
    plot: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute the motion in time under masses, loads, springs and a motor.

    Inputs with a law follow it; the others are free: they start at the sketch, or at
    --at, with --start-speed.
    Rows are added where loads switch and where stops are hit.

    \b
      linkwork simulate pump.toml --until 2 --start-speed "60 rad/s"
      linkwork simulate pump.toml --until 2 --columns crank.velocity --plot v.png
      linkwork simulate pump.toml --until 2 --step 0.01 --csv -
      linkwork simulate lamp.toml --equilibria
    """
    if plot is not None:
        picture.check_picture(plot)
    check_outputs(file, csv, plot, as_json=as_json)
    mechanism = read_mechanism(file, changes)
    start = input_values(mechanism, at)
    if equilibria:
        if until is not None or csv is not None or plot is not None:
            raise InputError("--equilibria lists positions of rest: leave out --until and files")
        _list_equilibria(mechanism, start, change_points, as_json)
        return
    if until is None:
        raise InputError("--until is missing: the last time in seconds")
    speed = _start_speed(start_speeds)
    with progress("simulating") as tell:
        motion = mechanism.simulate(
            until,
            step=step,
            at=start,
            start_speed=speed,
            change_points=change_points,
            certify=not no_certificates,
            progress=tell,
        )
    table = motion.table(*names)
    written = write_table(csv, table)
    if plot is not None:
        shown = names or tuple(f"{name}.velocity" for name in _inputs(mechanism))
        written.append(picture.write_plot(motion, shown, plot, over="time"))
    if as_json:
        print_json(motion_data(motion, table))
    elif csv != "-":
        print_page(simulation_lines(motion, _inputs(mechanism), names), written)
    if not motion.found.all():
        context.exit(1)


def _start_speed(given: tuple[str, ...]) -> Number | dict[str, Number]:
    """The start speed of the only input, or those of several by name."""
    named = [text.partition("=") for text in given]
    if not any(equals for _, equals, _ in named):
        if len(given) > 1:
            raise InputError("--start-speed of several inputs: name each, --start-speed left=2")
        return number_or_formula(given[0]) if given else 0
    found: dict[str, Number] = {}
    for name, equals, value in named:
        if not equals or name.strip() in found:
            raise InputError(f"--start-speed {name}: name each input once, --start-speed left=2")
        found[name.strip()] = number_or_formula(value.strip())
    return found


def _inputs(mechanism: Mechanism) -> list[str]:
    return [each.column for each in mechanism.description.inputs]


def _list_equilibria(
    mechanism: Mechanism, start: dict[str, float] | None, change_points: str, as_json: bool
) -> None:
    with progress("looking for equilibria"):
        found = mechanism.equilibria(start, change_points=change_points)
    if as_json:
        print_json({"equilibria": [asdict(each) for each in found]})
    else:
        print_lines(equilibria_lines(mechanism, found))
