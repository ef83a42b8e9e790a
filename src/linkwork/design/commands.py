"""Commands on sensitivities, tolerances and machine design."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
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
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.listing import Column, short, significant
from linkwork.core.results.motion import Motion
from linkwork.design.sensitivities import is_of_motion
from linkwork.design.tolerance_results import (
    Sensitivity,
    SensitivityStatus,
    Tolerance,
    contribution_columns,
    tolerance_fields,
)

# ----------------------------------------------------------------------
# Sensitivities and tolerances as pages of text.


def sensitivity_lines(result: Sensitivity) -> list[str]:
    """The derivatives by number, the largest first."""
    lines, rows = title_lines(result.mechanism), result.value.ndim > 0
    where = f"in {len(result)} positions" if rows else result.where and f"at {result.where}"
    counts = Counter(result.statuses)
    found = counts.pop(SensitivityStatus.FOUND, 0)
    if rows or found:
        lines += sentence(good, f"Sensitivity of {result.of}", where)
    else:
        lines += sentence(bad, f"No sensitivity of {result.of}", where)
        lines += fields([("why", result.status.value)])
        if result.status is not SensitivityStatus.CORNER:
            return lines
    if rows:
        others = [(status.label, f"{count}: {status.value}") for status, count in counts.items()]
        lines += fields([("found", str(found)), *others])
    else:
        lines += fields([("value", f"{short(float(result.value))} {result.unit}".rstrip())])
    names = result.effective
    if names:
        lines += ["", *_table(result, names, rows)]
    rest = len(result.derivatives) - len(names)
    notes = list(_notes(result, rest))
    return [*lines, "", *fields(notes)] if notes else lines


def _notes(sensitivity: Sensitivity, rest: int) -> Iterator[tuple[str, str]]:
    if rest:
        plural = "numbers have" if rest > 1 else "number has"
        yield "others", f"{rest} more {plural} no effect"
    reasons: dict[str, list[str]] = {}
    for name, why in sensitivity.refused.items():
        reasons.setdefault(why, []).append(name)
    for why, names in reasons.items():
        yield "refused", f"{', '.join(names)}: {why}"


def _table(sensitivity: Sensitivity, names: tuple[str, ...], rows: bool) -> list[str]:
    units = [sensitivity.unit_by(name) for name in names]
    columns = [
        Column(header="number", cells=list(names)),
        Column(
            header="value",
            cells=[short(sensitivity.numbers[name]) for name in names],
            align="point",
            units=[sensitivity.units[name] for name in names],
        ),
    ]
    shown: dict[str, Callable[[Array], Any]] = {"derivative": np.asarray}
    if rows:
        shown = {"smallest": np.fmin.reduce, "largest": np.fmax.reduce}
    for header, of_rows in shown.items():
        cells = [significant(float(of_rows(sensitivity.derivatives[name]))) for name in names]
        columns.append(Column(header=header, cells=cells, align="point", units=units))
    return table_lines(columns)


def sensitivity_data(sensitivity: Sensitivity) -> dict[str, Any]:
    """The derivatives as JSON-ready data."""
    return {
        "mechanism": sensitivity.mechanism,
        "of": sensitivity.of,
        "unit": sensitivity.unit,
        "status": [status.name for status in sensitivity.statuses],
        "inputs": {name: np.asarray(value).tolist() for name, value in sensitivity.inputs.items()},
        "value": sensitivity.value.tolist(),
        "derivatives": {name: rates.tolist() for name, rates in sensitivity.derivatives.items()},
        "units": {name: sensitivity.unit_by(name) for name in sensitivity.derivatives},
        "refused": dict(sensitivity.refused),
    }


def tolerance_lines(tolerance: Tolerance) -> list[str]:
    """Worst case, root sum square, and the share of each number and pin."""
    where = f"at {tolerance.where}" if tolerance.where else ""
    is_found = tolerance.status is SensitivityStatus.FOUND
    style, head = (good, "Tolerance") if is_found else (bad, "No tolerance")
    lines = [
        *title_lines(tolerance.mechanism),
        *sentence(style, f"{head} of {tolerance.of}", where),
        *fields(tolerance_fields(tolerance)),
    ]
    return [*lines, "", *table_lines(contribution_columns(tolerance))] if is_found else lines


def tolerance_data(tolerance: Tolerance) -> dict[str, Any]:
    """The tolerance as JSON-ready data."""
    return {
        "mechanism": tolerance.mechanism,
        "of": tolerance.of,
        "unit": tolerance.unit,
        "inputs": dict(tolerance.inputs),
        "status": tolerance.status.name,
        "value": tolerance.value,
        "worst_case": tolerance.worst_case,
        "root_sum_square": tolerance.root_sum_square,
        "contributions": [asdict(part) for part in tolerance.contributions],
        "sampled": None if tolerance.sampled is None else asdict(tolerance.sampled),
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
        result = design.sensitivity(
            mechanism, of, values, by=by or None, configuration=configuration, motion=motion
        )
    written = write_table(csv, result.table())
    if as_json:
        print_json(sensitivity_data(result))
    elif csv != "-":
        print_page(sensitivity_lines(result), written)
    lost = (SensitivityStatus.NO_POSITION, SensitivityStatus.DEAD_POINT)
    if all(status in lost for status in result.statuses):
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
        result = design.tolerance(
            mechanism, of, values, samples=samples, seed=seed, configuration=configuration
        )
    written = write_table(csv, result.table())
    if as_json:
        print_json(tolerance_data(result))
    elif csv != "-":
        print_page(tolerance_lines(result), written)
    if result.status is not SensitivityStatus.FOUND:
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
    **options: Any,
) -> None:
    """Choose flywheel, motor and counterweights; harmonics and curvature.

    \b
      linkwork design press.toml --flywheel 0.05
      linkwork design press.toml --motor 900000 "1500 rpm" --rated 200000
      linkwork design press.toml --harmonics shaking.y
      linkwork design four-bar.toml --counterweights 20 --save balanced.toml
      linkwork design four-bar.toml --inflection coupler --at 60
    """
    if options["rated"] is not None and not options["motor"]:
        raise InputError("--rated belongs to --motor")
    if options["save"] is not None and options["counterweights"] is None:
        raise InputError("--save writes the mechanism with its --counterweights")
    check_outputs(file, options["save"])
    mechanism = read_mechanism(file, changes)
    answers = _answers(mechanism, options, input_values(mechanism, at), configuration)
    if not answers:
        raise InputError(
            "no option is set: add --flywheel, --motor, --harmonics, --counterweights or "
            "--inflection"
        )
    written = []
    if options["save"] is not None:
        design.balanced(mechanism, options["counterweights"]).save(Path(options["save"]))
        written = ["", f"Wrote {options['save']}."]
    if as_json:
        print_json({name: _data(answer) for name, answer in answers.items()})
        return
    lines = title_lines(mechanism.name)
    for answer in answers.values():
        lines += ["", answer.summary.head, *fields(list(answer.summary.rows))]
    print_lines([*lines, *written])


def _answers(
    mechanism: Mechanism,
    options: Mapping[str, Any],
    at: dict[str, float] | None,
    configuration: str | None,
) -> dict[str, Any]:
    """The requested results by the names of their options."""
    given = {name: value for name, value in options.items() if value not in (None, ())}
    motion: Motion | None = None
    if given.keys() & {"flywheel", "motor", "harmonics"}:
        with progress("sweeping") as tell:
            motion = mechanism.sweep(configuration=configuration, progress=tell)
    answers: dict[str, Callable[[Any], Any]] = {
        "flywheel": lambda value: design.flywheel(mechanism, value, motion=motion),
        "motor": lambda value: design.motor_check(
            mechanism,
            stall=_number(value[0]),
            free_speed=value[1],
            rated=options["rated"],
            motion=motion,
        ),
        "harmonics": lambda of: design.harmonics(mechanism, of, options["count"], motion=motion),
        "counterweights": lambda radius: design.counterweights(mechanism, radius),
        "inflection": lambda link: design.inflection_circle(
            mechanism, link, at, configuration=configuration
        ),
    }
    with progress("computing"):
        return {name: answer(given[name]) for name, answer in answers.items() if name in given}


def _number(text: str) -> float:
    number = number_or_formula(text)
    if isinstance(number, str):
        raise InputError(f'--motor needs a number for its torque, got "{text}"')
    return number


def _data(answer: Any) -> dict[str, Any]:
    """A result as JSON-ready data, with its derived properties."""
    follows = ("fits", "diameter", "center")
    entries = {**vars(answer), **{n: getattr(answer, n) for n in follows if hasattr(answer, n)}}
    return {name: _json_entry(entry) for name, entry in entries.items()}


def _json_entry(entry: Any) -> Any:
    if isinstance(entry, np.ndarray):
        return entry.tolist()
    if isinstance(entry, tuple):
        return [vars(each) if is_dataclass(each) else each for each in entry]
    return dict(entry) if hasattr(entry, "items") else entry
