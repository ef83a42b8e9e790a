"""List the entries of a mechanism file with their kinds, by the tables of its form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from linkwork.foundation.file_keys import (
    Formula,
    Key,
    Kind,
    ListOf,
    Named,
    Number,
    Table,
    Tables,
    TablesOrFormula,
    Text,
)

__all__ = ["Entry", "entries", "measured_by"]

Path = tuple[str | int, ...]


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A number, formula, name or flag at a key path; ``row``: the outermost table that has it.

    ``of``: what a name in it means: point, link, slider or name.
    """

    path: Path
    kind: Kind
    given: Any
    row: Mapping[str, Any]
    of: str = ""


def entries(
    data: Mapping[str, Any],
    keys: tuple[Key, ...],
    path: Path = (),
    row: Mapping[str, Any] | None = None,
) -> Iterator[Entry]:
    """All entries of a table with these keys; what does not match its kind is left out."""
    for key in keys:
        if key.name in data:
            own = (*path, key.name)
            yield from _inside(data[key.name], key.kind, own, data if row is None else row)


def measured_by(kind: Number, row: Mapping[str, Any]) -> str:
    """What a number in a row of a table measures: length, angle, number, or "" if unknown."""
    match kind.of:
        case "lift":
            return "angle" if "link" in row else "length"
        case "ranged" if "law" in row:
            return "number"
        case "driven" | "ranged":
            turns, slides = {"link", "joint"} & row.keys(), {"slider", "cylinder"} & row.keys()
            return "angle" if turns else "length" if slides else ""
        case "stiffness":
            return "length" if "links" in row else "per length"
        case "free":
            return "angle" if "links" in row else "length"
        case "named" | "varied":
            return ""
        case of:
            return of


def _inside(given: Any, kind: Kind, path: Path, row: Mapping[str, Any]) -> Iterator[Entry]:
    match kind:
        case Table(keys) if isinstance(given, Mapping):
            yield from entries(given, keys, path, given if len(path) == 1 else row)
        case Tables(keys) if isinstance(given, Mapping):
            yield from entries(given, keys, path, given)
        case TablesOrFormula() if isinstance(given, str):
            yield Entry(path=path, kind=Formula(), given=given, row=row)
        case Tables(keys) | TablesOrFormula(keys) if isinstance(given, list):
            for k, each in enumerate(given):
                if isinstance(each, Mapping):
                    yield from entries(each, keys, (*path, k), each if len(path) == 1 else row)
        case Named(of) if isinstance(given, Mapping):
            for name, each in given.items():
                yield from _inside(each, of, (*path, name), row)
        case ListOf(of, noun) if isinstance(given, list):
            for k, each in enumerate(given):
                for entry in _inside(each, of, (*path, k), row):
                    named = isinstance(entry.kind, Text) and not entry.of
                    yield replace(entry, of=noun) if named else entry
        case _:
            means = kind.of if isinstance(kind, Text) else ""
            yield Entry(path=path, kind=kind, given=given, row=row, of=means)
