"""Edits of a mechanism as edits of its text; the file reader checks the result."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import GROUND, canonical, find_spelling
from linkwork.mechanism.description import Description
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.part.index import PARTS
from linkwork.mechanism.varied_number import VariedNumber, number_named
from linkwork.textfile.text_edits import TextEdits
from linkwork.viewer.live import requests as ask
from linkwork.viewer.live.messages import kind_of
from linkwork.viewer.live.moving_points import Before, held_places, move_points, put_place, rounded
from linkwork.viewer.live.palette import part_name, part_of

__all__ = ["Followed", "applied", "edit_title"]

_DRIVES = ("link", "joint", "slider", "cylinder", "variable")
_LENGTHS = ("slider", "cylinder")
_RANGE = {"start": "from", "stop": "to", "step": "step", "speed": "speed"}


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
    description = before.description
    try:
        quantity = number_named(description, edit.name)
    except UnknownNameError:
        if (measured := _measured(description, edit.name)) is None:
            raise
        text.put(("lengths", measured), edit.value)
        _stretch(measured, edit.value, text, before)
        return Followed()
    written = quantity.written(description)
    # a number in place of a formula would silently remove the dependence on dimensions
    if isinstance(written, str) and not isinstance(edit.value, str) and not edit.any_formula:
        raise InputError(
            f'"{quantity.name}" is the formula {written}: change a dimension in '
            "it, or send another formula"
        )
    if quantity.table == "lengths":
        if _move_pivot(quantity, edit.value, text, description):
            return Followed()
        _stretch(quantity.key, edit.value, text, before)
    text.put(_path(quantity, text), edit.value)
    return Followed()


def _stretch(key: str, length: float | str, text: TextEdits, before: Before) -> None:
    """Give a length to a draft, which is not assembled: its freer end moves in the sketch."""
    draft = before.description
    if not isinstance(draft, Draft) or not draft.problems or isinstance(length, str):
        return
    carriers = draft.drawable.carriers()
    if not set(key.split()) <= carriers.keys():
        return
    fixed, free = sorted(key.split(), key=lambda point: -len(carriers[point]))
    start, end = before.place(fixed), before.place(free)
    if length > 0 and end != start and not any(isinstance(c, str) for c in draft.points[free]):
        put_place(text, free, start + (end - start) / abs(end - start) * length)


def _path(quantity: VariedNumber, text: TextEdits) -> tuple[str | int, ...]:
    """The key path of a number in the text."""
    if quantity.table == "points":
        return ("points", quantity.key, quantity.axis)
    if quantity.table == "sliders":
        names = {canonical(str(row.get("name", ""))): k for k, row in text.entries("sliders")}
        return ("sliders", names[canonical(quantity.key)], "offset")
    return (quantity.table, quantity.key)


def _measured(description: Description, name: str) -> str | None:
    """The key of [lengths] for a named length between sketched points."""
    if not isinstance(description, Draft):
        return None
    wanted = sorted(map(canonical, name.split()))
    for measured in description.measured:
        if sorted(map(canonical, measured.points)) == wanted:
            return " ".join(measured.points)
    return None


def _move_pivot(
    quantity: VariedNumber, length: float | str, text: TextEdits, description: Description
) -> bool:
    """Set a distance on ground by moving its second point along the line between the two."""
    assert isinstance(description, Draft)
    first, second = quantity.key.split()
    # a draft may lack the ground, or a point
    on_ground = {first, second} <= set(
        description.links.get(GROUND, ())
    ) & description.points.keys()
    if not on_ground or isinstance(length, str):
        return False
    if any(isinstance(c, str) for c in (*description.points[first], *description.points[second])):
        return False
    base = description.sketched(first)
    span = description.sketched(second) - base
    if not span:
        return False
    # lengths on ground follow from coordinates: both change together
    put_place(text, second, base + span / abs(span) * length)
    text.put(("lengths", quantity.key), length)
    return True


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
    if (edit.drive is None) != (edit.name is None):
        raise InputError("an input has a kind and a name: send drive and name, or neither")
    count = len(before.description.inputs)
    if edit.number == count and count and edit.drive is not None:
        text.append("input", {edit.drive: edit.name})
    elif not 0 <= edit.number < max(1, count):
        raise InputError(f"there is no input {edit.number + 1}: the mechanism has {count}")
    here: tuple[str | int, ...] = ("input", edit.number)
    if edit.drive is not None:
        if edit.drive not in _DRIVES:
            raise UnknownNameError(
                f'"{edit.drive}" cannot be driven {choices("kinds", _DRIVES, edit.drive)}'
            )
        text.put((*here, edit.drive), edit.name)
        # an input has exactly one kind
        for other in (*_DRIVES, "relative_to"):
            if other != edit.drive and text.has((*here, other)):
                text.remove((*here, other))
        _write_range(edit.drive, edit.name or "", here, text, before)
    for field, key in _RANGE.items():
        if (entry := getattr(edit, field)) is not None:
            text.put((*here, key), entry)
    return Followed()


def _write_range(
    drive: str, name: str, here: tuple[str | int, ...], text: TextEdits, before: Before
) -> None:
    """Replace a range that belongs to another kind of quantity; lengths have no natural one."""
    number, inputs = here[-1], before.description.inputs
    assert isinstance(number, int)
    old = inputs[number].drives[0] if number < len(inputs) else "link"
    if (old in _LENGTHS) == (drive in _LENGTHS):
        return
    for key in _RANGE.values():
        if text.has((*here, key)):
            text.remove((*here, key))
    if drive in _LENGTHS:
        span = _span_of(name, before)
        for key, share in (("from", 0.25), ("to", 0.75), ("step", 0.005)):
            text.put((*here, key), float(f"{share * span:.4g}"))


def _span_of(name: str, before: Before) -> float:
    """The length of a slider's line, or twice that of a cylinder."""
    for part in getattr(before.description, "parts", ()):
        if canonical(part.label) == canonical(name):
            line = getattr(part, "line", None)
            a, b = line or part.between
            return abs(before.place(b) - before.place(a)) * (1.0 if line else 2.0) or 1.0
    return 1.0


@applied.register
def _(edit: ask.AddPoint, text: TextEdits, before: Before) -> Followed:
    _add(text, "points", edit.name, [rounded(edit.x), rounded(edit.y)])
    for link in edit.links:
        _carry(text, link, edit.name)
    return Followed()


@applied.register
def _(edit: ask.AddLink, text: TextEdits, before: Before) -> Followed:
    for name in edit.points:
        _check_point(text, name)
    _add(text, "links", edit.name, list(edit.points))
    return Followed()


@applied.register
def _(edit: ask.SetGround, text: TextEdits, before: Before) -> Followed:
    fixed = _points_of(text, GROUND) if text.has(("links", GROUND)) else []
    wanted = {canonical(name): _check_point(text, name) for name in edit.points}
    left = [point for point in fixed if canonical(point) not in wanted]
    if on := [*left, *wanted.values()] if edit.on else left:
        text.put(("links", GROUND), on)
    elif fixed:
        text.remove(("links", GROUND))
    _drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: ask.AddJoint, text: TextEdits, before: Before) -> Followed:
    _check_point(text, edit.point)
    _carry(text, edit.link, edit.point)
    return Followed()


@applied.register
def _(edit: ask.RemoveJoint, text: TextEdits, before: Before) -> Followed:
    points = _points_of(text, edit.link)
    left = [point for point in points if canonical(point) != canonical(edit.point)]
    if len(left) == len(points):
        message = f'"{edit.link}" does not carry "{edit.point}" {choices("points", points)}'
        raise UnknownNameError(message)
    text.put(("links", edit.link), left)
    _drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: ask.RemoveLink, text: TextEdits, before: Before) -> Followed:
    _points_of(text, edit.name)
    text.remove(("links", edit.name))
    _drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: ask.ReverseLink, text: TextEdits, before: Before) -> Followed:
    first, second, *rest = [*_points_of(text, edit.name), "", ""]
    if not second:
        raise InputError(f'"{edit.name}" has no direction: it has one point')
    text.put(("links", edit.name), [second, first, *filter(None, rest)])
    return Followed()


@applied.register
def _(edit: ask.RemovePoint, text: TextEdits, before: Before) -> Followed:
    _check_point(text, edit.name)
    text.remove(("points", edit.name))
    for link in text.keys(("links",)):
        points = _points_of(text, link)
        left = [point for point in points if canonical(point) != canonical(edit.name)]
        if not left:
            text.remove(("links", link))
        elif len(left) < len(points):
            text.put(("links", link), left)
    if text.has(("trace", "points")):
        traced = text.get(("trace", "points"))
        left = [point for point in traced if canonical(point) != canonical(edit.name)]
        text.put(("trace", "points"), left)
    _drop_loose_dimensions(text)
    return Followed()


@applied.register
def _(edit: ask.AddPart, text: TextEdits, before: Before) -> Followed:
    text.append(edit.table, part_of(edit.table, edit.typed))
    return Followed()


@applied.register
def _(edit: ask.RemovePart, text: TextEdits, before: Before) -> Followed:
    names: list[str] = []
    for table in PARTS:
        for k, row in text.entries(table):
            name = part_name(row)
            if canonical(edit.name) == canonical(name):
                text.remove((table, k))
                return Followed()
            names.append(name)
    raise UnknownNameError(f'there is no "{edit.name}" {choices("parts", names, edit.name)}')


@applied.register
def _(edit: ask.TracePoint, text: TextEdits, before: Before) -> Followed:
    _check_point(text, edit.point)
    traced = text.get(("trace", "points")) if text.has(("trace", "points")) else []
    left = [point for point in traced if canonical(str(point)) != canonical(edit.point)]
    if edit.on:
        left.append(edit.point)
    if left:
        text.put(("trace", "points"), left)
    elif text.has(("trace",)):
        text.remove(("trace",))
    return Followed()


@applied.register
def _(edit: ask.ChooseConfiguration, text: TextEdits, before: Before) -> Followed:
    if edit.name:
        text.put(("configuration",), edit.name)
    elif text.has(("configuration",)):
        text.remove(("configuration",))
    return Followed()


def _check_point(text: TextEdits, name: str) -> str:
    """A point as it is spelled in the text; an error if there is none."""
    known = text.keys(("points",))
    for own in known:
        if canonical(own) == canonical(name):
            return own
    raise UnknownNameError(f'there is no point "{name}" {choices("points", known, name)}')


def _add(text: TextEdits, table: str, name: str, entry: object) -> None:
    if text.has((table, name)):
        raise InputError(f'"{name}" is already in [{table}]: choose another name')
    text.put((table, name), entry)


def _points_of(text: TextEdits, link: str) -> list[str]:
    if not text.has(("links", link)):
        known = text.keys(("links",))
        raise UnknownNameError(f'there is no link "{link}" {choices("links", known, link)}')
    return [str(point) for point in text.get(("links", link))]


def _carry(text: TextEdits, link: str, point: str) -> None:
    points = _points_of(text, link)
    if canonical(point) in map(canonical, points):
        raise InputError(f'"{link}" carries "{point}" already')
    text.put(("links", link), [*points, point])


def _drop_loose_dimensions(text: TextEdits) -> None:
    """Remove lengths and angles between points that are no longer on one link."""
    links = [{canonical(p) for p in _points_of(text, link)} for link in text.keys(("links",))]
    for table in ("lengths", "angles"):
        for key in text.keys((table,)):
            if not any({canonical(p) for p in key.split()} <= points for points in links):
                text.remove((table, key))


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
        case ask.ChooseConfiguration():
            return f"configuration {edit.name}".strip()
        case _:
            name = getattr(edit, "name", None) or getattr(edit, "point", "")
            return f"{kind_of(type(edit)).replace('_', ' ')} {name}".strip()
