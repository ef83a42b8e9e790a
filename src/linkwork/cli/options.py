"""Options and arguments that several commands share."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import click

from linkwork.api import Mechanism
from linkwork.foundation.errors import ExpressionError, InputError
from linkwork.foundation.policy import ChangePointPolicy
from linkwork.results.force import Force, check_forces

__all__ = [
    "DEBUG",
    "JSON",
    "NUMBER",
    "at_option",
    "change_points_option",
    "columns_option",
    "configuration_option",
    "debug_option",
    "file_argument",
    "force_option",
    "forces_of",
    "input_values",
    "json_option",
    "number_or_formula",
    "of_option",
    "range_options",
    "set_option",
    "straight_option",
    "through_option",
]

#: Key of ``click.Context.meta`` that stores ``--debug``.
DEBUG = "linkwork.debug"
#: Key that stores ``--json``.
JSON = "linkwork.json"

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def number_or_formula(text: str) -> float | str:
    """The number in a text; if it is not a number, the text itself as a formula."""
    try:
        return float(text)
    except ValueError:
        return text.strip()


class _Number(click.ParamType):  # type: ignore[type-arg]  # generic since click 8.4 only
    """A number, or a formula of the file's dimensions."""

    name = "number"

    def convert(self, value: Any, param: Any, ctx: Any) -> float | str:
        """A number, or the text of a formula, which is checked once the mechanism is read."""
        return number_or_formula(value) if isinstance(value, str) else float(value)


NUMBER = _Number()


def _note_debug(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        context.meta[DEBUG] = True


debug_option: Decorator = click.option(
    "--debug",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_note_debug,
    help="Show the traceback of an error.",
)

file_argument: Decorator = click.argument("file", metavar="FILE")


def _note_json(context: click.Context, _: click.Parameter, wanted: bool) -> bool:
    context.meta[JSON] = wanted
    return wanted


json_option: Decorator = click.option(
    "--json", "as_json", is_flag=True, is_eager=True, callback=_note_json, help="Print JSON."
)

set_option: Decorator = click.option(
    "--set",
    "changes",
    metavar="NAME=VALUE",
    multiple=True,
    help="Replace a dimension, length or other number; may be repeated.",
)

at_option: Decorator = click.option(
    "--at",
    "at",
    metavar="VALUE",
    multiple=True,
    help="Input value in the file's unit; NAME=VALUE for each of several inputs. "
    "Default: the input value of the file's guess or sketch.",
)


of_option: Decorator = click.option(
    "--of",
    metavar="NAME",
    required=True,
    help="The quantity, or a number of the whole motion; `linkwork quantities FILE` lists them.",
)

configuration_option: Decorator = click.option(
    "--configuration",
    metavar="NAME",
    help="Start from this configuration or branch instead of the guess's; "
    "`linkwork configurations` and `linkwork circuits` list them.",
)


through_option: Decorator = click.option(
    "--through", is_flag=True, help="Continue through dead points around the circuit."
)

change_points_option: Decorator = click.option(
    "--change-points",
    type=click.Choice([policy.value for policy in ChangePointPolicy]),
    default=ChangePointPolicy.STOP.value,
    show_default=True,
    help="At a change point: stop, go straight on, or turn onto the other branch.",
)
straight_option: Decorator = click.option(
    "--change-points",
    type=click.Choice([ChangePointPolicy.STOP.value, ChangePointPolicy.STRAIGHT.value]),
    default=ChangePointPolicy.STOP.value,
    show_default=True,
    help="At a change point: stop, or go straight on.",
)


force_option: Decorator = click.option(
    "--force",
    "forces",
    metavar='POINT="X,Y N"',
    multiple=True,
    help="Draw a force at a point, given by components and unit; may be repeated.",
)


def columns_option(about: str) -> Decorator:
    """``--columns``, which is ``--of`` too."""
    about += " Repeatable; `linkwork quantities FILE` lists the names."
    return click.option("--columns", "--of", "names", metavar="NAME", multiple=True, help=about)


def range_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``--from``, ``--to`` and ``--step`` of a sweep."""
    command = click.option("--step", type=NUMBER, help="Step between input values.")(command)
    command = click.option("--to", "stop", type=NUMBER, help="Last input value.")(command)
    first = "First input value, in the file's unit."
    return click.option("--from", "start", type=NUMBER, help=first)(command)


def input_values(mechanism: Mechanism, asked: tuple[str, ...]) -> dict[str, float] | None:
    """The input values of ``--at`` by name; ``None`` if there are none.

    Raises
    ------
    InputError
        If a value is not a number, is given twice, or does not name one of several inputs.
    """
    if not asked:
        return None
    names = [variable.name for variable in mechanism.loop_equations.inputs]
    if not names:
        raise InputError(f'"{mechanism.name}" has no input: leave out --at')
    found: dict[str, float] = {}
    for text in asked:
        name, equals, number = text.rpartition("=")
        name = name.strip() if equals else names[0]
        if not equals and len(names) > 1:
            each = " ".join(f"--at {name}=…" for name in names)
            raise InputError(
                f'--at {text}: "{mechanism.name}" has {len(names)} inputs, name each: {each}'
            )
        if name in found:
            raise InputError(f"--at {text}: {name} has a value already, {found[name]:g}")
        try:
            found[name] = mechanism.description.numbers(number_or_formula(number))
        except ExpressionError as error:
            raise InputError(f"--at {text}: {error}") from None
    return found


def forces_of(mechanism: Mechanism, asked: tuple[str, ...]) -> tuple[Force, ...]:
    """The forces of ``--force``.

    Raises
    ------
    InputError
        If a force is not a point with two components, or units differ.
    UnknownNameError
        If the mechanism has no such point.
    """
    forces = tuple(map(_force, asked))
    check_forces(forces, mechanism.model.compiled.points.names)
    return forces


_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_FORCE = re.compile(rf"\s*(.+?)\s*=\s*{_NUMBER}\s*,\s*{_NUMBER}\s*([^\W\d].*?)?\s*")


def _force(text: str) -> Force:
    match = _FORCE.fullmatch(text)
    if match is None:
        raise InputError(
            f'--force {text}: a force is a point and two components, --force "C=0,-981 N"'
        )
    name, x, y, unit = match.groups()
    return Force(at=name, x=float(x), y=float(y), unit=unit or "")
