"""Edits of a mechanism as edits of its text; the file reader checks the result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import singledispatch

from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import GROUND, canonical, find_spelling
from linkwork.mechanism.description import Description
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.part.index import PARTS
from linkwork.mechanism.varied_number import VariedNumber, number_named
from linkwork.textfile.text_edits import TextEdits
from linkwork.viewer.live import requests as ask
from linkwork.viewer.live.messages import kind_of
from linkwork.viewer.live.palette import part_name, part_of

__all__ = ["Before", "Followed", "applied", "edit_title"]

_DRIVES = ("link", "joint", "slider", "cylinder", "variable")
_RANGE = {"start": "from", "stop": "to", "step": "step", "speed": "speed"}
_DIGITS = 12  # digits of measured dimensions; redundant ones must agree to nine


@dataclass(frozen=True, kw_only=True)
class Before:
    """The mechanism before a change, and coordinates of its points at the start (x, y)."""

    description: Description
    places: Mapping[str, tuple[float, float]]

    def place(self, point: str) -> complex:
        """The coordinates of a point: assembled, or as sketched if it cannot be assembled."""
        if point in self.places:
            return complex(*self.places[point])
        assert isinstance(self.description, Draft)
        return self.description.sketched(point)


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
        return Followed()
    written = quantity.written(description)
    # a number in place of a formula would silently remove the dependence on dimensions
    if isinstance(written, str) and not isinstance(edit.value, str) and not edit.any_formula:
        raise InputError(
            f'"{quantity.name}" is the formula {written}: change a dimension in '
            "it, or send another formula"
        )
    if quantity.table == "lengths" and _move_pivot(quantity, edit.value, text, description):
        return Followed()
    text.put(_path(quantity, text), edit.value)
    return Followed()


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
    for measured in description.shapes.measured:
        if sorted(map(canonical, measured.points)) == wanted:
            return " ".join(measured.points)
    return None


def _move_pivot(
    quantity: VariedNumber, length: float | str, text: TextEdits, description: Description
) -> bool:
    """Set a distance on ground by moving its second point along the line between the two."""
    assert isinstance(description, Draft)
    first, second = quantity.key.split()
    pair = (*description.points[first], *description.points[second])
    on_ground = {first, second} <= set(description.links[GROUND])
    if not on_ground or isinstance(length, str) or any(isinstance(c, str) for c in pair):
        return False
    base = description.sketched(first)
    span = description.sketched(second) - base
    # lengths on ground follow from coordinates: both change together
    _put_place(text, second, base + span / abs(span) * length)
    text.put(("lengths", quantity.key), length)
    return True


@applied.register
def _(edit: ask.MovePoint, text: TextEdits, before: Before) -> Followed:
    linkage = before.description
    if not isinstance(linkage, Draft):
        raise InputError(
            "the points of this file follow from its equations: change a dimension instead"
        )
    point = _known_point(linkage, edit.point)
    place = complex(edit.x, edit.y)
    if formulas := [c for c in linkage.points[point] if isinstance(c, str)]:
        raise InputError(
            f'"{point}" has the formula {formulas[0]}: change a dimension in it instead'
        )
    _put_place(text, point, place)
    measured = [m for m in linkage.shapes.measured if point in m.points]
    followed, stayed = [" ".join(m.points) for m in measured], []
    for table in ("lengths", "angles"):
        for key, number in getattr(linkage, table).items():
            if point not in key.split():
                continue
            # a formula keeps its dependence on dimensions
            if isinstance(number, str) or not edit.lengths_follow:
                stayed.append(key)
                continue
            places = {p: place if p == point else before.place(p) for p in key.split()}
            text.put((table, key), _measure(key, places, linkage))
            followed.append(key)
    return Followed(followed=tuple(followed), stayed=tuple(stayed))


def _measure(key: str, places: Mapping[str, complex], linkage: Draft) -> float:
    """A measured length, or angle in the file's unit, between points with coordinates."""
    match key.split():
        case [a, b]:
            return _rounded(abs(places[b] - places[a]))
        case [a, vertex, b]:
            rays = (places[b] - places[vertex]) * (places[a] - places[vertex]).conjugate()
            return _rounded(linkage.angle.from_radians(phase(rays)))
    raise ValueError(f"{key} names neither two nor three points")


def _rounded(number: float) -> float:
    return float(f"{number:.{_DIGITS}g}")


def _put_place(text: TextEdits, point: str, place: complex) -> None:
    text.put(("points", point, 0), _rounded(place.real))
    text.put(("points", point, 1), _rounded(place.imag))


def _known_point(linkage: Draft, name: str) -> str:
    own = find_spelling(name, linkage.points)
    if own not in linkage.points:
        raise UnknownNameError(
            f'there is no point "{name}" {choices("points", linkage.points, name)}'
        )
    return own


@applied.register
def _(edit: ask.SetInput, text: TextEdits, before: Before) -> Followed:
    count = max(1, len(before.description.inputs))
    if not 0 <= edit.number < count:
        raise InputError(f"there is no input {edit.number + 1}: the mechanism has {count}")
    here: tuple[str | int, ...] = ("input", edit.number)
    if (edit.drive is None) != (edit.name is None):
        raise InputError("an input has a kind and a name: send drive and name, or neither")
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
    for field, key in _RANGE.items():
        if (entry := getattr(edit, field)) is not None:
            text.put((*here, key), entry)
    return Followed()


@applied.register
def _(edit: ask.AddPoint, text: TextEdits, before: Before) -> Followed:
    _add(text, "points", edit.name, [_rounded(edit.x), _rounded(edit.y)])
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
        case ask.ChooseConfiguration():
            return f"configuration {edit.name}".strip()
        case _:
            name = getattr(edit, "name", None) or getattr(edit, "point", "")
            return f"{kind_of(type(edit)).replace('_', ' ')} {name}".strip()
