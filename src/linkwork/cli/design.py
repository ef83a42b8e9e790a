"""``linkwork design``"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import is_dataclass
from pathlib import Path
from typing import Any

import click
import numpy as np

from linkwork.api import Mechanism
from linkwork.cli.mechanism_source import read_mechanism
from linkwork.cli.options import (
    at_option,
    configuration_option,
    debug_option,
    file_argument,
    input_values,
    json_option,
    number_or_formula,
    set_option,
)
from linkwork.cli.output_file import check_outputs
from linkwork.cli.terminal import fields, print_json, print_lines, progress, title_lines
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion

__all__ = ["design"]


@click.command
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
def design(
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
        mechanism.balanced(asked["counterweights"]).save(Path(asked["save"]))
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
        yield "flywheel", mechanism.flywheel(asked["flywheel"], motion=motion)
    if asked["motor"]:
        stall, speed = asked["motor"]
        yield (
            "motor",
            mechanism.motor_check(
                stall=_number(stall), free_speed=speed, rated=asked["rated"], motion=motion
            ),
        )
    if asked["harmonics"] is not None:
        yield "harmonics", mechanism.harmonics(asked["harmonics"], asked["count"], motion=motion)
    if asked["counterweights"] is not None:
        with progress("balancing"):
            yield "counterweights", mechanism.counterweights(asked["counterweights"])
    if asked["inflection"] is not None:
        yield (
            "inflection",
            mechanism.inflection_circle(asked["inflection"], at, configuration=configuration),
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
