"""The mechanism or task of a command: a file, a link or standard input, with changed numbers."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from linkwork.api import Mechanism, example_text, examples
from linkwork.cli.options import number_or_formula
from linkwork.foundation.errors import InputError, MechanismError
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.varied_number import numbers_named, with_numbers
from linkwork.textfile.link import is_link, source_text
from linkwork.textfile.reader import read_text
from linkwork.textfile.toml_text import text_of
from linkwork.viewer.live.task.templates import template_names, template_text

__all__ = [
    "mechanism_of",
    "names_to_copy",
    "read_mechanism",
    "shown_source",
    "text_of_source",
    "text_to_copy",
]


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


def names_to_copy() -> tuple[str, ...]:
    """The mechanisms of the library, and the tasks to begin with."""
    return (*examples(), *template_names())


def text_to_copy(name: str) -> str:
    """A mechanism of the library, or a task to begin with.

    Raises
    ------
    UnknownNameError
        If there is none of this name.
    """
    return template_text(name) if name in template_names() else example_text(name)


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
