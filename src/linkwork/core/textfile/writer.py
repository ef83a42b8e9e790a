"""Edit the text of a mechanism file in place, with its comments, order and spelling."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from linkwork.core.foundation.errors import InputError, UnknownNameError, key_text
from linkwork.core.foundation.files import save_text
from linkwork.core.foundation.names import canonical
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
from linkwork.core.textfile.toml_text import data_of

if TYPE_CHECKING:
    from tomlkit import TOMLDocument

#: Keys, and indices in lists: ``("points", "A", 0)``, ``("input", 0, "from")``.
KeyPath = tuple[str | int, ...]

_BOM = "\ufeff"


class TextEdits:
    """Edits of a TOML text.

    Names are found in any spelling (``theta2``, ``θ2``) and the points of a length in either
    order; a single ``[input]`` counts as the first of a list.

    Parameters
    ----------
    text : str
        A BOM and Windows line ends are kept.

    Raises
    ------
    MechanismFileError, InputError
        If the text is not TOML.
    """

    def __init__(self, text: str) -> None:
        import tomlkit

        self._bom = _BOM if text.startswith(_BOM) else ""
        plain = text.removeprefix(_BOM)
        # CRLF is kept only if the file uses it throughout
        self._line_end = "\r\n" if plain.count("\r\n") == plain.count("\n") > 0 else "\n"
        try:
            self._document: Any = tomlkit.parse(plain.replace("\r\n", "\n"))
        except tomlkit.exceptions.TOMLKitError as error:
            data_of(text, "the text")  # explains it with a remedy
            raise InputError(f"the text cannot be edited: {error}") from error

    @property
    def text(self) -> str:
        """The current text."""
        written: str = self._document.as_string()
        return self._bom + written.replace("\r\n", "\n").replace("\n", self._line_end)

    def has(self, path: KeyPath) -> bool:
        """Whether a key path exists."""
        return self._found(path) is not None

    def get(self, path: KeyPath) -> Any:
        """The value at a key path, as plain data.

        Raises
        ------
        UnknownNameError
            If the path does not exist.
        """
        holder, key = self._existing(path)
        entry = holder[key]
        return entry.unwrap() if hasattr(entry, "unwrap") else entry

    def keys(self, path: KeyPath) -> list[str]:
        """The keys of a table; none if it does not exist."""
        entry = self.get(path) if self.has(path) else {}
        return list(entry) if isinstance(entry, Mapping) else []

    def entries(self, table: str) -> Iterator[tuple[int, dict[str, Any]]]:
        """The entries of a ``[[table]]`` with their indices, as plain data; what is no table is
        left out.
        """
        found = self.get((table,)) if self.has((table,)) else []
        for k, entry in enumerate(found if isinstance(found, list) else [found]):
            if isinstance(entry, dict):
                yield k, entry

    def names(self, path: KeyPath) -> list[str]:
        """A list of names; none if there is no list."""
        found = self.get(path) if self.has(path) else None
        return [str(name) for name in found] if isinstance(found, list) else []

    def put(self, path: KeyPath, entry: Any) -> None:
        """Write a value; creates a missing table and keeps comments on the line.

        A table is written in one line.
        """
        place = self._found(path)
        if place is not None:
            holder, key = place
            # replacing the value in place keeps the comment after it
            holder[key] = _as_before(holder[key], entry)
            return
        holder = self._document
        for depth, part in enumerate(path[:-1]):
            nearest = self._found(path[: depth + 1])
            if nearest is None:
                self._new_table(holder, part, path)
                nearest = self._found(path[: depth + 1])
            assert nearest is not None
            holder = nearest[0][nearest[1]]
        if not path or not isinstance(path[-1], str):
            raise InputError(f"{key_text(path)} is not in the file: no value can be written there")
        holder.add(path[-1], _in_one_line(entry) if isinstance(entry, Mapping) else entry)

    def append(self, table: str, fields: Mapping[str, Any]) -> None:
        """Add an entry to a ``[[table]]``; a single ``[table]`` becomes its first entry."""
        import tomlkit

        new = tomlkit.table()
        for key, entry in fields.items():
            new.add(key, entry)
        if table in self._document:
            rows = self._document[table]
            if hasattr(rows, "append") and not isinstance(rows, Mapping):
                # a blank line between the entries
                if not rows[-1].as_string().endswith("\n\n"):
                    new.trivia.indent = "\n"
                rows.append(new)
                return
            if not isinstance(rows, tomlkit.items.Table):
                raise InputError(
                    f"{table} is a table in one line: write it as [[{table}]] to add more"
                )
            self._document[table] = _listed(rows, new)
            return
        rows = tomlkit.aot()
        rows.append(new)
        _end_with_blank_line(self._document)
        self._document.append(table, rows)

    def remove(self, path: KeyPath) -> None:
        """Remove the entry at a key path, and its table if that is then empty.

        Raises
        ------
        UnknownNameError
            If the path does not exist.
        """
        holder, key = self._existing(path)
        del holder[key]
        if len(path) > 1 and not len(holder) and holder is not self._document:
            self.remove(path[:-1])

    def rename(self, path: KeyPath, name: str) -> None:
        """Give the key at a path another name; its place and comments stay.

        Raises
        ------
        UnknownNameError
            If the path does not exist.
        """
        import tomlkit

        holder, key = self._existing(path)
        body = getattr(holder, "value", holder).body
        for k, (own, entry) in enumerate(body):
            if own is not None and own.key == key:
                written = own.as_string()  # with the blanks that align the equals signs
                blanks = written[len(written.rstrip()) :]
                body[k] = (tomlkit.items.SingleKey(name, sep=blanks + own.sep), entry)
        # indices by the old name are gone
        self._document = tomlkit.parse(self._document.as_string())

    def _existing(self, path: KeyPath) -> tuple[Any, Any]:
        found = self._found(path)
        if found is None:
            raise UnknownNameError(f"{key_text(path)} is not in the file")
        return found

    def _found(self, path: Sequence[str | int]) -> tuple[Any, Any] | None:
        """The container of an entry, and the entry's key in it."""
        holder: Any = None
        key: Any = None
        entry: Any = self._document
        for part in path:
            if part == 0 and isinstance(entry, Mapping):
                continue  # a single table
            own = _own_key(entry, part)
            if own is None:
                return None
            holder, key = entry, own
            entry = holder[own]
        return None if holder is None else (holder, key)

    def _new_table(self, holder: Any, name: str | int, path: KeyPath) -> None:
        import tomlkit

        if holder is not self._document or not isinstance(name, str):
            raise InputError(f"{key_text(path)} is not in the file: no value can be written there")
        _end_with_blank_line(self._document)
        self._document.append(name, tomlkit.table())


def _own_key(entry: Any, part: str | int) -> Any:
    """The matching key of a table or index of a list; ``None`` if there is none."""
    if isinstance(part, int):
        listed = isinstance(entry, Sequence) and not isinstance(entry, str)
        return part if listed and part < len(entry) else None
    if not isinstance(entry, Mapping):
        return None
    if part in entry:
        return part
    words = [canonical(word) for word in part.split()]
    # lengths may name their two points in either order
    orders = [words, words[::-1]] if len(words) == 2 else [words]
    for key in entry:
        if [canonical(word) for word in str(key).split()] in orders:
            return str(key)
    return None


def _as_before(old: Any, entry: Any) -> Any:
    """Keep integers as integers, and the unchanged coordinate of a pair as written."""
    plain = old.unwrap() if hasattr(old, "unwrap") else old
    if isinstance(entry, float) and isinstance(plain, int) and entry.is_integer():
        return int(entry)
    return entry


def _in_one_line(entry: Mapping[str, Any]) -> Any:
    import tomlkit

    line = tomlkit.inline_table()
    line.update(entry)
    # with blanks inside the braces, as files are written by hand
    return tomlkit.parse(f"row = {{ {line.as_string()[1:-1]} }}")["row"]


def _end_with_blank_line(document: Any) -> None:
    import tomlkit

    text = document.as_string()
    if text and not text.endswith("\n\n"):
        document.add(tomlkit.nl())
        if not text.endswith("\n"):
            document.add(tomlkit.nl())


def _listed(single: Any, added: Any) -> Any:
    """A single table and another as a list of tables; comments stay."""
    import tomlkit

    first = tomlkit.table()
    first.trivia.comment_ws, first.trivia.comment = (
        single.trivia.comment_ws,
        single.trivia.comment,
    )
    body = list(single.value.body)
    while body and isinstance(body[-1][1], tomlkit.items.Whitespace):
        added.add(body.pop()[1])
    for key, entry in body:
        first.value.append(key, entry)
    added.trivia.indent = "\n"
    rows = tomlkit.aot()
    rows.append(first)
    rows.append(added)
    return rows


# ----------------------------------------------------------------------
# Write mechanism files that read back as the same description.


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
