"""``linkwork sensitivity``"""

from __future__ import annotations

import click

from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    at_option,
    configuration_option,
    debug_option,
    file_argument,
    input_values,
    json_option,
    of_option,
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_table
from linkwork.cli.sensitivity_page import sensitivity_data, sensitivity_lines
from linkwork.cli.terminal import print_json, print_page, progress
from linkwork.design import is_of_motion
from linkwork.foundation.errors import InputError
from linkwork.results.sensitivity import SensitivityStatus

__all__ = ["sensitivity"]


@click.command
@file_argument
@of_option
@at_option
@configuration_option
@click.option(
    "--by",
    metavar="NAME",
    multiple=True,
    help="Only this number: a dimension, length, angle, coordinate or offset. Repeatable.",
)
@click.option("--csv", metavar="PATH", help="Write a table; - is standard output.")
@set_option
@json_option
@debug_option
@click.pass_context
def sensitivity(
    context: click.Context,
    file: str,
    of: str,
    at: tuple[str, ...],
    configuration: str | None,
    by: tuple[str, ...],
    csv: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute how much a quantity changes with each number of a mechanism.

    The derivatives are exact. With --at they belong to one position, else to
    every row of the table; a number of the whole motion has one by each number.

    \b
      linkwork sensitivity crank.toml --of d --at 60
      linkwork sensitivity crank.toml --of d.velocity --csv rows.csv
      linkwork sensitivity crank.toml --of "stroke(d)" --by "O2 A"
    """
    check_outputs(file, csv, as_json=as_json)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    motion = None
    if values is None and mechanism.description.inputs:
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
    elif values is not None and is_of_motion(of):
        raise InputError(f'"{of}" is a number of a whole motion: leave out --at')
    with progress("differentiating"):
        found = mechanism.sensitivity(
            of, values, by=by or None, configuration=configuration, motion=motion
        )
    written = write_table(csv, found.table())
    if as_json:
        print_json(sensitivity_data(found))
    elif csv != "-":
        print_page(sensitivity_lines(found), written)
    lost = (SensitivityStatus.NO_POSITION, SensitivityStatus.DEAD_POINT)
    if all(status in lost for status in found.statuses):
        context.exit(1)
