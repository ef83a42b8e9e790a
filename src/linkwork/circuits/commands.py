"""Commands on circuits and configurations."""

from __future__ import annotations

import click

from linkwork import wings
from linkwork.circuits.circuit_list import (
    branch_columns,
    circuit_fields,
    completeness_fields,
    configuration_columns,
)
from linkwork.circuits.results import Circuits, Configurations
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.options import (
    at_option,
    check_outputs,
    file_argument,
    input_values,
    read_mechanism,
    set_option,
    shown_source,
)
from linkwork.core.commands.sweep import check_points
from linkwork.core.commands.terminal import (
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
    wrapped,
)
from linkwork.core.drawing.matplotlib_writer import check_picture, write
from linkwork.core.drawing.mechanism_scene import configuration_sheet
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import canonical
from linkwork.core.motion.extremes import check_quantities
from linkwork.core.results.listing import inputs_text, short
from linkwork.core.results.quantity import Kind

# ----------------------------------------------------------------------
# ``linkwork circuits``


@click.command("circuits")
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
def circuits_command(
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
        check_picture(draw)
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
        charts = wings.use("writers.charts.lines")
        write(charts.circuit_chart(found, names), draw)
    every = len(mechanism.loop_equations.unknowns)
    if names or every <= charts.MOST_PANELS:
        return f"Wrote {draw}."
    return f"Wrote {draw}: the first {charts.MOST_PANELS} of {every} unknowns; --of NAME chooses."


def circuits_lines(found: Circuits) -> list[str]:
    """The page: branches of every circuit, how it ends, which links turn, its limits."""
    count = len(found)
    what = "1 circuit" if count == 1 else f"{count or 'No'} circuits"
    lines = [
        *title_lines(found.mechanism),
        *sentence(good if count else bad, what, f"driven by {found.input}"),
    ]
    for circuit in found:
        lines += ["", *table_lines(branch_columns(found, circuit))]
        lines += fields(list(circuit_fields(found, circuit)))
    reason = [] if found.failure is None else list(found.failure.sentences())
    return [*lines, "", *fields([*reason, ("complete", found.message)])]


# ----------------------------------------------------------------------
# ``linkwork configurations``


@click.command("configurations")
@file_argument
@at_option
@click.option("--draw", metavar="PATH", help="Draw all configurations as .png, .svg or .pdf.")
@set_option
@json_option
@debug_option
@click.pass_context
def configurations_command(
    context: click.Context,
    file: str,
    at: tuple[str, ...],
    draw: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """List all assembly configurations at one input value.

    States whether the list is proved complete. The commands solve and sweep
    accept the names in the list.

    \b
      linkwork configurations rapier.toml --at 60 --draw list.png
      linkwork solve fourbar.toml --at 60 --configuration crossed
    """
    if draw is not None:
        check_picture(draw)
    check_outputs(file, draw)
    mechanism = read_mechanism(file, changes)
    if draw is not None:
        check_points(mechanism)
    values = input_values(mechanism, at)
    with progress("listing configurations"):
        found = mechanism.configurations(values)
    if draw is not None and len(found):
        with progress("drawing"):
            write(configuration_sheet(found), draw)
    if as_json:
        print_json(found.to_dict())
    else:
        hint = [] if len(found) else _reason(file, found)
        written = _written(draw, len(found))
        print_lines([*configurations_lines(mechanism, found), *written, *hint])
    if not (found.completeness.complete and len(found)):
        context.exit(1)


def _reason(file: str, found: Configurations) -> list[str]:
    """The command that explains why there is no configuration."""
    asked = [f"{name}={short(value)}" for name, value in found.input.items()]
    at = "".join(f" --at {text if len(asked) > 1 else text.partition('=')[2]}" for text in asked)
    return ["", *wrapped(f"For the reason: linkwork solve {shown_source(file)}{at}")]


def _written(draw: str | None, count: int) -> list[str]:
    if draw is None:
        return []
    return ["", f"Wrote {draw}." if count else f"Did not write {draw}: there is nothing to draw."]


def configurations_lines(mechanism: Mechanism, found: Configurations) -> list[str]:
    """The page: one row per configuration, then completeness and the counts of solutions."""
    kinds = {v.name: Kind(v.kind) for v in mechanism.loop_equations.unknowns}
    lines = title_lines(found.mechanism)
    count = len(found)
    what = "1 configuration" if count == 1 else f"{count or 'No'} configurations"
    where = inputs_text(found.input, found.input_units)
    lines += sentence(good if found.completeness.complete and count else bad, what, where)
    if count:
        lines += ["", *table_lines(configuration_columns(found, kinds))]
    return [*lines, "", *fields(completeness_fields(found))]
