"""``linkwork report``"""

from __future__ import annotations

from pathlib import Path

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
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import print_written, progress
from linkwork.export import check_report_file, template_of

__all__ = ["report"]


@click.command
@file_argument
@click.option(
    "-o", "--output", metavar="PATH", required=True, help="Report: .html, .pdf, .docx or .md."
)
@click.option(
    "--template",
    metavar="NAME",
    default="engineer",
    show_default=True,
    help="engineer, student, or a template file, which names the sections.",
)
@click.option("--title", metavar="TEXT", help="The title; by default the mechanism's name.")
@click.option("--author", metavar="TEXT", help="Who writes the report.")
@click.option("--institution", metavar="TEXT", help="University, company or course.")
@click.option("--date", metavar="TEXT", help="The date as it is printed; none by default.")
@at_option
@configuration_option
@set_option
@json_option
@debug_option
def report(
    file: str,
    output: str,
    template: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
    **head: str | None,
) -> None:
    """Write a report of the mechanism, for a design file or as homework.

    Equations, drawings, tables, plots, circuits, forces, what is proved, and
    the file itself. Sections without content are named with the reason.
    Markdown has its pictures in the folder NAME-pictures next to it.

    \b
      linkwork report rapier.toml -o rapier.html
      linkwork report rapier.toml -o rapier.pdf --template student --at 60
      linkwork report press.toml -o press.docx --author "A. Student"
    """
    check_report_file(Path(output))
    check_outputs(file, output)
    template_of(template)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    with progress("writing the report") as tell:
        written = mechanism.to_report(
            output,
            values,
            template=template,
            configuration=configuration,
            progress=tell,
            **head,
        )
    _report, *pictures = map(str, written)
    about = f", with pictures in {written[1].parent}: {len(pictures)}" if pictures else ""
    print_written(output, as_json, about, pictures)
