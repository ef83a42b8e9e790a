"""The positions of a task: rings with their numbers, and the directions of the body in poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.drawing.annotation import Annotation
from linkwork.drawing.label_placement import places_beside
from linkwork.drawing.measures import Measures
from linkwork.drawing.scene import Disc, Polyline, Primitive, Role, xy

__all__ = ["PositionMark", "position_marks"]

_RING = 1.9  # radius of a ring [pins]
_SMALL_RING = 0.8  # where positions are many
_ARM = 7.0  # length of the line along the body's x axis [pins]
_FEW = 12  # positions; the numbers of more cover each other: the first one shows the start


@dataclass(frozen=True, kw_only=True)
class PositionMark:
    """A position that a design should pass.

    ``place``: the wanted point [length]; ``direction``: a unit vector along the x axis of the body,
    none if its angle is free.
    """

    place: complex
    direction: complex | None = None


def position_marks(marks: Sequence[PositionMark], measures: Measures) -> Annotation:
    """A ring at every position, a line along the body in poses, and numbers in order of travel."""
    drawn: list[Primitive] = []
    few = len(marks) <= _FEW
    ring = (_RING if few else _SMALL_RING) * measures.pin
    for number, mark in enumerate(marks, start=1):
        of = str(number)
        drawn.append(Disc(role=Role.POSITION, of=of, centre=xy(mark.place), radius=ring))
        if mark.direction is not None:
            ends = (ring, _ARM * measures.pin)
            points = tuple(xy(mark.place + length * mark.direction) for length in ends)
            drawn.append(Polyline(role=Role.POSITION, of=of, points=points))
    numbered = marks if few else marks[:1]
    names = [
        places_beside(Role.POSITION_NAME, str(k), str(k), mark.place, 0.8 * measures.text, measures)
        for k, mark in enumerate(numbered, start=1)
    ]
    return Annotation(drawn=drawn, names=names)
