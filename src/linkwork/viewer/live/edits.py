"""Edits of a mechanism as edits of its text; the file reader checks the result."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import GROUND, canonical, find_spelling
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.part.index import PARTS
from linkwork.textfile.copying import copy_selection, mirror_numbers
from linkwork.textfile.renaming import names_in_file, rename
from linkwork.textfile.text_edits import TextEdits
from linkwork.textfile.unit_change import change_units
from linkwork.viewer.live import requests as ask
from linkwork.viewer.live.force_entries import entry_title, put_force_entry
from linkwork.viewer.live.mass_entries import drop_lost_loads, put_mass
from linkwork.viewer.live.messages import kind_of
from linkwork.viewer.live.moving_points import Before, held_places, move_points, rounded
from linkwork.viewer.live.number_edits import set_input, set_number
from linkwork.viewer.live.palette import part_of
from linkwork.viewer.live.part.index import edits_of_drawing
from linkwork.viewer.live.part_entries import alone_with, part_row, put_entry
from linkwork.viewer.live.typed_units import TypedUnits
from linkwork.viewer.live.written_links import (
    add_entry,
    carry,
    check_point,
    drop_loose_dimensions,
    drop_lost_inputs,
    points_of,
)

__all__ = ["Followed", "applied", "edit_title"]


@dataclass(frozen=True, kw_only=True)
class Followed:
    """The dimensions changed with a point, and those that stayed."""

    followed: tuple[str, ...] = ()
    stayed: tuple[str, ...] = ()


@singledispatch
def applied(edit: ask.Edit, text: TextEdits, before: Before) -> Followed:
    """Apply a change to a text.

    Raises
    ------
    InputError, UnknownNameError
        If a name does not exist, or exists already; the text is then invalid.
    """
    raise TypeError(f"{type(edit).__name__} is not an edit of a file")


@applied.register
def _(edit: ask.SetNumber, text: TextEdits, before: Before) -> Followed:
    set_number(edit, text, before)
    return Followed()


@applied.register
def _(edit: ask.MovePoint, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    point = _known_point(linkage, edit.point)
    places = {point: complex(edit.x, edit.y)}
    followed, stayed = move_points(text, before, linkage, places, follow=edit.lengths_follow)
    return Followed(followed=followed, stayed=stayed)


@applied.register
def _(edit: ask.MovePoints, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    wanted = {_known_point(linkage, name): complex(*place) for name, place in edit.places.items()}
    places = held_places(linkage, before, wanted, edit.keep)
    followed, stayed = move_points(text, before, linkage, places, keep=edit.keep)
    return Followed(followed=followed, stayed=stayed)


def _sketched(before: Before) -> Draft:
    if isinstance(before.description, Draft):
        return before.description
    raise InputError(
        "the points of this file follow from its equations: change a dimension instead"
    )


def _known_point(linkage: Draft, name: str) -> str:
    own = find_spelling(name, linkage.points)
    if own not in linkage.points:
        raise UnknownNameError(
            f'there is no point "{name}" {choices("points", linkage.points, name)}'
        )
    return own


@applied.register
def _(edit: ask.SetInput, text: TextEdits, before: Before) -> Followed:
    set_input(edit, text, before)
    return Followed()


@applied.register
def _(edit: ask.AddPoint, text: TextEdits, before: Before) -> Followed:
    units = TypedUnits.of(before.description)
    place = [units.number(c, "length", letter) for c, letter in ((edit.x, "x"), (edit.y, "y"))]
    for c in place:
        before.description.numbers(c)  # refuses a formula that has no value
    add_entry(text, "points", edit.name, [c if isinstance(c, str) else rounded(c) for c in place])
    for link in edit.links:
        carry(text, link, edit.name)
    return Followed()


@applied.register
def _(edit: ask.AddLink, text: TextEdits, before: Before) -> Followed:
    for name in edit.points:
        check_point(text, name)
    add_entry(text, "links", edit.name, list(edit.points))
    return Followed()


@applied.register
def _(edit: ask.SetGround, text: TextEdits, before: Before) -> Followed:
    fixed = points_of(text, GROUND) if text.has(("links", GROUND)) else []
    wanted = {canonical(name): check_point(text, name) for name in edit.points}
    left = [point for point in fixed if canonical(point) not in wanted]
    if on := [*left, *wanted.values()] if edit.on else left:
        text.put(("links", GROUND), on)
    elif fixed:
        text.remove(("links", GROUND))
    drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: ask.AddJoint, text: TextEdits, before: Before) -> Followed:
    check_point(text, edit.point)
    carry(text, edit.link, edit.point)
    return Followed()


@applied.register
def _(edit: ask.RemoveJoint, text: TextEdits, before: Before) -> Followed:
    points = points_of(text, edit.link)
    left = [point for point in points if canonical(point) != canonical(edit.point)]
    if len(left) == len(points):
        message = f'"{edit.link}" does not carry "{edit.point}" {choices("points", points)}'
        raise UnknownNameError(message)
    text.put(("links", edit.link), left)
    drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: ask.RemoveLink, text: TextEdits, before: Before) -> Followed:
    points_of(text, edit.name)
    text.remove(("links", edit.name))
    drop_loose_dimensions(text)
    drop_lost_inputs(text, edit.name)
    drop_lost_loads(text, edit.name)
    return Followed()


@applied.register
def _(edit: ask.ReverseLink, text: TextEdits, before: Before) -> Followed:
    first, second, *rest = [*points_of(text, edit.name), "", ""]
    if not second:
        raise InputError(f'"{edit.name}" has no direction: it has one point')
    text.put(("links", edit.name), [second, first, *filter(None, rest)])
    return Followed()


@applied.register
def _(edit: ask.RemovePoint, text: TextEdits, before: Before) -> Followed:
    check_point(text, edit.name)
    text.remove(("points", edit.name))
    for link in text.keys(("links",)):
        points = points_of(text, link)
        left = [point for point in points if canonical(point) != canonical(edit.name)]
        if not left:
            text.remove(("links", link))
        elif len(left) < len(points):
            text.put(("links", link), left)
    if traced := text.names(("trace", "points")):
        left = [point for point in traced if canonical(point) != canonical(edit.name)]
        text.put(("trace", "points"), left)
    drop_loose_dimensions(text)
    drop_lost_loads(text, edit.name)
    return Followed()


@applied.register
def _(edit: ask.SetMass, text: TextEdits, before: Before) -> Followed:
    put_mass(edit, text)
    return Followed()


@applied.register
def _(edit: ask.SetEntry, text: TextEdits, before: Before) -> Followed:
    put_force_entry(edit, text, before.description)
    return Followed()


@applied.register
def _(edit: ask.AddPart, text: TextEdits, before: Before) -> Followed:
    units = TypedUnits.of(before.description)
    text.append(edit.table, part_of(edit.table, edit.typed, units))
    return Followed()


@applied.register
def _(edit: ask.DrawPart, text: TextEdits, before: Before) -> Followed:
    for each in edits_of_drawing(edit, before):
        applied(each, text, before)
    return Followed()


@applied.register
def _(edit: ask.SetPart, text: TextEdits, before: Before) -> Followed:
    put_entry(edit, text, TypedUnits.of(before.description))
    return Followed()


@applied.register
def _(edit: ask.RemovePart, text: TextEdits, before: Before) -> Followed:
    text.remove(part_row(text, edit.name))
    drop_lost_inputs(text, edit.name)
    drop_lost_loads(text, edit.name)
    if edit.whole and isinstance(before.description, Draft):
        for each in alone_with(edit.name, before.description):
            applied(each, text, before)
    return Followed()


@applied.register
def _(edit: ask.TracePoint, text: TextEdits, before: Before) -> Followed:
    check_point(text, edit.point)
    traced = text.names(("trace", "points"))
    left = [point for point in traced if canonical(point) != canonical(edit.point)]
    if edit.on:
        left.append(edit.point)
    if left:
        text.put(("trace", "points"), left)
    elif text.has(("trace",)):
        text.remove(("trace",))
    return Followed()


@applied.register
def _(edit: ask.ChangeUnits, text: TextEdits, before: Before) -> Followed:
    change_units(text, length=edit.length, angle=edit.angle, convert=edit.convert)
    return Followed()


@applied.register
def _(edit: ask.Rename, text: TextEdits, before: Before) -> Followed:
    rename(text, edit.of, edit.name, edit.new.strip())
    return Followed()


@applied.register
def _(edit: ask.Duplicate, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    taken = names_in_file(text)
    for name, copy in edit.names.items():
        if canonical(name) != canonical(copy) and canonical(copy) in taken:
            raise InputError(f'"{copy}" is already in the file: choose another name')
    for point, place in edit.places.items():
        _known_point(linkage, point)
        if point not in edit.names:
            raise InputError(f'the copy of "{point}" needs a name')
        add_entry(text, "points", edit.names[point], [rounded(c) for c in place])
    copy_selection(text, edit.names, mirrored=edit.mirrored)
    return Followed()


@applied.register
def _(edit: ask.Mirror, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    places = {_known_point(linkage, name): complex(*at) for name, at in edit.places.items()}
    mirror_numbers(text, set(map(canonical, places)))
    followed, stayed = move_points(text, before, linkage, places)
    return Followed(followed=followed, stayed=stayed)


@applied.register
def _(edit: ask.AddOutput, text: TextEdits, before: Before) -> Followed:
    add_entry(text, "outputs", edit.name, edit.formula)
    return Followed()


@applied.register
def _(edit: ask.ChooseConfiguration, text: TextEdits, before: Before) -> Followed:
    if edit.name:
        text.put(("configuration",), edit.name)
    elif text.has(("configuration",)):
        text.remove(("configuration",))
    return Followed()


def edit_title(edit: ask.Edit) -> str:
    """A change in a few words, for the history."""
    match edit:
        case ask.SetNumber():
            value = edit.value if isinstance(edit.value, str) else f"{edit.value:.12g}"
            return f"{edit.name} = {value}"
        case ask.MovePoint():
            return f"move {edit.point}"
        case ask.MovePoints():
            return f"move {', '.join(edit.places)}"
        case ask.DrawPart():
            return f"add {PARTS[edit.table].title.lower()}"
        case ask.SetMass():
            return f"mass of {edit.link}"
        case ask.SetPart():
            return f"{edit.name}: {edit.key}"
        case ask.SetEntry():
            return entry_title(edit)
        case ask.ChangeUnits():
            units = " and ".join(filter(None, (edit.length, edit.angle)))
            return f"{'convert to' if edit.convert else 'relabel as'} {units}"
        case ask.Rename():
            return f"rename {edit.name} as {edit.new.strip()}"
        case ask.Duplicate():
            how = "mirror a copy of" if edit.mirrored else "duplicate"
            return f"{how} {', '.join(edit.names)}"
        case ask.Mirror():
            return f"mirror {', '.join(edit.places)}"
        case ask.ChooseConfiguration():
            return f"configuration {edit.name}".strip()
        case _:
            name = getattr(edit, "name", None) or getattr(edit, "point", "")
            return f"{kind_of(type(edit)).replace('_', ' ')} {name}".strip()
