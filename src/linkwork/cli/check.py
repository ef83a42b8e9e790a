"""``linkwork check``"""

from __future__ import annotations

import click

from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import debug_option, file_argument, json_option, set_option
from linkwork.cli.terminal import (
    bad,
    fields,
    good,
    print_json,
    print_lines,
    progress,
    sentence,
    title_lines,
)
from linkwork.cli.text_table import table_lines
from linkwork.results.check import CheckReport
from linkwork.results.listing.check_listing import check_fields, measured_part_columns
from linkwork.results.listing.column import Column
from linkwork.results.listing.number_text import lengths, short, significant

__all__ = ["check", "check_lines"]


@click.command
@file_argument
@set_option
@json_option
@debug_option
@click.pass_context
def check(context: click.Context, file: str, changes: tuple[str, ...], as_json: bool) -> None:
    """Report how the file was read: loops, unknowns, mobility, problems.

    \b
      linkwork check rapier.toml
      linkwork check rapier.toml --set a2=260
    """
    mechanism = read_mechanism(file, changes)
    with progress("checking"):
        report = mechanism.check()
    if as_json:
        print_json(report.to_dict())
    else:
        print_lines(check_lines(report, mechanism.description.length))
    if not report.start.ok:
        context.exit(1)


def check_lines(report: CheckReport, length: str) -> list[str]:
    """The report as a page; ``length`` is the unit of lengths."""
    lines = [*title_lines(report.mechanism), *fields(check_fields(report)), "", *_start(report)]
    if report.measured:
        links, points, values = zip(*report.measured, strict=True)
        lines += ["", "Lengths measured between [points], because [lengths] does not give them"]
        lines += table_lines(
            [
                Column(header="link", cells=links),
                Column(header="points", cells=points),
                Column(header=f"length [{length}]", cells=lengths(values), align="point"),
            ]
        )
    if report.measured_in_parts:
        lines += ["", "Measured between [points] for parts, because the file does not give it"]
        lines += table_lines(measured_part_columns(report))
    return lines


def _start(report: CheckReport) -> list[str]:
    where = ", ".join(
        f"{name} = {short(report.start_input[name])} {unit}".rstrip()
        for name, unit in report.inputs
    )
    at = f"at {where}" if where else ""
    if not report.start.ok:
        told = report.failure
        why = [("why", report.start_message)] if told is None else told.sentences()
        return [*sentence(bad, "No position found", at), *fields(why)]
    measure = "" if report.form == "equations" else " of the longest link"
    residual = significant(report.residual, 2) + measure
    return [*sentence(good, "Position found", at), *fields([("residual", residual)])]
