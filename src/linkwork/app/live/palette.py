"""Parts that the page can add: fields of the forms, and conversion of a completed form to a part.

Tables and keys are those of mechanism files (:mod:`linkwork.core.textfile.keys`), so every kind of
part of a file can be added; the file reader checks the result.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import NoReturn

from linkwork.app.live.drawn_parts import picks_of
from linkwork.app.live.file_state import PaletteField, PalettePart, PartShown
from linkwork.app.live.number_edits import TypedUnits
from linkwork.app.live.requests import Edit, RemoveLink, RemovePart, RemovePoint, SetPart, Typed
from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.units import ANGLES, LENGTHS
from linkwork.core.foundation.values import (
    Flag,
    Formula,
    Key,
    ListOf,
    Measured,
    NumberValue,
    Speed,
    Tables,
    Text,
)
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.part import Part
from linkwork.core.textfile.writer import TextEdits
from linkwork.design.edits.entries import measured_by


def part_of(
    table: str,
    typed: Mapping[str, Typed],
    units: TypedUnits,
    row: Mapping[str, object] = FrozenDict(),
) -> dict[str, object]:
    """An entry of a table of parts from user input; empty fields are omitted.

    ``row``: the other fields, of a part that exists.

    Raises
    ------
    InputError, UnknownNameError
        If a table or key does not exist, or an entry does not match its key.
    """
    if table not in PARTS:
        raise UnknownNameError(f'there are no parts "{table}" {choices("parts", PARTS, table)}')
    return typed_entries(f"[[{table}]]", PARTS[table].keys, typed, units, row)


def typed_entries(
    table: str,
    keys: Iterable[Key],
    typed: Mapping[str, Typed],
    units: TypedUnits,
    row: Mapping[str, object],
) -> dict[str, object]:
    """The entries of a table with these keys from user input; ``row``: its other fields.

    Raises
    ------
    InputError, UnknownNameError
        If a key does not exist, or an entry does not match its key.
    """
    known = {key.name: key for key in keys}
    for name in typed:
        if name not in known:
            raise UnknownNameError(
                f'"{name}" is not a key of {table} {choices("keys", known, name)}'
            )
    reader = _Reader(units, {**row, **typed})
    return {name: reader.entry(known[name], entry) for name, entry in typed.items() if entry}


def shown_entry(key: Key, entry: object) -> Typed:
    """An entry as it would be typed: the inverse of a form."""
    match key.kind, entry:
        case Flag(), _:
            return "true" if entry else "false"
        case ListOf(Text()), tuple():
            return tuple(map(str, entry))
        case ListOf(ListOf()), tuple():
            return tuple(", ".join(map(str, row)) for row in entry)
        case ListOf(), tuple():
            return (", ".join(map(str, entry)),)
        case Tables(keys), tuple():
            return tuple(", ".join(str(getattr(row, k.attribute)) for k in keys) for row in entry)
    return str(entry)


def part_name(row: Mapping[str, object]) -> str:
    """The label of a part: its name, the two links of a weld, or the point or link of a load."""
    if "force" in row or "torque" in row:
        return f"load on {row.get('point', row.get('link', ''))}"
    links = row.get("links")
    if isinstance(links, Sequence) and not isinstance(links, str):
        return " ".join(map(str, links))
    return str(row.get("name", ""))


def field_of(key: Key) -> PaletteField:
    """The field of a form for a key."""
    words: tuple[str, ...] = ()
    named: tuple[str, ...] = ()
    match key.kind:
        case Text(words, of):
            entry = "choice" if words else of or "text"
        case NumberValue():
            entry = "number"
        case Measured() | Speed():
            entry = "measured"
        case Formula():
            entry = "text"
        case Flag():
            entry = "flag"
        case ListOf(Text(), noun):
            entry = f"{noun}s"
        case ListOf(NumberValue() | Speed()):
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


#: All kinds of parts, in the order of the tables of a file.
PALETTE: tuple[PalettePart, ...] = tuple(
    PalettePart(
        table=table,
        title=kind.title,
        doc=kind.doc,
        fields=tuple(map(field_of, kind.keys)),
        picks=picks_of(table),
    )
    for table, kind in PARTS.items()
)


@dataclass(frozen=True)
class _Reader:
    """Reads the fields of one completed form."""

    units: TypedUnits
    row: Mapping[str, object]

    def entry(self, key: Key, typed: Typed) -> object:
        """The kind of entry of a key."""
        match key.kind:
            case ListOf(Text()):
                return list(_lines(key, typed))
            case ListOf(Speed()):
                return [self._speed(word) for word in " ".join(_lines(key, typed)).split(",")]
            case ListOf(NumberValue() as kind):
                line = " ".join(_lines(key, typed))
                return [self._number(key, kind, word) for word in self._words(line)]
            case ListOf(ListOf(NumberValue() as kind)):
                return [
                    [self._number(key, kind, word) for word in self._words(line)]
                    for line in _lines(key, typed)
                ]
            case Tables(keys):
                return [self._row(key, keys, line) for line in _lines(key, typed)]
        if not isinstance(typed, str):
            _refuse(key, "is one entry, got a list")
        match key.kind:
            case NumberValue() as kind:
                return self._number(key, kind, typed)
            case Speed() | Measured():
                return self._speed(typed)
            case Flag():
                if typed not in ("true", "false"):
                    _refuse(key, f'must be true or false, got "{typed}"')
                return typed == "true"
            case _:
                return typed

    def _row(self, key: Key, keys: Sequence[Key], line: str) -> dict[str, object]:
        """A row of a table from its words in order; trailing words may be omitted."""
        words = self._words(line)
        if len(words) > len(keys):
            named = " ".join(column.name for column in keys)
            _refuse(key, f'a line has {named}, got "{line}"')
        return {
            column.name: self.entry(column, word) for column, word in zip(keys, words, strict=False)
        }

    def _words(self, line: str) -> list[str]:
        """Words separated by commas, or by blanks without commas (formulas may contain blanks)."""
        if "," in line:
            return [word.strip() for word in line.split(",")]
        words: list[str] = []
        for word in line.split():
            if words and word in (*LENGTHS, *ANGLES, self.units.length):
                words[-1] += f" {word}"
            else:
                words.append(word)
        return words

    def _number(self, key: Key, kind: NumberValue, word: str) -> float | int | str:
        """A number, or otherwise a formula."""
        plain = word.strip().replace("\u2212", "-")
        number = self.units.number(plain, measured_by(kind, self.row), key.name)
        return _as_number(number, plain)

    def _speed(self, word: str) -> float | int | str:
        """A number, or text with a unit that the file reads."""
        plain = word.strip().replace("\u2212", "-")
        speed = self.units.speed(plain)
        assert speed is not None
        return _as_number(speed, str(speed))


def _as_number(number: float | str, text: str) -> float | int | str:
    """A number, whole without decimals; text that is no finite number stays text."""
    try:
        value = float(number)
    except ValueError:
        return text
    if not math.isfinite(value):
        return text  # the file reader reports the problem
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def _lines(key: Key, typed: Typed) -> tuple[str, ...]:
    if isinstance(typed, str):
        _refuse(key, f'must be a list, got "{typed}"')
    return tuple(line.strip() for line in typed if line.strip())


def _refuse(key: Key, message: str) -> NoReturn:
    raise InputError(f"{key.name}: {message}")


# ----------------------------------------------------------------------
# Entries of parts as they are typed: shown, changed, removed with points used by them alone.


#: Entries that are shown also where the file leaves them out.
_NAMING = ("arm", "on")
#: Entries that exclude each other.
_INSTEAD = (
    ("radii", "teeth"),
    ("segments", "profile"),
    ("law", "table", "pitch_curve"),
    ("line", "circle"),
)


def parts_shown(draft: Draft) -> Iterator[PartShown]:
    """All parts of a draft, in the order of the tables of a file."""
    for (table, _), part in draft.keyed_parts:
        usual = {field.name: field.default for field in fields(part)}
        typed = {
            key.name: shown_entry(key, entry)
            for key in part.keys
            if (entry := getattr(part, key.attribute)) is not None
            and (key.name in _NAMING or entry != usual[key.attribute])
        }
        yield PartShown(
            table=str(table),
            name=part.label,
            typed=typed,
            links=tuple(_named(part, "link")),
            points=tuple(_named(part, "point")),
        )


def _named(part: Part, noun: str) -> Iterator[str]:
    """The links or points that a part names."""
    for key in part.keys:
        entry = getattr(part, key.attribute)
        match key.kind:
            case Text(of=of) if of == noun and entry is not None:
                yield entry
            case ListOf(Text(), kind) if kind == noun and entry is not None:
                yield from entry


def part_row(text: TextEdits, name: str) -> tuple[str, int]:
    """The table of the part with this name, and its place there.

    Raises
    ------
    UnknownNameError
        If the part does not exist.
    """
    names: list[str] = []
    for table in PARTS:
        for k, row in text.entries(table):
            if canonical(name) == canonical(label := part_name(row)):
                return table, k
            names.append(label)
    raise UnknownNameError(f'there is no "{name}" {choices("parts", names, name)}')


def put_entry(edit: SetPart, text: TextEdits, units: TypedUnits) -> None:
    """Write or remove an entry of a part; the entry that it replaces is removed.

    Raises
    ------
    InputError, UnknownNameError
        If the part or key does not exist, or the entry does not match its key.
    """
    table, k = part_row(text, edit.name)
    here = (table, k)
    entries = part_of(table, {edit.key: edit.typed}, units, text.get(here))
    if edit.key not in entries:
        if text.has((*here, edit.key)):
            text.remove((*here, edit.key))
        return
    text.put((*here, edit.key), entries[edit.key])
    for words in _INSTEAD:
        for other in words if edit.key in words else ():
            if other != edit.key and text.has((*here, other)):
                text.remove((*here, other))
    if edit.key == "internal" and entries["internal"]:
        _make_ring(text, here)


def _make_ring(text: TextEdits, here: tuple[str, int]) -> None:
    """Gears of equal size cannot mesh internally: the second one becomes the larger."""
    if not text.has((*here, "teeth")):
        raise InputError(
            "the radii of a ring and the gear in it differ by the distance of their centres: "
            "give teeth instead of radii, then make it internal"
        )
    first, second = text.get((*here, "teeth"))
    if first == second and not isinstance(first, str):
        text.put((*here, "teeth"), [first, 2 * second])


def alone_with(name: str, draft: Draft) -> Iterator[Edit]:
    """What serves this part alone: wheels and blocks of one point with the welds that hold them,
    fixed points on no other link.
    """
    named = next((p for p in draft.parts if canonical(p.label) == canonical(name)), None)
    if named is None:
        return
    links = [k for k in _named(named, "link") if k != GROUND and len(draft.links.get(k, ())) == 1]
    holding = [weld for weld in draft.welds if GROUND in weld.links and {*weld.links} & {*links}]
    others = [part for part in draft.parts if part is not named and part not in holding]
    links_used = {link for part in others for link in _named(part, "link")}
    points_used = {point for part in others for point in _named(part, "point")}
    carriers = draft.carriers()
    gone = {link for link in links if link not in links_used}
    for weld in holding:
        if gone & {*weld.links}:
            yield RemovePart(name=weld.label)
    for link in dict.fromkeys(links):
        if link in gone:
            yield RemoveLink(name=link)
    for point in dict.fromkeys(_named(named, "point")):
        left = [link for link in carriers.get(point, ()) if link not in gone]
        spare = point in draft.points and point not in points_used
        if spare and left in ([], [GROUND], [named.label]):
            yield RemovePoint(name=point)
