"""The mechanism of a command: read from a file or standard input, with changed dimensions."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from linkwork.api import Mechanism, example_text, examples
from linkwork.cli.options import number_or_formula
from linkwork.foundation.errors import InputError, MechanismError
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.varied_number import numbers_named, with_numbers
from linkwork.textfile.reader import ReadFile, read_bytes, read_file, read_text

__all__ = ["read_mechanism"]


def read_mechanism(file: str, changes: tuple[str, ...] = ()) -> Mechanism:
    """The mechanism of FILE (``-``: standard input; a name of the library) with the numbers of
    ``--set``.

    Raises
    ------
    InputError
        If the file does not exist or has errors, or a dimension does not exist.
    """
    read = _read(file)
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


def _read(file: str) -> ReadFile:
    if file == "-":
        if sys.stdin is None:
            raise InputError("there is no standard input to read a mechanism from")
        return read_bytes(sys.stdin.buffer.read())
    path = Path(file)
    if not path.exists() and file in examples():
        return read_text(example_text(file), file)
    if not path.exists() and path.parent == Path() and path.stem in examples():
        raise InputError(
            f'there is no file "{file}"; to copy the example of this name:\n'
            f"    linkwork examples {path.stem} -o {path.stem}.toml"
        )
    return read_file(path)


def _changes(texts: tuple[str, ...]) -> Iterator[tuple[str, Number]]:
    for text in texts:
        name, equals, number = text.partition("=")
        if not (name.strip() and equals and number.strip()):
            raise InputError(
                f"--set {text}: write the name of a number and its value, as in --set a2=260 or "
                '--set "O2 A=38"'
            )
        yield name.strip(), number_or_formula(number)
