"""Edits of a mechanism as edits of its text; the file reader checks the result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import singledispatch

from linkwork.app.live.drawn_parts import edits_of_drawing
from linkwork.app.live.force_entries import drop_lost_loads, entry_title, put_force_entry, put_mass
from linkwork.app.live.messages import kind_of
from linkwork.app.live.moving_points import (
    Before,
    add_entry,
    carry,
    check_point,
    drop_loose_dimensions,
    drop_lost_inputs,
    held_places,
    move_points,
    points_of,
    rounded,
)
from linkwork.app.live.number_edits import TypedUnits, set_input, set_number
from linkwork.app.live.palette import part_of
from linkwork.app.live.part_entries import alone_with, part_row, put_entry
from linkwork.app.live.requests import (
    AddJoint,
    AddLink,
    AddPart,
    AddPoint,
    ChooseConfiguration,
    DrawPart,
    Edit,
    MovePoint,
    MovePoints,
    RemoveJoint,
    RemoveLink,
    RemovePart,
    RemovePoint,
    ReverseLink,
    SetEntry,
    SetGround,
    SetInput,
    SetMass,
    SetNumber,
    SetPart,
    TracePoint,
)
from linkwork.app.live.whole_edits import AddOutput, ChangeUnits, Duplicate, Mirror, Rename
from linkwork.core.foundation.errors import InputError, Problem, UnknownNameError, choices
from linkwork.core.foundation.names import GROUND, canonical, find_spelling
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.textfile.text_edits import TextEdits
from linkwork.design.edits.entries import copy_selection, mirror_numbers, names_in_file, rename
from linkwork.design.edits.unit_change import change_units


@dataclass(frozen=True, kw_only=True)
class Followed:
    """The dimensions changed with a point, and those that stayed."""

    followed: tuple[str, ...] = ()
    stayed: tuple[str, ...] = ()


@singledispatch
def applied(edit: Edit, text: TextEdits, before: Before) -> Followed:
    """Apply a change to a text.

    Raises
    ------
    InputError, UnknownNameError
        If a name does not exist, or exists already; the text is then invalid.
    """
    raise TypeError(f"{type(edit).__name__} is not an edit of a file")


@applied.register
def _(edit: SetNumber, text: TextEdits, before: Before) -> Followed:
    set_number(edit, text, before)
    return Followed()


@applied.register
def _(edit: MovePoint, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    point = _known_point(linkage, edit.point)
    places = {point: complex(edit.x, edit.y)}
    followed, stayed = move_points(text, before, linkage, places, follow=edit.lengths_follow)
    return Followed(followed=followed, stayed=stayed)


@applied.register
def _(edit: MovePoints, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    targets = {_known_point(linkage, name): complex(*place) for name, place in edit.places.items()}
    places = held_places(linkage, before, targets, edit.keep)
    followed, stayed = move_points(text, before, linkage, places, keep=edit.keep)
    return Followed(followed=followed, stayed=stayed)


def _sketched(before: Before) -> Draft:
    if isinstance(before.description, Draft):
        return before.description
    raise InputError(
        "the points of this file follow from its equations: change a dimension instead"
    )


def _known_point(linkage: Draft, name: str) -> str:
    point = find_spelling(name, linkage.points)
    if point not in linkage.points:
        raise UnknownNameError(
            f'there is no point "{name}" {choices("points", linkage.points, name)}'
        )
    return point


@applied.register
def _(edit: SetInput, text: TextEdits, before: Before) -> Followed:
    set_input(edit, text, before)
    return Followed()


@applied.register
def _(edit: AddPoint, text: TextEdits, before: Before) -> Followed:
    units = TypedUnits.of(before.description)
    place = [units.number(c, "length", letter) for c, letter in ((edit.x, "x"), (edit.y, "y"))]
    for c in place:
        before.description.numbers(c)  # refuses a formula that has no value
    add_entry(text, "points", edit.name, [c if isinstance(c, str) else rounded(c) for c in place])
    for link in edit.links:
        carry(text, link, edit.name)
    return Followed()


@applied.register
def _(edit: AddLink, text: TextEdits, before: Before) -> Followed:
    for name in edit.points:
        check_point(text, name)
    add_entry(text, "links", edit.name, list(edit.points))
    return Followed()


@applied.register
def _(edit: SetGround, text: TextEdits, before: Before) -> Followed:
    fixed = points_of(text, GROUND) if text.has(("links", GROUND)) else []
    targets = {canonical(name): check_point(text, name) for name in edit.points}
    left = [point for point in fixed if canonical(point) not in targets]
    if on := [*left, *targets.values()] if edit.on else left:
        text.put(("links", GROUND), on)
    elif fixed:
        text.remove(("links", GROUND))
    drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: AddJoint, text: TextEdits, before: Before) -> Followed:
    check_point(text, edit.point)
    carry(text, edit.link, edit.point)
    return Followed()


@applied.register
def _(edit: RemoveJoint, text: TextEdits, before: Before) -> Followed:
    points = points_of(text, edit.link)
    left = [point for point in points if canonical(point) != canonical(edit.point)]
    if len(left) == len(points):
        message = f'"{edit.link}" does not carry "{edit.point}" {choices("points", points)}'
        raise UnknownNameError(message)
    text.put(("links", edit.link), left)
    drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: RemoveLink, text: TextEdits, before: Before) -> Followed:
    points_of(text, edit.name)
    text.remove(("links", edit.name))
    drop_loose_dimensions(text)
    drop_lost_inputs(text, edit.name)
    drop_lost_loads(text, edit.name)
    return Followed()


@applied.register
def _(edit: ReverseLink, text: TextEdits, before: Before) -> Followed:
    first, second, *rest = [*points_of(text, edit.name), "", ""]
    if not second:
        raise InputError(f'"{edit.name}" has no direction: it has one point')
    text.put(("links", edit.name), [second, first, *filter(None, rest)])
    return Followed()


@applied.register
def _(edit: RemovePoint, text: TextEdits, before: Before) -> Followed:
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
def _(edit: SetMass, text: TextEdits, before: Before) -> Followed:
    put_mass(edit, text)
    return Followed()


@applied.register
def _(edit: SetEntry, text: TextEdits, before: Before) -> Followed:
    put_force_entry(edit, text, before.description)
    return Followed()


@applied.register
def _(edit: AddPart, text: TextEdits, before: Before) -> Followed:
    units = TypedUnits.of(before.description)
    text.append(edit.table, part_of(edit.table, edit.typed, units))
    return Followed()


@applied.register
def _(edit: DrawPart, text: TextEdits, before: Before) -> Followed:
    for each in edits_of_drawing(edit, before):
        applied(each, text, before)
    return Followed()


@applied.register
def _(edit: SetPart, text: TextEdits, before: Before) -> Followed:
    put_entry(edit, text, TypedUnits.of(before.description))
    return Followed()


@applied.register
def _(edit: RemovePart, text: TextEdits, before: Before) -> Followed:
    text.remove(part_row(text, edit.name))
    drop_lost_inputs(text, edit.name)
    drop_lost_loads(text, edit.name)
    if edit.whole and isinstance(before.description, Draft):
        for each in alone_with(edit.name, before.description):
            applied(each, text, before)
    return Followed()


@applied.register
def _(edit: TracePoint, text: TextEdits, before: Before) -> Followed:
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
def _(edit: ChangeUnits, text: TextEdits, before: Before) -> Followed:
    change_units(text, length=edit.length, angle=edit.angle, convert=edit.convert)
    return Followed()


@applied.register
def _(edit: Rename, text: TextEdits, before: Before) -> Followed:
    rename(text, edit.of, edit.name, edit.new.strip())
    return Followed()


@applied.register
def _(edit: Duplicate, text: TextEdits, before: Before) -> Followed:
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
def _(edit: Mirror, text: TextEdits, before: Before) -> Followed:
    linkage = _sketched(before)
    places = {_known_point(linkage, name): complex(*at) for name, at in edit.places.items()}
    mirror_numbers(text, set(map(canonical, places)))
    followed, stayed = move_points(text, before, linkage, places)
    return Followed(followed=followed, stayed=stayed)


@applied.register
def _(edit: AddOutput, text: TextEdits, before: Before) -> Followed:
    add_entry(text, "outputs", edit.name, edit.formula)
    return Followed()


@applied.register
def _(edit: ChooseConfiguration, text: TextEdits, before: Before) -> Followed:
    if edit.name:
        text.put(("configuration",), edit.name)
    elif text.has(("configuration",)):
        text.remove(("configuration",))
    return Followed()


def edit_title(edit: Edit) -> str:
    """A change in a few words, for the history."""
    match edit:
        case SetNumber():
            value = edit.value if isinstance(edit.value, str) else f"{edit.value:.12g}"
            return f"{edit.name} = {value}"
        case MovePoint():
            return f"move {edit.point}"
        case MovePoints():
            return f"move {', '.join(edit.places)}"
        case DrawPart():
            return f"add {PARTS[edit.table].title.lower()}"
        case SetMass():
            return f"mass of {edit.link}"
        case SetPart():
            return f"{edit.name}: {edit.key}"
        case SetEntry():
            return entry_title(edit)
        case ChangeUnits():
            units = " and ".join(filter(None, (edit.length, edit.angle)))
            return f"{'convert to' if edit.convert else 'relabel as'} {units}"
        case Rename():
            return f"rename {edit.name} as {edit.new.strip()}"
        case Duplicate():
            how = "mirror a copy of" if edit.mirrored else "duplicate"
            return f"{how} {', '.join(edit.names)}"
        case Mirror():
            return f"mirror {', '.join(edit.places)}"
        case ChooseConfiguration():
            return f"configuration {edit.name}".strip()
        case _:
            name = getattr(edit, "name", None) or getattr(edit, "point", "")
            return f"{kind_of(type(edit)).replace('_', ' ')} {name}".strip()


# ----------------------------------------------------------------------
# The problems with which an edit is refused.


Refusing = Callable[[Problem], bool]

#: Edits that change numbers or choices, not parts.
_OF_NUMBERS = (
    SetNumber, SetPart, SetEntry, MovePoint, MovePoints, SetInput,
    ChooseConfiguration, TracePoint, ChangeUnits, AddOutput,
)  # fmt: skip


def refusing(edit: Edit) -> Refusing:
    """The problems with which an edit is refused.

    An edit that only changes numbers or choices may not cause any, and a new part may not be wrong
    itself; other edits may leave a draft.
    """
    if isinstance(edit, _OF_NUMBERS):
        return lambda problem: True
    if isinstance(edit, AddPart | DrawPart):
        return lambda problem: problem.key[:1] == (edit.table,)
    return lambda problem: False
