"""A position as a page of text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from textwrap import wrap
from typing import Any

import click

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.options import (
    at_option,
    configuration_option,
    file_argument,
    input_values,
    read_mechanism,
    set_option,
)
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
    wrapped,
)
from linkwork.core.equations.writing import derivation
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import Certification
from linkwork.core.motion.model import leading_input
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.check import CheckReport, check_fields, measured_part_columns
from linkwork.core.results.listing import (
    Column,
    Row,
    certificate_text,
    changes_text,
    inputs_text,
    lengths,
    listed_links,
    radius_measure,
    redundant_lines,
    short,
    significant,
    system_columns,
    trail_columns,
    value_cells,
)
from linkwork.core.results.position import NewtonTrail, Position
from linkwork.core.results.quantities.registry import Listed
from linkwork.core.results.quantity import Kind, Units

_NOISE = 1e-13  # relative to the largest derivative: rounding, printed as 0
_SAME_END = 1e-6  # of a turn, or relative


def position_lines(mechanism: Mechanism, position: Position) -> list[str]:
    """The lines of a position: values, derivatives, points, evidence, and recorded steps."""
    where = inputs_text(position.input, position.input_units)
    lines = title_lines(position.mechanism)
    if not position.status.ok:
        lines += sentence(bad, "No position found", where)
        told = position.failure
        lines += fields([("why", position.message)] if told is None else told.sentences())
        return [*lines, *_steps(position, mechanism)]
    lines += sentence(good, "Position found", where)
    if position.failure is not None:
        lines += fields(position.failure.sentences())
    lines += _quantities(mechanism, position)
    if position.points:
        lines += ["", *_points(position)]
    lines += ["", *fields(_evidence(mechanism, position))]
    return [*lines, *_steps(position, mechanism)]


def _tables(mechanism: Mechanism, position: Position) -> Iterator[tuple[str, list[Row]]]:
    """The numbers of a position under their headings: unknowns, links, outputs."""
    equations = mechanism.loop_equations
    unknowns = {v.name: Kind(v.kind) for v in equations.unknowns if v.name in position.unknowns}
    outputs = {name: Kind(output.kind) for name, output in equations.outputs.items()}
    known = {*unknowns, *position.input}
    links = {
        name: Kind.ANGLE
        for name, angle in equations.links.items()
        if name not in known and angle.variable is not None
    }
    yield "unknown", [Row(name=n, kind=k, value=position.unknowns[n]) for n, k in unknowns.items()]
    yield "link", [Row(name=n, kind=k, value=position.links[n]) for n, k in links.items()]
    yield "output", [Row(name=n, kind=k, value=position.outputs[n]) for n, k in outputs.items()]


def _quantities(mechanism: Mechanism, position: Position) -> Iterator[str]:
    """Values with derivatives with respect to the input, and to time if the input has a speed."""
    by, units = position.derivative_unit, position.units
    for title, rows in _tables(mechanism, position):
        if not rows:
            continue
        names = Column(header=title, cells=[row.name for row in rows])
        own = [units.of(row.kind) for row in rows]
        columns = [Column(header="value", cells=value_cells(rows), align="point", units=own)]
        if by:
            columns += [
                _rates(rows, position.first, "1st deriv.", units, f"/{by}"),
                _rates(rows, position.second, "2nd deriv.", units, f"/{by}^2"),
            ]
        yield from ("", *table_lines([names, *columns]))
        if position.velocity:
            columns = [
                _rates(rows, position.velocity, "velocity", units, "/s"),
                _rates(rows, position.acceleration, "acceleration", units, "/s^2"),
            ]
            yield from ("", *table_lines([names, *columns]))


def _rates(
    rows: Sequence[Row], rates: Mapping[str, float], header: str, units: Units, per: str
) -> Column:
    numbers = [rates[row.name] for row in rows]
    noise = _NOISE * max(map(abs, numbers), default=0.0)
    return Column(
        header=header,
        cells=[significant(number, 6, noise) for number in numbers],
        align="point",
        units=[units.of_rate(row.kind) + per for row in rows],
    )


def _points(position: Position) -> list[str]:
    unit = f" [{position.units.length}]"
    places = position.points.values()
    both = lengths(number for place in places for number in place)
    return table_lines(
        [
            Column(header="point", cells=list(position.points)),
            Column(header=f"x{unit}", cells=both[0::2], align="point"),
            Column(header=f"y{unit}", cells=both[1::2], align="point"),
        ]
    )


def _evidence(mechanism: Mechanism, position: Position) -> Iterator[tuple[str, str]]:
    inputs = list(position.input)
    if inputs:
        lead = inputs[leading_input(mechanism.model.rows)[0]]
        others = ", the other inputs in lock-step" if len(inputs) > 1 else ""
        unit = f" ({position.derivative_unit})" if position.derivative_unit else ""
        yield "derivatives", f"with respect to {lead}{unit}{others}"
    yield "residual", significant(position.residual, 2) + residual_measure(mechanism)
    yield "iterations", str(position.iterations)
    yield "condition", significant(position.condition, 3)
    without, equations = "", mechanism.loop_equations
    if position.certificate.certification is Certification.SUBSET_CERTIFIED:
        without = f"; without {listed_links(position.redundant)}"
    yield (
        "certificate",
        certificate_text(position.certificate, radius_measure(equations.loops, equations.real))
        + without,
    )
    yield from redundant_lines(position.redundant)


def residual_measure(mechanism: Mechanism) -> str:
    """The measure of residuals and radii, printed after the number."""
    return " of the longest link" if mechanism.loop_equations.loops else ""


def _steps(position: Position, mechanism: Mechanism) -> Iterator[str]:
    """The iterations of every block from the guess, at the input value that was asked for."""
    if not position.steps:
        return
    where = inputs_text(position.input, position.input_units)
    yield ""
    yield from sentence(str, f"Newton-Raphson from the guess {where}".rstrip())
    for trail in position.steps:
        yield from ("", *_trail(mechanism, trail))
    ends = {
        name: x
        for trail in position.steps
        for name, x in trail.steps[-1].unknowns.items()
        if name in position.unknowns
    }
    kinds = {v.name: Kind(v.kind) for v in mechanism.loop_equations.unknowns}
    turn = mechanism.model.units.angle.turn
    away = [
        math.remainder(x - position.unknowns[name], turn) / turn
        if kinds[name] is Kind.ANGLE
        else (x - position.unknowns[name]) / max(1.0, abs(x))
        for name, x in ends.items()
    ]
    converged = all(trail.status.ok for trail in position.steps)
    if position.status.ok and not (converged and max(map(abs, away), default=0.0) < _SAME_END):
        own = mechanism.model.start_in_file_units.tolist()
        guessed = inputs_text(dict(zip(position.input, own, strict=True)), position.input_units)
        yield ""
        yield from sentence(
            str,
            "These steps do not lead to the position above, which was followed from the guess "
            f"{guessed}.".replace(" .", "."),
        )


def _trail(mechanism: Mechanism, trail: NewtonTrail) -> Iterator[str]:
    kinds = {v.name: Kind(v.kind) for v in mechanism.loop_equations.unknowns}
    units = mechanism.model.units
    if len(mechanism.model.compiled.solver.blocks) > 1:
        yield from sentence(str, ", ".join(f'"{label}"' for label in trail.equations))
    yield from table_lines(trail_columns(trail, kinds, units))
    if not trail.status.ok:
        yield from sentence(bad, trail.status.value)
    for step in trail.steps[:-1]:
        yield from ("", *table_lines(system_columns(trail, step)))
        yield from wrapped(changes_text(step, kinds, units), "  Δ  ")


# ----------------------------------------------------------------------
# ``linkwork solve``


_DEFAULT = NewtonOptions()


class _Tolerance(click.FloatRange):
    """A positive number; NaN is rejected."""

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        """The number in a text."""
        number = float(super().convert(value, param, ctx))
        if math.isnan(number):
            self.fail(f"{value} is not a number", param, ctx)
        return number


_POSITIVE = _Tolerance(min=0.0, min_open=True, max=math.inf, max_open=True)


@click.command("solve")
@file_argument
@at_option
@configuration_option
@click.option(
    "--from-guess",
    is_flag=True,
    help="Start Newton-Raphson from the guess at the requested input value. Default: solve at "
    "the input value of the guess, then follow the branch.",
)
@click.option("--show-steps", is_flag=True, help="Show every Newton-Raphson iteration.")
@click.option(
    "--equation-tolerance",
    metavar="NUMBER",
    type=_POSITIVE,
    default=_DEFAULT.equation_tolerance,
    show_default=True,
    help="Stop when the residual of every equation is below this.",
)
@click.option(
    "--solution-tolerance",
    metavar="NUMBER",
    type=_POSITIVE,
    default=_DEFAULT.solution_tolerance,
    show_default=True,
    help="Stop when no unknown changes by more than this.",
)
@click.option(
    "--max-steps",
    metavar="NUMBER",
    type=click.IntRange(1),
    default=_DEFAULT.max_steps,
    show_default=True,
    help="Maximum number of iterations.",
)
@click.option("--full-steps", is_flag=True, help="Take full Newton steps of any size.")
@set_option
@json_option
@debug_option
@click.pass_context
def solve_command(
    context: click.Context,
    file: str,
    at: tuple[str, ...],
    configuration: str | None,
    from_guess: bool,
    show_steps: bool,
    equation_tolerance: float,
    solution_tolerance: float,
    max_steps: int,
    full_steps: bool,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Solve one position by Newton-Raphson.

    \b
      linkwork solve rapier.toml --at 90
      linkwork solve rapier.toml --from-guess --show-steps
      linkwork solve fourbar.toml --at 60 --configuration crossed
      linkwork solve gripper.toml --at left=90 --at right=45
    """
    if configuration is not None and (from_guess or show_steps):
        raise InputError(
            "--configuration takes a position from the list of configurations, without steps "
            "from the guess: leave out --from-guess and --show-steps"
        )
    mechanism = read_mechanism(file, changes)
    options = NewtonOptions(
        equation_tolerance=equation_tolerance,
        solution_tolerance=solution_tolerance,
        max_steps=max_steps,
        largest_turn=math.inf if full_steps else _DEFAULT.largest_turn,
    )
    values = input_values(mechanism, at)
    with progress("solving"):
        position = mechanism.solve(
            values,
            configuration=configuration,
            from_guess=from_guess,
            options=options,
            with_steps=show_steps,
        )
    if as_json:
        print_json(position.to_dict())
    else:
        print_lines(position_lines(mechanism, position))
    if not position.status.ok:
        context.exit(1)


# ----------------------------------------------------------------------
# Checks, equations and quantities.


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
