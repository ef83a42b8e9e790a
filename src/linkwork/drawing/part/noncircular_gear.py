"""Symbols of non-circular gears: wheels with the shape of their pitch curves."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.drawing.contour_line import contour_line, contour_mark
from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polygon, Polyline, Primitive, Role, xy
from linkwork.foundation.names import GROUND
from linkwork.mechanism.part.noncircular_gear import PitchCurve

__all__ = ["symbols"]


def symbols(curve: PitchCurve, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The wheel, its pitch curve, and a mark in the direction of its link."""
    fixed, tone = curve.link == GROUND, tones(pose).get(curve.link, 0)
    corners = tuple(map(xy, contour_line(pose, curve)))
    role = Role.FRAME if fixed else Role.WHEEL
    yield Polygon(role=role, of=curve.link, tone=tone, points=corners)
    yield Polyline(role=Role.PITCH, of=curve.name, points=(*corners, corners[0]))
    if not fixed:
        yield contour_mark(pose, curve, tone, measures)
