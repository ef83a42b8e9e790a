"""Write mechanism files that read back as the same description."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwork.core.foundation.files import save_text
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.foundation.values import (
    Constant,
    Key,
    Kind,
    Named,
    Table,
    Tables,
    TablesOrFormula,
)
from linkwork.core.mechanism.description import Description
from linkwork.core.textfile.keys import FORMS

if TYPE_CHECKING:
    from tomlkit import TOMLDocument


def write_text(description: Description) -> str:
    """The mechanism as a TOML text; reads back as the same description.

    Numbers keep all digits, names their spelling and order; default values are omitted.
    """
    return write_tables(_content(description))


def write_tables(tables: Mapping[str, Any]) -> str:
    """Keys and tables as a TOML text: numbers and texts first, then tables and lists of tables."""
    import tomlkit

    document = tomlkit.document()
    for name, entry in tables.items():
        if not _is_table(entry):
            document.add(name, _plain(entry))
    for name, table in tables.items():
        if _is_table(table):
            _add(document, name, table)
    return tomlkit.dumps(document)


def _is_table(entry: object) -> bool:
    """Whether an entry is a table or a list of tables."""
    return isinstance(entry, dict) or (
        isinstance(entry, list) and bool(entry) and isinstance(entry[0], dict)
    )


def part_lines(description: Description) -> list[tuple[str, str]]:
    """The links, parts, masses, loads and inputs of a file: the name of the table, its entries.

    Without the tables of numbers by name, equations, and what is asked about the mechanism.
    """
    found = []
    for name, given in _content(description).items():
        if name in _NUMBERS or not _is_table(given):
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


#: Keys that are written whatever their value is.
_ALWAYS = ("name", "length", "angle", "size")


def _content(description: Description) -> dict[str, Any]:
    """The keys of a file with their values, in the order of its form."""
    form = next(form for form in FORMS if isinstance(description, form.made))  # type: ignore[arg-type]
    return _given(description, form.keys)


def _given(owner: Any, keys: Iterable[Key]) -> dict[str, Any]:
    """The values of an object that are given and differ from their defaults."""
    usual = {field.name: field.default for field in fields(owner)}
    found = {}
    for key in keys:
        entry = key.kind.number if isinstance(key.kind, Constant) else getattr(owner, key.attribute)
        always = key.required or key.name in _ALWAYS
        if entry is not None and (always or entry != usual[key.attribute]):
            found[key.name] = _written(entry, key.kind)
    return found


def _written(entry: Any, kind: Kind) -> Any:
    """A value as it is written in a file."""
    match kind:
        case Table(keys):
            if not is_dataclass(entry):  # of one key
                return {keys[0].name: entry}
            return _given(entry, keys)
        case Tables(keys, single):
            tables = [_given(each, keys) for each in entry]
            return tables[0] if single and len(tables) == 1 else tables
        case TablesOrFormula(keys) if not isinstance(entry, str):
            return [_given(each, keys) for each in entry]
        case Named(of):
            return {name: _written(each, of) for name, each in entry.items()}
        case _:
            return entry.value if isinstance(entry, AngleUnit) else entry


def _add(document: TOMLDocument, name: str, table: dict[str, Any] | list[dict[str, Any]]) -> None:
    import tomlkit

    document.add(tomlkit.nl())
    if isinstance(table, dict):
        document.add(name, _filled(tomlkit.table(), table))
        return
    tables = tomlkit.aot()
    for each in table:
        tables.append(_filled(tomlkit.table(), each))
    document.add(name, tables)


def _filled(table: Any, entries: Mapping[str, Any]) -> Any:
    for key, entry in entries.items():
        table.add(key, _plain(entry))
    return table


def _plain(entry: Any) -> Any:
    """Convert tuples to lists and numbers of other packages to Python numbers."""
    import tomlkit

    match entry:
        case bool() | str() | int():
            return entry
        case list() | tuple():
            return [_plain(each) for each in entry]
        case dict():
            return _filled(tomlkit.inline_table(), entry)
        case _:
            return float(entry)
