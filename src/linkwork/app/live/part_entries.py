"""Entries of parts as they are typed: shown, changed, removed with points used by them alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from linkwork.app.live.file_state import PartShown
from linkwork.app.live.number_edits import TypedUnits
from linkwork.app.live.palette import part_name, part_of, shown_entry
from linkwork.app.live.requests import Edit, RemoveLink, RemovePart, RemovePoint, SetPart
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.foundation.values import ListOf, Text
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.part import Part
from linkwork.core.textfile.text_edits import TextEdits

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
