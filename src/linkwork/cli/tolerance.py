"""``linkwork tolerance``"""

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
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_text
from linkwork.cli.sensitivity_page import tolerance_data, tolerance_lines
from linkwork.cli.terminal import print_json, print_lines, progress
from linkwork.export import csv_lines
from linkwork.foundation.errors import InputError
from linkwork.results.sensitivity import SensitivityStatus

__all__ = ["tolerance"]


@click.command
@file_argument
@click.option(
    "--of",
    metavar="NAME",
    required=True,
    help="The quantity, or a number of the whole motion; `linkwork quantities FILE` lists them.",
)
@at_option
@configuration_option
@click.option("--samples", type=int, default=0, help="Solve this number of random designs too.")
@click.option("--seed", type=int, default=1, show_default=True, help="Of the random designs.")
@click.option("--csv", metavar="PATH", help="Write the contributions; - is standard output.")
@set_option
@json_option
@debug_option
@click.pass_context
def tolerance(
    context: click.Context,
    file: str,
    of: str,
    at: tuple[str, ...],
    configuration: str | None,
    samples: int,
    seed: int,
    csv: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute what deviations and clearances do to a quantity.

    Deviations stand in [tolerances] of the file, clearances of pins in
    [clearances]. Worst case, root sum square and shares are of first order.

    \b
      linkwork tolerance crank.toml --of d --at 60
      linkwork tolerance crank.toml --of "stroke(d)" --samples 10000
      linkwork tolerance crank.toml --of d --csv shares.csv
    """
    if as_json and csv == "-":
        raise InputError("--json and --csv - both use standard output: name a file for the table")
    check_outputs(file, csv)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    with progress("solving"):
        found = mechanism.tolerance(
            of, values, samples=samples, seed=seed, configuration=configuration
        )
    if csv == "-":
        for line in csv_lines(found.table()):
            click.echo(line, nl=False)
    elif csv is not None:
        write_text(csv, csv_lines(found.table()))
    if as_json:
        print_json(tolerance_data(found))
    elif csv != "-":
        written = ["", f"Wrote {csv}: {len(found.contributions)} rows."] if csv else []
        print_lines([*tolerance_lines(found), *written])
    if found.status is not SensitivityStatus.FOUND:
        context.exit(1)
