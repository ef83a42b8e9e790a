"""Checks, equations and quantities."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from textwrap import wrap

import click

from linkwork.core.commands.options import file_argument, read_mechanism, set_option
from linkwork.core.commands.terminal import (
    WIDTH,
    bad,
    debug_option,
    fields,
    good,
    json_option,
    print_json,
    print_lines,
    progress,
    sentence,
    table_lines,
    title_lines,
)
from linkwork.core.equations.writing import derivation
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.check import CheckReport
from linkwork.core.results.listing.check_listing import check_fields, measured_part_columns
from linkwork.core.results.listing.motion_listing import Column, lengths, short, significant
from linkwork.core.results.quantities.registry import Listed

# ----------------------------------------------------------------------
# ``linkwork check``


@click.command("check")
@file_argument
@set_option
@json_option
@debug_option
@click.pass_context
def check_command(
    context: click.Context, file: str, changes: tuple[str, ...], as_json: bool
) -> None:
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


# ----------------------------------------------------------------------
# ``linkwork equations``


@click.command("equations")
@file_argument
@click.option("--latex", "as_latex", is_flag=True, help="Print LaTeX displays.")
@click.option(
    "--derivation",
    "as_derivation",
    is_flag=True,
    help="Print a LaTeX document: loops, scalar equations, Newton-Raphson, rates.",
)
@set_option
@json_option
@debug_option
def equations_command(
    file: str, as_latex: bool, as_derivation: bool, changes: tuple[str, ...], as_json: bool
) -> None:
    """Show the loop-closure equations and the Jacobian.

    Linkwork derives the equations from the points and links of the file, or
    reads them from the file.

    \b
      linkwork equations rapier.toml
      linkwork equations rapier.toml --latex > equations.tex
      linkwork equations rapier.toml --derivation > rapier.tex
    """
    asked = {"--latex": as_latex, "--derivation": as_derivation, "--json": as_json}
    names = [name for name, is_asked in asked.items() if is_asked]
    if len(names) > 1:
        raise InputError(f"{' and '.join(names)} exclude each other: leave one out")
    mechanism = read_mechanism(file, changes)
    sheet = mechanism.equations()
    if as_json:
        print_json({"mechanism": mechanism.name, **sheet.to_dict()})
    elif as_derivation:
        click.echo(derivation(sheet, mechanism.name).rstrip("\n"))
    elif as_latex:
        click.echo(sheet.latex().rstrip("\n"))
    else:
        print_lines([*title_lines(mechanism.name), "", sheet.text(WIDTH).rstrip("\n")])


# ----------------------------------------------------------------------
# ``linkwork quantities``


_GAPS = 8  # before each column of the table
_NARROWEST = 16  # width of the explanations


@click.command("quantities")
@file_argument
@set_option
@json_option
@debug_option
def quantities_command(file: str, changes: tuple[str, ...], as_json: bool) -> None:
    """List all quantities of a mechanism.

    Every name is a column of sweep and plot, an output in a file, and a
    quantity of families and studies; numbers of a motion are values of
    sweeps, families and studies. "…" is any quantity.

    \b
      linkwork quantities rapier.toml
      linkwork sweep rapier.toml --columns s16.d1 --csv rates.csv
      linkwork sweep rapier.toml --columns "stroke(s16)"
    """
    mechanism = read_mechanism(file, changes)
    model = mechanism.model
    listed = list(model.quantities.listed(timed=model.speed is not None))
    if as_json:
        print_json({"quantities": [asdict(line) for line in listed]})
    else:
        print_lines([*title_lines(mechanism.name), "", *_table(listed)])


def _table(listed: Sequence[Listed]) -> list[str]:
    """Name, kind, unit and explanation of each; long explanations are wrapped."""
    used = _GAPS + sum(
        max(len(text) for text in texts)
        for texts in (
            [line.name for line in listed],
            [line.kind for line in listed],
            ["unit", *(line.unit for line in listed)],
        )
    )
    rows = [row for line in listed for row in _rows(line, max(WIDTH - used, _NARROWEST))]
    headers = ("name", "kind", "unit", "meaning")
    columns = zip(headers, zip(*rows, strict=True), strict=True)
    return table_lines([Column(header=header, cells=cells) for header, cells in columns])


def _rows(line: Listed, room: int) -> Iterator[tuple[str, str, str, str]]:
    first, *more = wrap(line.about, room)
    yield line.name, line.kind, line.unit, first
    yield from (("", "", "", text) for text in more)
