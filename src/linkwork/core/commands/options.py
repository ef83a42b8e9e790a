"""Options of commands, and the files that they read and write."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import click

from linkwork import wings
from linkwork.core import drawing
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.commands.terminal import Decorator
from linkwork.core.foundation.errors import ExpressionError, InputError, MechanismError
from linkwork.core.foundation.files import save_pieces
from linkwork.core.foundation.statuses import ChangePointPolicy
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.varied_numbers import numbers_named, with_numbers
from linkwork.core.results.tables import Table, csv_lines
from linkwork.core.textfile.link import is_link, source_text
from linkwork.core.textfile.reader import example_text, examples, read_text
from linkwork.core.textfile.toml_text import text_of

# ----------------------------------------------------------------------
# Options and arguments that several commands share.


def number_or_formula(text: str) -> float | str:
    """The number in a text; if it is not a number, the text itself as a formula."""
    try:
        return float(text)
    except ValueError:
        return text.strip()


file_argument: Decorator = click.argument("file", metavar="FILE")


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


def _change_points(about: str, policies: Iterable[ChangePointPolicy]) -> Decorator:
    return click.option(
        "--change-points",
        type=click.Choice([policy.value for policy in policies]),
        default=ChangePointPolicy.STOP.value,
        show_default=True,
        help=f"At a change point: {about}.",
    )


change_points_option = _change_points(
    "stop, go straight on, or turn onto the other branch", ChangePointPolicy
)
straight_option = _change_points(
    "stop, or go straight on", (ChangePointPolicy.STOP, ChangePointPolicy.STRAIGHT)
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
    about = {
        "step": "Step between input values.",
        "to": "Last input value.",
        "from_": "First input value, in the file's unit.",
    }
    for name, said in about.items():
        flag = f"--{name.rstrip('_')}"
        option = click.option(flag, name, metavar="NUMBER", type=number_or_formula, help=said)
        command = option(command)
    return command


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


def forces_of(mechanism: Mechanism, asked: tuple[str, ...]) -> tuple[drawing.Force, ...]:
    """The forces of ``--force``.

    Raises
    ------
    InputError
        If a force is not a point with two components, or units differ.
    UnknownNameError
        If the mechanism has no such point.
    """
    forces = tuple(map(_force, asked))
    drawing.check_forces(forces, mechanism.model.compiled.points.names)
    return forces


_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_FORCE = re.compile(rf"\s*(.+?)\s*=\s*{_NUMBER}\s*,\s*{_NUMBER}\s*([^\W\d].*?)?\s*")


def _force(text: str) -> drawing.Force:
    match = _FORCE.fullmatch(text)
    if match is None:
        raise InputError(
            f'--force {text}: a force is a point and two components, --force "C=0,-981 N"'
        )
    name, x, y, unit = match.groups()
    return drawing.Force(at=name, x=float(x), y=float(y), unit=unit or "")


# ----------------------------------------------------------------------
# Output files: written completely or not at all, and never over the mechanism file.


def check_outputs(
    source: str, *outputs: str | None, workbook: str | None = None, as_json: bool = False
) -> None:
    """Reject files that cannot be written, before any computation.

    ``as_json``: standard output is taken.

    Raises
    ------
    InputError
        If a folder is missing, two outputs are the same file, an output is the mechanism file
        itself, the suffix belongs to another kind of file, or standard output is taken.
    """
    if as_json and "-" in outputs:
        raise InputError("--json and --csv - both use standard output: name a file for the table")
    if workbook is not None and Path(workbook).suffix.lower() != ".xlsx":
        raise InputError(f'cannot write "{workbook}": a workbook needs the suffix .xlsx')
    taken = {} if source == "-" else {_real(source): f'"{source}" is the mechanism file itself'}
    for name in (*outputs, workbook):
        if name is None or name == "-":
            continue
        path = Path(name)
        if name is not workbook and path.suffix.lower() in (".xlsx", ".xls", ".ods"):
            raise InputError(
                f'cannot write "{name}": tables are CSV files, use the suffix .csv; '
                "linkwork sweep writes workbooks with --xlsx"
            )
        if path.is_dir():
            raise InputError(f'cannot write "{name}": it is a folder')
        if not path.parent.is_dir():
            raise InputError(f'cannot write "{name}": there is no folder "{path.parent}"')
        # links are followed, so that two names of one file are found
        real = _real(name)
        if real in taken:
            raise InputError(f"{taken[real]}: write to another file")
        taken[real] = f'"{name}" is named twice'


def write_table(name: str | None, table: Table) -> list[str]:
    """Write a table as CSV to a file or, for ``-``, to standard output; returns a line about it."""
    if name is None:
        return []
    if name == "-":
        for line in csv_lines(table):
            click.echo(line, nl=False)
        return []
    write_text(name, csv_lines(table))
    return [f"Wrote {name}: {len(next(iter(table.columns.values())))} rows."]


def write_text(name: str, pieces: Iterable[str]) -> None:
    """Write UTF-8 text to a file; follow links, write to devices.

    Raises
    ------
    InputError
        If the file cannot be written; its former content is kept.
    """
    write_bytes(name, (piece.encode() for piece in pieces))


def write_bytes(name: str, pieces: Iterable[bytes]) -> None:
    """Write bytes to a file; follow links, write to devices.

    Raises
    ------
    InputError
        If the file cannot be written; its former content is kept.
    """
    save_pieces(pieces, name)


def _real(name: str) -> str:
    return os.path.realpath(name)


# ----------------------------------------------------------------------
# The mechanism or task of a command: a file, a link or standard input, with changed numbers.


def read_mechanism(file: str, changes: tuple[str, ...] = ()) -> Mechanism:
    """The mechanism of FILE, as :func:`text_of_source` finds it, with the numbers of ``--set``.

    Raises
    ------
    InputError
        If the file does not exist or has errors, or a dimension does not exist.
    """
    return mechanism_of(*text_of_source(file), changes)


def text_of_source(file: str) -> tuple[str, str]:
    """The text of FILE (``-``: standard input; a name of the library or of a task to begin with; a
    link), and its name.

    Raises
    ------
    InputError
        If there is no such file, or it is not text.
    """
    if file == "-":
        if sys.stdin is None:
            raise InputError("there is no standard input to read from")
        return text_of(sys.stdin.buffer.read(), "standard input"), "standard input"
    path = Path(file)
    there = os.path.exists(file)  # a long name is an error for Path.exists
    if not there and file in names_to_copy():
        return text_to_copy(file), file
    if not there and path.parent == Path() and path.stem in names_to_copy():
        raise InputError(
            f'there is no file "{file}"; to copy the example of this name:\n'
            f"    linkwork examples {path.stem} -o {path.stem}.toml"
        )
    return source_text(file)


def names_to_copy() -> Iterator[str]:
    """The mechanisms of the library, and the tasks to begin with."""
    yield from examples()
    yield from wings.use("synthesis.tasks.templates").template_names()


def text_to_copy(name: str) -> str:
    """A mechanism of the library, or a task to begin with.

    Raises
    ------
    UnknownNameError
        If there is none of this name.
    """
    if name in examples() or name not in names_to_copy():
        return example_text(name)
    return wings.use("synthesis.tasks.templates").template_text(name)


def mechanism_of(text: str, name: str, changes: tuple[str, ...] = ()) -> Mechanism:
    """The mechanism of a text, with the numbers of ``--set``; raises like `read_mechanism`."""
    read = read_text(text, name)
    if not changes:
        return Mechanism(read.description, read)
    try:
        # without the file, whose lines no longer match these numbers
        numbers = numbers_named(read.description, _changes(changes))
        return Mechanism(with_numbers(read.description, numbers))
    except MechanismError as error:
        located = read.located(error)
        where = f"{located.where} with {', '.join(changes)}"
        raise type(located)(located.problems, where) from None


def shown_source(file: str) -> str:
    """FILE as a suggested command names it: a link is too long to repeat."""
    return "LINK" if is_link(file) and not os.path.exists(file) else file


def _changes(texts: tuple[str, ...]) -> Iterator[tuple[str, Number]]:
    for text in texts:
        name, equals, number = text.partition("=")
        if not (name.strip() and equals and number.strip()):
            raise InputError(
                f"--set {text}: write the name of a number and its value, as in --set a2=260 or "
                '--set "O2 A=38"'
            )
        yield name.strip(), number_or_formula(number)
