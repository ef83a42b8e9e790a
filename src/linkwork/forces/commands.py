"""Commands on forces and motions in time."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from typing import Any

import click
import numpy as np

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.options import (
    at_option,
    check_outputs,
    columns_option,
    configuration_option,
    file_argument,
    input_values,
    number_or_formula,
    read_mechanism,
    set_option,
    straight_option,
    write_table,
)
from linkwork.core.commands.sweep import check_points, failure_line, range_lines, write_plot
from linkwork.core.commands.terminal import (
    bad,
    debug_option,
    fields,
    good,
    json_option,
    print_json,
    print_lines,
    print_page,
    progress,
    sentence,
    table_lines,
    title_lines,
)
from linkwork.core.drawing.annotations import SceneOptions
from linkwork.core.drawing.matplotlib_writer import check_picture, write
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.lanes import phase
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.results.listing import (
    Column,
    fixed,
    inputs_text,
    limit_fields,
    significant,
    whole_energy,
)
from linkwork.core.results.motion import Motion
from linkwork.core.results.tables import Table
from linkwork.forces.functions import equilibria, stalls
from linkwork.forces.results import (
    Equilibrium,
    ForceStatus,
    Reactions,
    Stall,
    finite_forces,
    force_fields,
    force_status_fields,
    undefined_fields,
)

# ----------------------------------------------------------------------
# Forces as a page of text: efforts, reactions, totals, and how far the two ways agree.


_TOTALS = ("shaking", "power", "kinetic_energy", "stored_energy", "load_power", "energy_rate")
_LOSSES = ("friction_power", "efficiency")
_NONE = (
    ForceStatus.NO_POSITION, ForceStatus.NO_RATES, ForceStatus.SELF_LOCKING, ForceStatus.NO_LOAD,
    ForceStatus.HELD,
)  # fmt: skip


def position_forces_lines(found: Reactions, names: Sequence[str] = ()) -> list[str]:
    """All forces at one position, or those asked for."""
    where = inputs_text(
        {name: float(value) for name, value in found.inputs.items()}, found.input_units
    )
    lines = title_lines(found.mechanism)
    if found.status in _NONE:
        why = [("why", found.status.value), *undefined_fields(found)]
        if found.status is ForceStatus.SELF_LOCKING:
            why.append(("proved", "yes" if found.proved else "no"))
        return [*lines, *sentence(bad, "No forces", where), *fields(why)]
    lines += sentence(good, "Forces", where)
    if names:
        return [*lines, "", *_numbers("quantity", found, names)]
    vectors = [stem for stem in _stems(found) if not stem.startswith("shaking")]
    pairs = {f"{stem}.{axis}" for stem in vectors for axis in "xy"}
    totals = [name for name in found.values if name.partition(".")[0] in (*_TOTALS, *_LOSSES)]
    efforts = [name for name in found.values if ".effort" in name]
    others = [
        name for name in found.values if name not in {*pairs, *totals, *efforts, "disagreement"}
    ]
    for title, listed in (("effort", efforts), ("reaction", others)):
        if listed:
            lines += ["", *_numbers(title, found, listed)]
    if vectors:
        lines += ["", *_vectors(found, vectors)]
    lines += ["", *_numbers("total", found, totals)]
    return _with_checks(lines, found)


def motion_forces_lines(
    found: Reactions, motion: Motion, names: Sequence[str] = (), stalls: Sequence[Stall] = ()
) -> list[str]:
    """The smallest and largest values of all forces over a motion."""
    name = next(iter(found.inputs), "")
    values, unit = found.inputs[name], found.input_units[name]
    head = f"Forces for {name} from {values[0]:g} to {values[-1]:g} {unit}: {len(found)} positions"
    lines = [*title_lines(found.mechanism), *sentence(str, head)]
    ends = [] if motion.found.all() else [*limit_fields(motion)]
    lines += fields([*force_status_fields(found), *ends])
    listed = finite_forces(found, names)
    lines += ["", *range_lines(motion, listed, found.at_switches)] if listed else []
    return _with_checks(lines, found, stalls)


def _with_checks(lines: list[str], found: Reactions, stalls: Sequence[Stall] = ()) -> list[str]:
    """Without a motor or a position there is nothing to compare."""
    checks = list(force_fields(found, stalls))
    return [*lines, "", *fields(checks)] if checks else lines


def reactions_data(found: Reactions, table: Table, stalls: Sequence[Stall] = ()) -> dict[str, Any]:
    """The forces as JSON-ready data."""
    return {
        "mechanism": found.mechanism,
        "status": found.status.name,
        "units": dict(table.units),
        "columns": {name: column.tolist() for name, column in table.columns.items()},
        **{
            word: [name for name, rows in getattr(found, word).items() if rows.any()]
            for word in ("undetermined", "lifted", "slipping", "undefined")
        },
        "proved": found.proved.tolist(),
        "stalls": [
            {word: getattr(stall, word) for word in ("input", "value", "unit", "bracket", "proved")}
            for stall in stalls
        ],
    }


def _stems(found: Reactions) -> Iterator[str]:
    """The names of vectors without their axis."""
    for name in found.values:
        stem, _, axis = name.rpartition(".")
        if axis == "x" and f"{stem}.y" in found.values:
            yield stem


def _numbers(title: str, found: Reactions, names: Sequence[str]) -> list[str]:
    cells = [significant(float(found.values[name])) for name in names]
    units = [found.units[name] for name in names]
    values = Column(header="value", cells=cells, align="point", units=units)
    return table_lines([Column(header=title, cells=list(names)), values])


def _vectors(found: Reactions, stems: Sequence[str]) -> list[str]:
    """Forces by components, size and direction."""
    places = [complex(*(float(found.values[f"{stem}.{axis}"]) for axis in "xy")) for stem in stems]
    unit = found.units[f"{stems[0]}.x"]
    parts = {
        f"x [{unit}]": [place.real for place in places],
        f"y [{unit}]": [place.imag for place in places],
        f"size [{unit}]": [math.hypot(place.real, place.imag) for place in places],
    }
    angles = [math.degrees(phase(p)) if abs(p) > 0.0 else math.nan for p in places]
    columns = [Column(header="force", cells=list(stems))]
    for header, values in parts.items():
        columns.append(Column(header=header, cells=list(map(significant, values)), align="point"))
    columns.append(Column(header="angle", cells=[fixed(a, 2) for a in angles], align="point"))
    # explanations of forces end with the body that they act on
    carriers = [found.about[f"{stem}.x"].rpartition(" on ")[2] for stem in stems]
    return table_lines([*columns, Column(header="on", cells=carriers)])


# ----------------------------------------------------------------------
# ``linkwork forces``


@click.command("forces")
@file_argument
@at_option
@configuration_option
@columns_option("Print, write and plot only this quantity of forces.")
@click.option("--csv", metavar="PATH", help="Write the table of all rows; - is standard output.")
@click.option("--draw", metavar="PATH", help="Draw the forces at one position, as by draw.")
@click.option("--plot", metavar="PATH", help="Plot the efforts over the input.")
@set_option
@json_option
@debug_option
@click.pass_context
def forces_command(
    context: click.Context,
    file: str,
    at: tuple[str, ...],
    configuration: str | None,
    names: tuple[str, ...],
    csv: str | None,
    draw: str | None,
    plot: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute the efforts of the inputs and the reactions of all joints.

    Masses, gravity, loads and springs of the file load the mechanism. With a
    speed of the input masses have inertia; without one it is at rest.

    \b
      linkwork forces press.toml
      linkwork forces press.toml --at 60 --draw forces.png
      linkwork forces press.toml --columns crank.effort --plot torque.png
      linkwork forces press.toml --csv forces.csv
    """
    for name in (draw, plot):
        if name is not None:
            check_picture(name)
    if at and plot is not None:
        raise InputError("--plot shows a whole motion: leave out --at")
    check_outputs(file, csv, draw, plot, as_json=as_json)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    moves = bool(mechanism.description.inputs)
    if plot is not None and not moves:
        raise InputError(f'"{mechanism.name}" has no input, so that --plot has no motion to show')
    motion = None
    locked: tuple[Stall, ...] = ()
    if values is None and moves:
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
        found = mechanism.forces(motion=motion)
        if ForceStatus.SELF_LOCKING in found.statuses:
            with progress("locating stalls"):
                locked = stalls(mechanism, motion=motion, configuration=configuration)
    else:
        found = mechanism.forces(values, configuration=configuration)
    table = found.table(*names)
    written = write_table(csv, table)
    if draw is not None:
        written.append(_drawn(mechanism, values, configuration, draw))
    if plot is not None and motion is not None:
        written.append(write_plot(motion, names or found.efforts, plot))
    if as_json:
        print_json(reactions_data(found, table, locked))
    elif csv != "-":
        page = (
            position_forces_lines(found, names)
            if motion is None
            else motion_forces_lines(found, motion, names, locked)
        )
        print_page(page, written)
    if motion is not None and not motion.found.all():
        print_lines(failure_line(motion), err=True)
        context.exit(1)


def _drawn(
    mechanism: Mechanism, values: dict[str, float] | None, configuration: str | None, path: str
) -> str:
    """Draw one position with its forces; returns a line about it."""
    check_points(mechanism)
    here = mechanism.solve(values, configuration=configuration)
    arrows = mechanism.forces(here.input, configuration=configuration).arrows
    options = replace(SceneOptions(), forces=arrows)
    with progress("drawing"):
        write(mechanism.scene(values, configuration=configuration, options=options), path)
    return f"Wrote {path}: the forces of pins and loads."


# ----------------------------------------------------------------------
# Simulated motions and equilibria as pages of text.


_ROUNDING = 1e-11  # of the energy: what the balance leaves open


def simulation_lines(motion: Motion, inputs: Sequence[str], names: Sequence[str] = ()) -> list[str]:
    """How a simulation ended, its events and the ranges of its quantities, or of all variables and
    the rates of the inputs.
    """
    whole = bool(motion.found.all())
    message = motion.message[:1].upper() + motion.message[1:]
    lines = [*title_lines(motion.mechanism), *sentence(good if whole else bad, message)]
    lines += fields(list(_facts(motion)))
    listed = list(names) or [*motion.unknowns, *(f"{n}.velocity" for n in inputs)]
    ranges = range_lines(motion, listed)
    return [*lines, "", *ranges] if ranges else lines


def _facts(motion: Motion) -> Iterator[tuple[str, str]]:
    yield "rows", f"{int(motion.asked.sum())}"
    events = Counter(word for word in motion.limit if word)
    for word, count in events.items():
        if word != "end":
            yield "event", f"{word}, {count} times" if count > 1 else word
    yield "certified", f"{int(motion.certified.sum())} of {int(motion.found.sum())}"
    if "load_power" in motion.quantities.derived:
        energy = whole_energy(motion)
        fine = energy[np.isfinite(energy)]
        if len(fine):
            unit = motion.quantity("kinetic_energy").unit
            yield "energy", f"{fine[0]:.10g} at first, {fine[-1]:.10g} at last {unit}"
            if motion.friction_work is not None:
                lost = motion.friction_work[np.isfinite(energy)][-1]
                given = fine[-1] - fine[0] + lost
                size = max(np.abs(fine).max(), abs(lost))
                given = 0.0 if abs(given) < _ROUNDING * size else given
                yield "", f"friction took {lost:.10g}, loads and motor gave {given:.10g}"


def equilibria_lines(mechanism: Mechanism, found: Sequence[Equilibrium]) -> list[str]:
    """A table of equilibria."""
    lines = title_lines(mechanism.description.name)
    if not found:
        return [*lines, *sentence(bad, "No equilibrium on the circuit of the start")]
    if found[0].indifferent == "everywhere":
        return [*lines, *sentence(good, "In equilibrium at every position (indifferent)")]
    head = f"{len(found)} equilibri{'um' if len(found) == 1 else 'a'} on the circuit of the start"
    units = mechanism.model.input_units
    if len(units) > 1:
        head += ", found from a grid of starts: there may be more"
    columns = []
    for name, unit in units.items():
        cells = [fixed(each.values[name], 6) for each in found]
        header = f"{name} [{unit}]" if unit else name
        columns.append(Column(header=header, cells=cells, align="point"))
    columns.append(Column(header="", cells=[_stability(each) for each in found]))
    for k in range(len(units)):
        rates = [each.frequencies[k] for each in found]
        cells = [significant(rate) if rate > 0.0 else "-" for rate in rates]
        header = f"mode {k + 1} [Hz]" if len(units) > 1 else "frequency [Hz]"
        columns.append(Column(header=header, cells=cells, align="point"))
    return [*lines, *sentence(good, head), "", *table_lines(columns)]


def _stability(each: Equilibrium) -> str:
    return "indifferent" if each.indifferent else "stable" if each.stable else "unstable"


def motion_data(motion: Motion, table: Table) -> dict[str, Any]:
    """A simulated motion as JSON-ready data."""
    return {
        "mechanism": motion.mechanism,
        "message": motion.message,
        "units": dict(table.units),
        "events": [
            {"t": float(t), "event": word}
            for t, word in zip(motion["t"], motion.limit, strict=True)
            if word
        ],
        "columns": {name: column.tolist() for name, column in table.columns.items()},
        "friction_work": None if motion.friction_work is None else motion.friction_work.tolist(),
    }


# ----------------------------------------------------------------------
# ``linkwork simulate``


@click.command("simulate")
@file_argument
@click.option("--until", type=float, metavar="SECONDS", help="The last time.")
@click.option("--step", type=float, metavar="SECONDS", help="Between rows; default 400 rows.")
@at_option
@click.option(
    "--start-speed",
    "start_speeds",
    metavar="[INPUT=]SPEED",
    multiple=True,
    help='Of the input: "60 rad/s", default 0; of several "left=60 rad/s", once for each.',
)
@straight_option
@click.option("--equilibria", is_flag=True, help="List the positions of rest, and no motion.")
@columns_option("Print, write and plot only this quantity.")
@click.option("--no-certificates", is_flag=True, help="Skip the proofs (faster).")
@click.option("--csv", metavar="PATH", help="Write the table of all rows; - is standard output.")
@click.option("--plot", metavar="PATH", help="Plot the quantities over time.")
@set_option
@json_option
@debug_option
@click.pass_context
def simulate_command(
    context: click.Context,
    file: str,
    until: float | None,
    step: float | None,
    at: tuple[str, ...],
    start_speeds: tuple[str, ...],
    change_points: str,
    equilibria: bool,
    names: tuple[str, ...],
    no_certificates: bool,
    csv: str | None,
    plot: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute the motion in time under masses, loads, springs and a motor.

    Inputs with a law follow it; the others are free: they start at the sketch, or at
    --at, with --start-speed.
    Rows are added where loads switch and where stops are hit.

    \b
      linkwork simulate pump.toml --until 2 --start-speed "60 rad/s"
      linkwork simulate pump.toml --until 2 --columns crank.velocity --plot v.png
      linkwork simulate pump.toml --until 2 --step 0.01 --csv -
      linkwork simulate lamp.toml --equilibria
    """
    if plot is not None:
        check_picture(plot)
    check_outputs(file, csv, plot, as_json=as_json)
    mechanism = read_mechanism(file, changes)
    start = input_values(mechanism, at)
    if equilibria:
        if until is not None or csv is not None or plot is not None:
            raise InputError("--equilibria lists positions of rest: leave out --until and files")
        _list_equilibria(mechanism, start, change_points, as_json)
        return
    if until is None:
        raise InputError("--until is missing: the last time in seconds")
    speed = _start_speed(start_speeds)
    with progress("simulating") as tell:
        motion = mechanism.simulate(
            until,
            step=step,
            at=start,
            start_speed=speed,
            change_points=change_points,
            certify=not no_certificates,
            progress=tell,
        )
    table = motion.table(*names)
    written = write_table(csv, table)
    if plot is not None:
        shown = names or tuple(f"{name}.velocity" for name in _inputs(mechanism))
        written.append(write_plot(motion, shown, plot, over="time"))
    if as_json:
        print_json(motion_data(motion, table))
    elif csv != "-":
        print_page(simulation_lines(motion, _inputs(mechanism), names), written)
    if not motion.found.all():
        context.exit(1)


def _start_speed(given: tuple[str, ...]) -> Number | dict[str, Number]:
    """The start speed of the only input, or those of several by name."""
    named = [text.partition("=") for text in given]
    if not any(equals for _, equals, _ in named):
        if len(given) > 1:
            raise InputError("--start-speed of several inputs: name each, --start-speed left=2")
        return number_or_formula(given[0]) if given else 0
    found: dict[str, Number] = {}
    for name, equals, value in named:
        if not equals or name.strip() in found:
            raise InputError(f"--start-speed {name}: name each input once, --start-speed left=2")
        found[name.strip()] = number_or_formula(value.strip())
    return found


def _inputs(mechanism: Mechanism) -> list[str]:
    return [each.column for each in mechanism.description.inputs]


def _list_equilibria(
    mechanism: Mechanism, start: dict[str, float] | None, change_points: str, as_json: bool
) -> None:
    with progress("looking for equilibria"):
        found = equilibria(mechanism, start, change_points=change_points)
    if as_json:
        print_json({"equilibria": [asdict(each) for each in found]})
    else:
        print_lines(equilibria_lines(mechanism, found))
