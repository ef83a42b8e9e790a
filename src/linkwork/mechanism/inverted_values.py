"""Inputs and outputs of an inversion: the same quantities relative to another ground."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from linkwork.expression.grammar import parse
from linkwork.expression.tree import names_in
from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND, canonical
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.cylinder import Cylinder

__all__ = ["Frame", "inverted_input", "inverted_output"]


@dataclass(frozen=True, kw_only=True)
class Frame:
    """The old ground as a link of the inversion.

    Parameters
    ----------
    ground : str
        The new ground.
    name : str
        The link name of the old ground in the inversion.
    origin : str
        Its first point, the origin of its direction.
    place, turn : complex, float
        Coordinates of that point [length] and that direction [rad] in the old ground.
    """

    ground: str
    name: str
    origin: str
    place: complex
    turn: float


def inverted_input(
    linkage: Linkage, which: Input, frame: Frame, places: Mapping[str, complex]
) -> Input:
    """The input that drives the same relative angle or length.

    An angle relative to ground was measured from the x axis; now it is measured from the line of
    the old ground's first two points, so the table may begin at another number. If the new ground
    was driven, the other link is driven relative to it in the opposite sense. The table is shifted
    by whole turns, which count for wheels, to where the input is sketched: within half a turn.

    Parameters
    ----------
    places : Mapping[str, complex]
        All points of the assembled position that becomes the sketch.
    """
    kind, name = which.drives
    # a length between two links is the same from every ground
    if kind in ("slider", "cylinder"):
        return which
    link, against = name, which.relative_to or GROUND
    if kind == "joint":
        against, link = linkage.bodies_at(name)
        if link == GROUND:
            link, against = against, link
    if frame.ground in (link, against) and len(linkage.links[frame.ground]) < 2:
        raise InputError(
            f'the input turns relative to "{frame.ground}", which has one point and no direction: '
            "give input= for the inversion"
        )
    turn = linkage.angle.from_radians(frame.turn) if against == GROUND else 0.0
    ways = [_direction(linkage, body, places) for body in (link, against)]
    seen = linkage.angle.from_radians(phase(ways[0] * ways[1].conjugate()))
    other = frame.name if against == GROUND else against
    speed = linkage.speed(which)
    if link == frame.ground:
        # relative to the driven link, the old ground turns in the opposite direction
        back = None if speed is None else -speed
        against_it = replace(which, link=other, joint=None, relative_to=None, speed=back)
        return _ranged(linkage, against_it, -1.0, turn, seen)
    same = replace(
        which,
        link=link,
        joint=None,
        relative_to=None if against == frame.ground else other,
    )
    return _ranged(linkage, same, 1.0, -turn, seen)


def _direction(linkage: Linkage, link: str, places: Mapping[str, complex]) -> complex:
    """A vector along a link in a position, along the x axis for ground."""
    points = linkage.links[link]
    straight = link == GROUND or len(points) < 2
    return 1.0 + 0j if straight else places[points[1]] - places[points[0]]


def _ranged(linkage: Linkage, which: Input, sign: float, shift: float, seen: float) -> Input:
    """The input with the table sign · value + shift; ``seen`` is a value that is sketched."""
    there = sign * seen + shift
    shift -= linkage.angle.turn * round(there / linkage.angle.turn)
    if sign > 0 and not shift:
        return which
    start: Number = 0.0 if which.start is None else which.start
    stop: Number = linkage.angle.turn if which.stop is None else which.stop
    step = None if which.step is None else _shifted(which.step, sign, 0.0)
    return replace(
        which, start=_shifted(start, sign, shift), stop=_shifted(stop, sign, shift), step=step
    )


def _shifted(number: Number, sign: float, shift: float) -> Number:
    if isinstance(number, str):
        signed = f"-({number})" if sign < 0 else f"({number})"
        return f"{signed} + ({shift!r})" if shift else signed
    return sign * number + shift


def inverted_output(linkage: Linkage, formula: str, frame: Frame) -> str:
    """A formula of the same value: angles and coordinates relative to the old ground."""
    turn = linkage.angle.from_radians(frame.turn)
    angles = {canonical(name): name for name in linkage.links if name != GROUND}
    angles |= {canonical(c.angle_name): c.angle_name for c in linkage.of(Cylinder)}
    text = formula
    # from the end of the text, so that the columns of earlier names stay valid
    for node in reversed(list(names_in(parse(formula)))):
        if node.name in angles:
            seen = "0" if angles[node.name] == frame.ground else angles[node.name]
            new = f"({seen} - {frame.name} + ({turn!r}))"
        elif node.name[-2:] in (".x", ".y"):
            new = _coordinate(node.spelling[:-2], node.name[-1], turn, frame)
        else:
            continue
        at = node.column - 1
        text = text[:at] + new + text[at + len(node.spelling) :]
    return text


def _coordinate(point: str, axis: str, turn: float, frame: Frame) -> str:
    """A coordinate in the old ground, rotated from the frame's direction."""
    x, y = f"({point}.x - {frame.origin}.x)", f"({point}.y - {frame.origin}.y)"
    angle = f"({frame.name} - ({turn!r}))"
    if axis == "x":
        return f"({frame.place.real!r} + cos{angle}*{x} + sin{angle}*{y})"
    return f"({frame.place.imag!r} + cos{angle}*{y} - sin{angle}*{x})"
