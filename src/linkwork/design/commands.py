"""Commands on sensitivities, tolerances and machine design."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

import click
import numpy as np

from linkwork import design
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.options import (
    at_option,
    check_outputs,
    configuration_option,
    file_argument,
    input_values,
    number_or_formula,
    of_option,
    read_mechanism,
    set_option,
    write_table,
)
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
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.listing.motion_listing import Column, short, significant
from linkwork.core.results.motion import Motion
from linkwork.core.results.tables import driven_text
from linkwork.design.listing import contribution_columns, sampled_fields, tolerance_fields
from linkwork.design.sensitivities import is_of_motion
from linkwork.design.tolerance_results import Sensitivity, SensitivityStatus, Tolerance

# ----------------------------------------------------------------------
# Sensitivities and tolerances as pages of text.


def sensitivity_lines(found: Sensitivity) -> list[str]:
    """The derivatives by number, the largest first."""
    lines = title_lines(found.mechanism)
    rows = found.value.ndim > 0
    at = {} if rows else {name: float(value) for name, value in found.inputs.items()}
    where = f"at {driven_text(at, found.input_units)}" if at else ""
    if rows:
        where = f"in {len(found)} positions"
    counts = Counter(status for status in found.statuses if status is not SensitivityStatus.FOUND)
    if len(counts) and SensitivityStatus.FOUND not in found.statuses and not rows:
        lines += sentence(bad, f"No sensitivity of {found.of}", where)
        lines += fields([("why", found.status.value)])
        if found.status is not SensitivityStatus.CORNER:
            return lines
    else:
        lines += sentence(good, f"Sensitivity of {found.of}", where)
    if not rows:
        lines += fields([("value", f"{short(float(found.value))} {found.unit}".rstrip())])
    else:
        lines += fields([("found", str(found.statuses.count(SensitivityStatus.FOUND)))])
        lines += (
            fields([(status.label, f"{count}: {status.value}") for status, count in counts.items()])
            if counts
            else []
        )
    names = found.effective
    if names:
        lines += ["", *_table(found, names, rows)]
    rest = len(found.derivatives) - len(names)
    notes = list(_notes(found, rest))
    return [*lines, "", *fields(notes)] if notes else lines


def _notes(found: Sensitivity, rest: int) -> Iterator[tuple[str, str]]:
    if rest:
        plural = "numbers have" if rest > 1 else "number has"
        yield "others", f"{rest} more {plural} no effect"
    reasons: dict[str, list[str]] = {}
    for name, why in found.refused.items():
        reasons.setdefault(why, []).append(name)
    for why, names in reasons.items():
        yield "refused", f"{', '.join(names)}: {why}"


def _table(found: Sensitivity, names: tuple[str, ...], rows: bool) -> list[str]:
    units = [found.unit_by(name) for name in names]
    columns = [
        Column(header="number", cells=list(names)),
        Column(
            header="value",
            cells=[short(found.numbers[name]) for name in names],
            align="point",
            units=[found.units[name] for name in names],
        ),
    ]
    if not rows:
        cells = [significant(float(found.derivatives[name])) for name in names]
        columns.append(Column(header="derivative", cells=cells, align="point", units=units))
        return table_lines(columns)
    for header, extreme in (("smallest", np.fmin.reduce), ("largest", np.fmax.reduce)):
        cells = [significant(float(extreme(found.derivatives[name]))) for name in names]
        columns.append(Column(header=header, cells=cells, align="point", units=units))
    return table_lines(columns)


def sensitivity_data(found: Sensitivity) -> dict[str, Any]:
    """The derivatives as JSON-ready data."""
    return {
        "mechanism": found.mechanism,
        "of": found.of,
        "unit": found.unit,
        "status": [status.name for status in found.statuses],
        "inputs": {name: np.asarray(value).tolist() for name, value in found.inputs.items()},
        "value": found.value.tolist(),
        "derivatives": {name: rates.tolist() for name, rates in found.derivatives.items()},
        "units": {name: found.unit_by(name) for name in found.derivatives},
        "refused": dict(found.refused),
    }


def tolerance_lines(found: Tolerance) -> list[str]:
    """Worst case, root sum square, and the share of each number and pin."""
    lines = title_lines(found.mechanism)
    where = f"at {found.where}" if found.where else ""
    if found.status is not SensitivityStatus.FOUND:
        lines += sentence(bad, f"No tolerance of {found.of}", where)
        lines += fields([("why", found.status.value)])
        return [*lines, *_sampled(found)]
    lines += sentence(good, f"Tolerance of {found.of}", where)
    lines += [*fields(tolerance_fields(found)), *_sampled(found)]
    return [*lines, "", *table_lines(contribution_columns(found))]


def _sampled(found: Tolerance) -> list[str]:
    return [] if found.sampled is None else fields(sampled_fields(found))


def tolerance_data(found: Tolerance) -> dict[str, Any]:
    """The tolerance as JSON-ready data."""
    return {
        "mechanism": found.mechanism,
        "of": found.of,
        "unit": found.unit,
        "inputs": dict(found.inputs),
        "status": found.status.name,
        "value": found.value,
        "worst_case": found.worst_case,
        "root_sum_square": found.root_sum_square,
        "contributions": [asdict(part) for part in found.contributions],
        "sampled": None if found.sampled is None else asdict(found.sampled),
    }


# ----------------------------------------------------------------------
# ``linkwork sensitivity``


@click.command("sensitivity")
@file_argument
@of_option
@at_option
@configuration_option
@click.option(
    "--by",
    metavar="NAME",
    multiple=True,
    help="Only this number: a dimension, length, angle, coordinate or offset. Repeatable.",
)
@click.option("--csv", metavar="PATH", help="Write a table; - is standard output.")
@set_option
@json_option
@debug_option
@click.pass_context
def sensitivity_command(
    context: click.Context,
    file: str,
    of: str,
    at: tuple[str, ...],
    configuration: str | None,
    by: tuple[str, ...],
    csv: str | None,
    changes: tuple[str, ...],
    as_json: bool,
) -> None:
    """Compute how much a quantity changes with each number of a mechanism.

    The derivatives are exact. With --at they belong to one position, else to
    every row of the table; a number of the whole motion has one by each number.

    \b
      linkwork sensitivity crank.toml --of d --at 60
      linkwork sensitivity crank.toml --of d.velocity --csv rows.csv
      linkwork sensitivity crank.toml --of "stroke(d)" --by "O2 A"
    """
    check_outputs(file, csv, as_json=as_json)
    mechanism = read_mechanism(file, changes)
    values = input_values(mechanism, at)
    motion = None
    if values is None and mechanism.description.inputs:
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
    elif values is not None and is_of_motion(of):
        raise InputError(f'"{of}" is a number of a whole motion: leave out --at')
    with progress("differentiating"):
        found = design.sensitivity(
            mechanism, of, values, by=by or None, configuration=configuration, motion=motion
        )
    written = write_table(csv, found.table())
    if as_json:
        print_json(sensitivity_data(found))
    elif csv != "-":
        print_page(sensitivity_lines(found), written)
    lost = (SensitivityStatus.NO_POSITION, SensitivityStatus.DEAD_POINT)
    if all(status in lost for status in found.statuses):
        context.exit(1)


# ----------------------------------------------------------------------
# ``linkwork tolerance``


@click.command("tolerance")
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
def tolerance_command(
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
    """Compute how tolerances and clearances affect a quantity.

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
        found = design.tolerance(
            mechanism, of, values, samples=samples, seed=seed, configuration=configuration
        )
    written = write_table(csv, found.table())
    if as_json:
        print_json(tolerance_data(found))
    elif csv != "-":
        print_page(tolerance_lines(found), written)
    if found.status is not SensitivityStatus.FOUND:
        context.exit(1)


# ----------------------------------------------------------------------
# ``linkwork design``


@click.command("design")
@file_argument
@click.option(
    "--flywheel", metavar="FRACTION", type=float, help="Inertia for this fluctuation of the speed."
)
@click.option(
    "--motor",
    metavar="STALL SPEED",
    nargs=2,
    help='Check a motor: torque at rest and speed without torque, as in 12 "1500 rpm".',
)
@click.option("--rated", metavar="TORQUE", type=float, help="What the motor gives without end.")
@click.option("--harmonics", metavar="QUANTITY", help="Fourier sum of a quantity over a turn.")
@click.option("--count", type=int, default=8, show_default=True, help="Number of harmonics.")
@click.option(
    "--counterweights",
    metavar="RADIUS",
    type=float,
    help="Remove the shaking force of a four-bar by weights at this radius.",
)
@click.option("--save", metavar="PATH", help="Write the mechanism with its counterweights.")
@click.option("--inflection", metavar="LINK", help="Inflection circle of a link, with --at.")
@at_option
@configuration_option
@set_option
@json_option
@debug_option
def design_command(
    file: str,
    at: tuple[str, ...],
    configuration: str | None,
    changes: tuple[str, ...],
    as_json: bool,
    **asked: Any,
) -> None:
    """Choose flywheel, motor and counterweights; harmonics and curvature.

    \b
      linkwork design press.toml --flywheel 0.05
      linkwork design press.toml --motor 900000 "1500 rpm" --rated 200000
      linkwork design press.toml --harmonics shaking.y
      linkwork design four-bar.toml --counterweights 20 --save balanced.toml
      linkwork design four-bar.toml --inflection coupler --at 60
    """
    if asked["rated"] is not None and not asked["motor"]:
        raise InputError("--rated belongs to --motor")
    if asked["save"] is not None and asked["counterweights"] is None:
        raise InputError("--save writes the mechanism with its --counterweights")
    check_outputs(file, asked["save"])
    mechanism = read_mechanism(file, changes)
    found = dict(_answers(mechanism, asked, input_values(mechanism, at), configuration))
    if not found:
        raise InputError(
            "nothing is asked: add --flywheel, --motor, --harmonics, --counterweights or "
            "--inflection"
        )
    written = []
    if asked["save"] is not None:
        design.balanced(mechanism, asked["counterweights"]).save(Path(asked["save"]))
        written = ["", f"Wrote {asked['save']}."]
    if as_json:
        print_json({name: _data(answer) for name, answer in found.items()})
        return
    lines = title_lines(mechanism.name)
    for answer in found.values():
        lines += ["", answer.summary.head, *fields(list(answer.summary.rows))]
    print_lines([*lines, *written])


def _answers(
    mechanism: Mechanism,
    asked: dict[str, Any],
    at: dict[str, float] | None,
    configuration: str | None,
) -> Iterator[tuple[str, Any]]:
    """Everything that is asked, by the name of its option."""
    motion: Motion | None = None
    if any(asked[name] for name in ("flywheel", "motor", "harmonics")):
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
    if asked["flywheel"] is not None:
        yield "flywheel", design.flywheel(mechanism, asked["flywheel"], motion=motion)
    if asked["motor"]:
        stall, speed = asked["motor"]
        yield (
            "motor",
            design.motor_check(
                mechanism,
                stall=_number(stall),
                free_speed=speed,
                rated=asked["rated"],
                motion=motion,
            ),
        )
    if asked["harmonics"] is not None:
        yield (
            "harmonics",
            design.harmonics(mechanism, asked["harmonics"], asked["count"], motion=motion),
        )
    if asked["counterweights"] is not None:
        with progress("balancing"):
            yield "counterweights", design.counterweights(mechanism, asked["counterweights"])
    if asked["inflection"] is not None:
        yield (
            "inflection",
            design.inflection_circle(
                mechanism, asked["inflection"], at, configuration=configuration
            ),
        )


def _number(text: str) -> float:
    number = number_or_formula(text)
    if isinstance(number, str):
        raise InputError(f'--motor needs a number for its torque, got "{text}"')
    return number


def _data(answer: Any) -> dict[str, Any]:
    """A result as JSON-ready data, with what follows from its fields."""
    follows = ("fits", "diameter", "center")
    own = {**vars(answer), **{n: getattr(answer, n) for n in follows if hasattr(answer, n)}}
    return {name: _plain(entry) for name, entry in own.items()}


def _plain(entry: Any) -> Any:
    if isinstance(entry, np.ndarray):
        return entry.tolist()
    if isinstance(entry, tuple):
        return [vars(each) if is_dataclass(each) else each for each in entry]
    return dict(entry) if hasattr(entry, "items") else entry
