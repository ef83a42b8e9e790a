"""Arrows at points, all of one scale, with their names."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from linkwork.drawing.annotation import Annotation
from linkwork.drawing.captions import printed_name
from linkwork.drawing.label_placement import Choice, places_beside
from linkwork.drawing.measures import Measures
from linkwork.drawing.scene import Polyline, Primitive, Role, xy

__all__ = ["LONGEST", "ArrowLook", "point_arrows", "scale_caption"]

#: The longest arrow of a motion over the drawn size.
LONGEST = 0.3

_SHORTEST = 1.5  # radii of a pin: shorter arrows would be hidden by it


@dataclass(frozen=True, kw_only=True)
class ArrowLook:
    """Roles of a kind of arrow and of its names, and its letter: v for velocities."""

    role: Role
    name_role: Role
    letter: str


def point_arrows(
    vectors: Mapping[str, complex],
    points: Mapping[str, complex],
    scale: float,
    look: ArrowLook,
    measures: Measures,
) -> tuple[Annotation, list[str]]:
    """Arrows from points; the names of those that are too short to be drawn.

    Parameters
    ----------
    vectors : Mapping[str, complex]
        By point, x + iy.
    scale : float
        Drawn length over a vector's.
    """
    drawn: list[Primitive] = []
    names: list[Choice] = []
    short: list[str] = []
    for name, vector in vectors.items():
        tail = points[name]
        tip = tail + scale * vector
        if abs(tip - tail) < _SHORTEST * measures.pin:
            short.append(printed_name(name))
            continue
        # the head of a short arrow would hide its line
        head = min(measures.head, 0.5 * abs(tip - tail))
        drawn.append(Polyline(role=look.role, of=name, points=(xy(tail), xy(tip)), head=head))
        text = f"{look.letter}({printed_name(name)})"
        names.append(places_beside(look.name_role, name, text, tip, 0.8 * measures.text, measures))
    return Annotation(drawn=drawn, names=names), short


def scale_caption(word: str, scale: float, length_unit: str, unit: str, size: float) -> str:
    """The scale of arrows: ``velocity scale: 20 mm = 500 mm/s``.

    Parameters
    ----------
    word : str
        The quantity that the arrows show.
    scale : float
        Drawn length divided by the size of the quantity.
    size : float
        Of the drawing.
    """
    # Both numbers are short: the scale is a short number, the length a power of ten.
    length = 10.0 ** math.floor(math.log10(0.3 * size))
    shown = f"{length:g} {length_unit}".rstrip()
    return f"{word} scale: {shown} = {length / scale:.4g} {unit}".rstrip()
