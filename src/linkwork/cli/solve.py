"""``linkwork solve``"""

from __future__ import annotations

import math
from typing import Any

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
from linkwork.cli.position_page import position_lines
from linkwork.cli.terminal import print_json, print_lines, progress
from linkwork.foundation.errors import InputError
from linkwork.numerics.newton import NewtonOptions

__all__ = ["solve"]

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


@click.command
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
def solve(
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
