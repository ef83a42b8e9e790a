"""Straight counterparts of wheels: the rack of a pinion, the line that a wheel rolls on."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from linkwork.drawing.ground_symbols import hatching
from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose, travel_along
from linkwork.drawing.scene import Polygon, Polyline, Primitive, Role, xy
from linkwork.drawing.wheel_symbols import addendum_of
from linkwork.mechanism.contact_shapes import RackBar, RollingLine
from linkwork.mechanism.linkage import GROUND

__all__ = ["rack_symbols", "rolling_symbols"]


def rack_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """Every rack as a bar with its pitch line, as long as its pinion ever needs it."""
    for rack in pose.skeleton.contacts.racks:
        yield from _rack(pose, rack, measures)


def _rack(pose: Pose, rack: RackBar, measures: Measures) -> Iterator[Primitive]:
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


def rolling_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """Every line that a wheel rolls on, as long as the wheel's way on it."""
    for track in pose.skeleton.contacts.rolling:
        yield from _rolling(pose, track, measures)


def _rolling(pose: Pose, track: RollingLine, measures: Measures) -> Iterator[Primitive]:
    foot, tip = (pose.points[name] for name in track.line)
    along = (tip - foot) / abs(tip - foot)
    center = (pose.points[track.center] - foot) * along.conjugate()
    way = travel_along(pose, track.center, track.line)
    margin = max(0.8 * track.radius, 4 * measures.pin)
    low, high = way.low - margin, way.high + margin
    if not pose.paths:
        low, high = min(low, 0.0), max(high, abs(tip - foot))
    start, end = foot + low * along, foot + high * along
    ends = (xy(start), xy(end))
    if track.on == GROUND:
        yield Polyline(role=Role.GROUND, of=track.name, points=ends)
        away = -1j * along * np.sign(center.imag)
        yield hatching(start, end, complex(away), measures.hatch, track.name)
    else:
        tone = tones(pose)[track.on]
        yield Polyline(role=Role.LINK, of=track.on, tone=tone, points=ends)
