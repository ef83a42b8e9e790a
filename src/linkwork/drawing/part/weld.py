"""Symbols of rigid joints: a filled corner between two welded links."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator

from linkwork.drawing.link_symbols import pin_radius
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polygon, Primitive, Role, xy
from linkwork.foundation.elementwise import phase
from linkwork.mechanism.part.weld import RigidJoint

__all__ = ["symbols"]

_RADIUS = 2.0  # size of the filled corner, in pin radii
_NARROWEST = math.radians(50.0)  # visible part of a corner next to a pin
_PIECES = 12  # points of its arc


def symbols(joint: RigidJoint, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The filled corner between the two links, or over both if they are in line."""
    points = {bar.name: bar.points for bar in pose.skeleton.bars}
    ways = [_direction(pose, name, points.get(name, ()), joint.point) for name in joint.links]
    turn = phase(ways[1] / ways[0])
    if turn <= -math.pi + 1e-9:
        turn = math.pi  # collinear: always on the same side
    middle = ways[0] * cmath.exp(0.5j * turn)
    half = 0.5 * max(abs(turn), _NARROWEST)
    radius = _RADIUS * pin_radius(pose, joint.point, measures)
    place = pose.points[joint.point]
    arc = [
        place + radius * middle * cmath.exp(1j * half * (2.0 * k / _PIECES - 1.0))
        for k in range(_PIECES + 1)
    ]
    corners = tuple(map(xy, [place, *arc]))
    yield Polygon(role=Role.WELD, of=" ".join(joint.links), points=corners)


def _direction(pose: Pose, link: str, carried: tuple[str, ...], point: str) -> complex:
    """The unit vector from a point along its link."""
    place = pose.points[point]
    away = [pose.points[name] - place for name in carried if name != point]
    nearest = min(away, key=abs, default=0j)
    if nearest == 0:
        return cmath.exp(1j * pose.angle(link))
    return nearest / abs(nearest)
