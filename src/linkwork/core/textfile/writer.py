"""Write mechanism files that read back as the same description."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwork.core.foundation.files import save_text
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loaded import LoadedBodies
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.textfile.keys import FORMAT

if TYPE_CHECKING:
    from tomlkit import TOMLDocument


_Tables = dict[str, dict[str, Any] | list[dict[str, Any]]]


def write_text(description: Description) -> str:
    """The mechanism as a TOML text; reads back as the same description.

    Numbers keep all digits, names their spelling and order; default values are omitted.
    """
    import tomlkit

    document = tomlkit.document()
    for key, entry in _head(description).items():
        document.add(key, entry)
    for name, table in _tables(description).items():
        _add(document, name, table)
    return tomlkit.dumps(document)


def write_tables(tables: Mapping[str, Any]) -> str:
    """Keys and tables as a TOML text: numbers and texts first, then tables and lists of tables."""
    import tomlkit

    document = tomlkit.document()
    nested = {
        name: entry
        for name, entry in tables.items()
        if isinstance(entry, dict)
        or (isinstance(entry, list) and entry and isinstance(entry[0], dict))
    }
    for name, entry in tables.items():
        if name not in nested:
            document.add(name, _plain(entry))
    for name, table in nested.items():
        _add(document, name, table)
    return tomlkit.dumps(document)


def part_lines(description: Description) -> list[tuple[str, str]]:
    """The links, parts, masses, loads and inputs of a file: the name of the table, its entries.

    Without the tables of numbers by name, equations, and what is asked about the mechanism.
    """
    found = []
    for name, given in _tables(description).items():
        if name in _NUMBERS:
            continue
        listed = given if isinstance(given, list) else [given]
        found += [(name, _line(table)) for table in listed if table]
    return found


_NUMBERS = ("dimensions", "points", "lengths", "angles", "loops", "equations", "trace", "questions")


def _line(entry: Any) -> str:
    """An entry in one line: ``link = crank, from = 0, to = 360``."""
    match entry:
        case dict():
            return ", ".join(
                f"{key} ({_line(each)})" if isinstance(each, dict) else f"{key} = {_line(each)}"
                for key, each in entry.items()
            )
        case list() | tuple():
            return f"[{', '.join(map(_line, entry))}]"
        case bool():
            return str(entry).lower()
        case _:
            return str(entry)


def save(description: Description, path: Path | str) -> None:
    """Write the mechanism to a file, completely or not at all.

    Raises
    ------
    InputError
        If the file cannot be written; an existing file is then unchanged.
    """
    save_text(write_text(description), path)


def _head(description: Description) -> dict[str, Any]:
    found: dict[str, Any] = {
        "format": FORMAT,
        "name": description.name,
        "length": description.length,
        "angle": description.angle.value,
    }
    for key in ("purpose", "source", "family", "configuration"):
        if text := getattr(description, key):
            found[key] = text
    if isinstance(description, LoadedBodies):
        usual = {"mass": LoadedBodies.mass, "force": LoadedBodies.force}
        own = {key: getattr(description, key) for key in usual}
        found |= {key: unit for key, unit in own.items() if unit != usual[key]}
    if isinstance(description, Linkage) and description.sketch:
        found["sketch"] = True
    return found


def _tables(description: Description) -> _Tables:
    """All tables that are not empty, in reading order."""
    found: _Tables = {"dimensions": dict(description.dimensions)}
    match description:
        case Linkage():
            for name in ("points", "links", "lengths", "angles"):
                found[name] = dict(getattr(description, name))
            for name in PARTS:
                found[name] = [_given(part) for part in getattr(description, name)]
            found |= _masses(description)
            given = description.friction.items()
            found["friction"] = {name: _given(friction) for name, friction in given}
            found |= _inputs(description)
        case Loops():
            found["loops"] = dict(description.loops)
            found["guess"] = dict(description.guess)
            found |= _inputs(description)
            found["points"] = dict(description.points)
            found["links"] = dict(description.links)
            found |= _masses(description)
            found["loads"] = [_given(load) for load in description.loads]
        case PlainEquations():
            found["equations"] = dict(description.equations)
            found["guess"] = dict(description.guess)
            found |= _inputs(description)
        case _:
            raise TypeError(f"a {type(description).__name__} has no file format")
    deviations = description.tolerances.items()
    found["tolerances"] = {name: {"deviation": number} for name, number in deviations}
    if isinstance(description, Linkage):
        found["clearances"] = dict(description.clearances)
    found["trace"] = {"points": description.trace} if description.trace else {}
    found["outputs"] = dict(description.outputs)
    found["questions"] = [_given(question) for question in description.questions]
    needed = ("guess",)  # the reader requires it even if there are no unknowns
    return {name: table for name, table in found.items() if table or name in needed}


def _masses(description: LoadedBodies) -> _Tables:
    masses = {link: _given(mass) for link, mass in description.masses.items()}
    gravity = description.gravity
    # a table without keys would be left out
    given = {} if gravity is None else {"size": gravity.size, **_given(gravity)}
    return {"gravity": given, "masses": masses, "stops": [_given(s) for s in description.stops]}


def _inputs(description: Description) -> _Tables:
    tables = [_input(which) for which in description.inputs]
    return {"input": tables[0] if len(tables) == 1 else tables}


def _input(which: Input) -> dict[str, Any]:
    renamed = {"from_": "from"}
    return {renamed.get(key, key): entry for key, entry in _given(which).items()}


def _given(part: Any) -> dict[str, Any]:
    """The fields of a part that are given and differ from their defaults."""
    usual = {field.name: field.default for field in fields(part)}
    names = {key.attribute: key.name for key in getattr(part, "keys", ())}
    return {
        names.get(key, key): _plain_entry(entry)
        for key, entry in vars(part).items()
        if entry is not None and entry != usual[key]
    }


def _plain_entry(entry: Any) -> Any:
    if isinstance(entry, tuple):
        return _rows(entry)
    return _given(entry) if is_dataclass(entry) else entry


def _rows(entry: tuple[Any, ...]) -> tuple[Any, ...]:
    """A list of tables in the order of the part."""
    return tuple(_given(each) if is_dataclass(each) else each for each in entry)


def _add(document: TOMLDocument, name: str, table: dict[str, Any] | list[dict[str, Any]]) -> None:
    import tomlkit

    document.add(tomlkit.nl())
    if isinstance(table, dict):
        document.add(name, _filled(table))
        return
    tables = tomlkit.aot()
    for each in table:
        tables.append(_filled(each))
    document.add(name, tables)


def _filled(entries: Mapping[str, Any]) -> Any:
    import tomlkit

    return _with_entries(tomlkit.table(), entries)


def _inline(entries: Mapping[str, Any]) -> Any:
    import tomlkit

    return _with_entries(tomlkit.inline_table(), entries)


def _with_entries(table: Any, entries: Mapping[str, Any]) -> Any:
    for key, entry in entries.items():
        table.add(key, _plain(entry))
    return table


def _plain(entry: Any) -> Any:
    """Convert tuples to lists and numbers of other packages to Python numbers."""
    match entry:
        case bool() | str() | int():
            return entry
        case list() | tuple():
            return [_plain(each) for each in entry]
        case dict():
            return _inline(entry)
        case _:
            return float(entry)
