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
    of_option,
    set_option,
)
from linkwork.cli.output_file import check_outputs, write_table
from linkwork.cli.sensitivity_page import tolerance_data, tolerance_lines
from linkwork.cli.terminal import print_json, print_page, progress
from linkwork.results.sensitivity import SensitivityStatus

__all__ = ["tolerance"]


@click.command
@file_argument
@of_option
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
    check_outputs(file, csv, as_json=as_json)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    with progress("solving"):
        found = mechanism.tolerance(
            of, values, samples=samples, seed=seed, configuration=configuration
        )
    written = write_table(csv, found.table())
    if as_json:
        print_json(tolerance_data(found))
    elif csv != "-":
        print_page(tolerance_lines(found), written)
    if found.status is not SensitivityStatus.FOUND:
        context.exit(1)
