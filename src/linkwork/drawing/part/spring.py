"""Symbols of springs: a zigzag between two points that compresses with the length."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polyline, Primitive, Role, xy
from linkwork.mechanism.part.spring import SpringFigure

__all__ = ["symbols"]

_COILS = 9
_END = 0.14  # straight fraction of the length at each end


def symbols(spring: SpringFigure, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A zigzag; none if the points coincide."""
    start, end = (pose.points[name] for name in spring.between)
    length = abs(end - start)
    if not length:
        return
    along = (end - start) / length
    across = 2.6 * measures.pin * 1j * along
    first, pitch = _END * length, (1.0 - 2.0 * _END) * length / _COILS
    corners = [start, start + first * along]
    for k in range(_COILS):
        side = across if k % 2 == 0 else -across
        corners.append(start + (first + (k + 0.5) * pitch) * along + side)
    corners += [end - first * along, end]
    yield Polyline(role=Role.SPRING, of=spring.name, points=tuple(map(xy, corners)))
