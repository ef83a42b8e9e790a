"""``linkwork circuits``"""

from __future__ import annotations

import click

from linkwork.api import Mechanism
from linkwork.cli import picture
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import debug_option, file_argument, json_option, set_option
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import (
    bad,
    fields,
    good,
    print_json,
    print_lines,
    progress,
    sentence,
    title_lines,
    wrapped,
)
from linkwork.cli.text_table import table_lines
from linkwork.drawing.charts.circuit_chart import MOST_PANELS, circuit_chart
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import canonical
from linkwork.motion import check_quantities
from linkwork.results.circuits import Circuit, Circuits
from linkwork.results.listing.circuit_listing import branch_columns, circuit_fields

__all__ = ["circuits", "circuits_lines"]


@click.command
@file_argument
@click.option("--draw", metavar="PATH", help="Draw all circuits: .png, .svg, .pdf or .tikz.")
@click.option(
    "--of",
    "names",
    metavar="NAME",
    multiple=True,
    help="Draw NAME over the input, with --draw; may be repeated. Default: all unknowns.",
)
@click.option("--no-certificates", is_flag=True, help="Skip the proofs (faster).")
@set_option
@json_option
@debug_option
@click.pass_context
def circuits(
    context: click.Context,
    file: str,
    draw: str | None,
    names: tuple[str, ...],
    no_certificates: bool,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Find every circuit, its branches, dead points and change points.

    A circuit is the set of all positions that the mechanism can reach without
    disassembly; a branch is a part of it between dead points. The commands
    solve and sweep accept their names.

    \b
      linkwork circuits rapier.toml --draw circuits.png --of s16
      linkwork sweep rapier.toml --configuration "circuit 3 branch 1"
    """
    if names and draw is None:
        raise InputError("--of selects the curves of --draw: add --draw PATH")
    if draw is not None:
        picture.check_picture(draw)
    check_outputs(file, draw)
    mechanism = read_mechanism(file, changes)
    _check_quantities(mechanism, names)
    with progress("following circuits") as tell:
        found = mechanism.circuits(certify=not no_certificates, progress=tell)
    written = [] if draw is None else ["", *wrapped(_drawn(mechanism, found, names, draw))]
    if as_json:
        print_json(found.to_dict())
    else:
        print_lines([*circuits_lines(found), *written])
    if not len(found):
        context.exit(1)


def _check_quantities(mechanism: Mechanism, names: tuple[str, ...]) -> None:
    """Reject names that cannot be drawn over the input, before any computation."""
    for name in names:
        if canonical(name) in [canonical(v.name) for v in mechanism.loop_equations.inputs]:
            raise InputError(
                f"--of {name}: curves are drawn over the input: name an unknown, a link, "
                "an output or the coordinate of a point"
            )
    check_quantities(mechanism.model, names)


def _drawn(mechanism: Mechanism, found: Circuits, names: tuple[str, ...], draw: str) -> str:
    """Draw all circuits, if there are any; returns a line about the file."""
    if not len(found):
        return f"Did not write {draw}: there is nothing to draw."
    with progress("drawing"):
        picture.write(circuit_chart(found, names), draw)
    every = len(mechanism.loop_equations.unknowns)
    if names or every <= MOST_PANELS:
        return f"Wrote {draw}."
    return f"Wrote {draw}: the first {MOST_PANELS} of {every} unknowns; --of NAME chooses."


def circuits_lines(found: Circuits) -> list[str]:
    """The page: branches of every circuit, how it ends, which links turn, its limits."""
    count = len(found)
    what = "1 circuit" if count == 1 else f"{count or 'No'} circuits"
    lines = [
        *title_lines(found.mechanism),
        *sentence(good if count else bad, what, f"driven by {found.input}"),
    ]
    for circuit in found:
        lines += ["", *_circuit_lines(found, circuit)]
    reason = [] if found.failure is None else list(found.failure.sentences())
    return [*lines, "", *fields([*reason, ("complete", found.message)])]


def _circuit_lines(found: Circuits, circuit: Circuit) -> list[str]:
    return [
        *table_lines(branch_columns(found, circuit)),
        *fields(list(circuit_fields(found, circuit))),
    ]
