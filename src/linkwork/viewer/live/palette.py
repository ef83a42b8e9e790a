"""Parts that the page can add: the fields of their forms, and a part from a filled-in form.

Tables and keys are those of mechanism files (:mod:`linkwork.textfile.keys`), so that whatever a
file can hold can be added; the reader judges what comes out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NoReturn

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.file_keys import Flag, Formula, Key, ListOf, Number, Tables, Text
from linkwork.mechanism.part.index import PARTS
from linkwork.viewer.live.events import PaletteField, PalettePart

__all__ = ["PALETTE", "Typed", "part_name", "part_of"]

#: What was typed or chosen: one entry, or several; a row of numbers or of a table is one line,
#: "10, 20".
Typed = str | tuple[str, ...]


def part_of(table: str, typed: Mapping[str, Typed]) -> dict[str, object]:
    """An entry of a table of parts from what was typed; what was left empty is left out.

    Raises
    ------
    InputError, UnknownNameError
        For a table or key that does not exist, and entries that are not what a key wants.
    """
    if table not in PARTS:
        raise UnknownNameError(f'there are no parts "{table}" {choices("parts", PARTS, table)}')
    keys = {key.name: key for key in PARTS[table].keys}
    for name in typed:
        if name not in keys:
            raise UnknownNameError(
                f'"{name}" is not a key of [[{table}]] {choices("keys", keys, name)}'
            )
    return {name: _entry(keys[name], entry) for name, entry in typed.items() if entry}


def part_name(row: Mapping[str, object]) -> str:
    """What an entry of a table of parts is called: its name, or the two links of a weld."""
    links = row.get("links")
    if isinstance(links, Sequence) and not isinstance(links, str):
        return " ".join(map(str, links))
    return str(row.get("name", ""))


def _field(key: Key) -> PaletteField:
    words: tuple[str, ...] = ()
    named: tuple[str, ...] = ()
    match key.kind:
        case Text(words, of):
            entry = "choice" if words else of or "text"
        case Number():
            entry = "number"
        case Formula():
            entry = "text"
        case Flag():
            entry = "flag"
        case ListOf(Text(), noun):
            entry = f"{noun}s"
        case ListOf(Number()):
            entry = "numbers"
        case ListOf():
            entry, named = "lines", ("x", "y")
        case Tables(keys):
            entry, named = "lines", tuple(column.name for column in keys)
        case _:
            raise TypeError(f"{key.name} cannot be entered on a page")
    return PaletteField(
        name=key.name, doc=key.doc, entry=entry, required=key.required, words=words, named=named
    )


#: Every kind of part, in the order of the tables of a file.
PALETTE: tuple[PalettePart, ...] = tuple(
    PalettePart(table=table, title=kind.title, doc=kind.doc, fields=tuple(map(_field, kind.keys)))
    for table, kind in PARTS.items()
)


def _entry(key: Key, typed: Typed) -> object:
    """What a key holds."""
    match key.kind:
        case ListOf(Text()):
            return list(_lines(key, typed))
        case ListOf(Number()):
            return [_number(word) for word in _words(" ".join(_lines(key, typed)))]
        case ListOf():
            return [[_number(word) for word in _words(line)] for line in _lines(key, typed)]
        case Tables(keys):
            return [_row(key, keys, line) for line in _lines(key, typed)]
    if not isinstance(typed, str):
        _refuse(key, "is one entry, got a list")
    match key.kind:
        case Number():
            return _number(typed)
        case Flag():
            if typed not in ("true", "false"):
                _refuse(key, f'must be true or false, got "{typed}"')
            return typed == "true"
        case _:
            return typed


def _row(key: Key, keys: Sequence[Key], line: str) -> dict[str, object]:
    """A row of a table from its words in order; those at the end may be left out."""
    words = _words(line)
    if len(words) > len(keys):
        named = " ".join(column.name for column in keys)
        _refuse(key, f'a line has {named}, got "{line}"')
    return {column.name: _entry(column, word) for column, word in zip(keys, words, strict=False)}


def _lines(key: Key, typed: Typed) -> tuple[str, ...]:
    if isinstance(typed, str):
        _refuse(key, f'must be a list, got "{typed}"')
    return tuple(line.strip() for line in typed if line.strip())


def _words(line: str) -> list[str]:
    """What commas separate, or blanks where there is none: formulas and laws may hold blanks."""
    return [word.strip() for word in line.split(",")] if "," in line else line.split()


def _number(word: str) -> float | int | str:
    """A number, or else a formula."""
    plain = word.strip().replace("\u2212", "-")
    try:
        value = float(plain)
    except ValueError:
        return plain
    if not math.isfinite(value):
        return plain  # the reader says what is wrong with it
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def _refuse(key: Key, message: str) -> NoReturn:
    raise InputError(f"{key.name}: {message}")
