"""``linkwork export``"""

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
from linkwork.cli.terminal import print_json, print_lines, wrapped
from linkwork.exchange.formats import WRITERS

__all__ = ["export"]


@click.command
@file_argument
@click.option(
    "--as", "form", type=click.Choice(WRITERS), required=True, help="The format of the text."
)
@click.option("-o", "--output", metavar="PATH", help="Write to this file instead of the terminal.")
@at_option
@configuration_option
@set_option
@json_option
@debug_option
def export(
    file: str,
    form: str,
    output: str | None,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Write the mechanism as a text of another program.

    A link of PMKS+, JSON of pylinkage or an expression of Pyslvs, in the
    start position, --at. What is left out is listed on the error stream.

    \b
      linkwork export hoeken --as pmks
      linkwork export fourbar.toml --as pylinkage -o fourbar.json
    """
    check_outputs(file, output)
    mechanism = read_mechanism(file, changes)
    made = mechanism.exported(form, input_values(mechanism, at), configuration=configuration)
    if output is not None:
        write_text(output, [made.text])
    if as_json:
        notes = [{"what": own.what, "places": list(own.places)} for own in made.left_out]
        print_json({"text": made.text, "left_out": notes, "written": [output] if output else []})
        return
    click.echo(made.text if output is None else f"Wrote {output}.\n", nl=False)
    lines = [line for own in made.left_out for line in wrapped(f"left out: {own}", "", "  ")]
    if lines:
        print_lines(lines, err=True)
