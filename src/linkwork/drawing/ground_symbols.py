"""What stands still: a hatched triangle under each pivot; the hatching of a line."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from linkwork.drawing.link_symbols import pin_radius
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Hatch, Polygon, Polyline, Primitive, Role, xy

__all__ = ["DEPTH", "ground_symbols", "hatching"]

_FLOOR = 3.1  # below the pivot, in radii of its pin
DEPTH = _FLOOR + 1.4  #: To the lower end of the hatching.


def ground_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A triangle, a floor and its hatching under every point where a link meets the ground."""
    skeleton = pose.skeleton
    carried = {point for bar in skeleton.bars for point in bar.points}
    carried |= {point for strut in skeleton.struts for point in strut.between}
    held = {point for figure in skeleton.figures for point in figure.ends}
    carried |= held - {guide.point for guide in skeleton.guides}  # a slot's pin is held already
    for name in skeleton.fixed:
        if name in carried:
            own = replace(measures, pin=pin_radius(pose, name, measures))
            yield from _pivot(name, pose.points[name], own)


def _pivot(name: str, place: complex, measures: Measures) -> Iterator[Primitive]:
    half, floor, depth = 1.9 * measures.pin, 2.9 * measures.pin, _FLOOR * measures.pin
    left, right = place - half - 1j * depth, place + half - 1j * depth
    yield Polygon(role=Role.GROUND, of=name, points=(xy(place), xy(left), xy(right)))
    start, end = place - floor - 1j * depth, place + floor - 1j * depth
    yield Polyline(role=Role.GROUND, of=name, points=(xy(start), xy(end)))
    yield hatching(start, end, -1j, measures.hatch, name)


def hatching(start: complex, end: complex, away: complex, depth: float, of: str) -> Hatch:
    """Strokes at 45° behind the line from start to end, on the side of the unit vector ``away``."""
    along = (end - start) / abs(end - start)
    length = abs(end - start)
    # whole strokes from end to end, about as far apart as they are deep
    count = max(2, math.floor((length - depth) / depth + 1.5))
    step = (length - depth) / (count - 1)
    feet = [start + (depth + k * step) * along for k in range(count)]
    return Hatch(
        role=Role.HATCH,
        of=of,
        strokes=tuple((xy(foot), xy(foot + depth * (away - along))) for foot in feet),
    )
