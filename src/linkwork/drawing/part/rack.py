"""Symbols of racks: a bar with its pitch line, as long as the path of the pinion."""

from __future__ import annotations

import math
from collections.abc import Iterator

from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polygon, Polyline, Primitive, Role, xy
from linkwork.drawing.wheel_symbols import addendum_of
from linkwork.mechanism.part.rack import RackBar

__all__ = ["symbols"]


def symbols(rack: RackBar, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A bar and its pitch line."""
    guides = [guide for guide in pose.skeleton.guides if guide.name == rack.slider]
    guide = guides[0]
    along = pose.direction(guide)
    foot = pose.points[guide.line[0]]
    center = (pose.points[rack.center] - foot) * along.conjugate()
    side = math.copysign(1.0, center.imag)
    pitch = center.imag - side * rack.radius
    way = pose.displacement(guide)
    margin = max(4 * measures.pin, 0.6 * rack.radius)
    own = [((pose.points[g.point] - foot) * along.conjugate()).real for g in guides]
    start = min(center.real + way.now - way.high - margin, *own)
    end = max(center.real + way.now - way.low + margin, *own)
    beyond = addendum_of(rack.radius, measures)
    low, high = pitch - side * 1.5 * beyond, pitch + side * beyond
    corners = [complex(start, low), complex(end, low), complex(end, high), complex(start, high)]
    tone = tones(pose)[rack.link]
    points = tuple(xy(foot + corner * along) for corner in corners)
    yield Polygon(role=Role.WHEEL, of=rack.link, tone=tone, points=points)
    ends = (xy(foot + complex(x, pitch) * along) for x in (start, end))
    yield Polyline(role=Role.PITCH, of=rack.name, points=tuple(ends))
