"""Symbol of a cylinder: barrel, piston and rod between two points."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose, Travel
from linkwork.drawing.scene import Polygon, Polyline, Primitive, Role, xy
from linkwork.mechanism.part.cylinder import Strut

__all__ = ["symbols"]

_HELD = 1e-9  # of its length: a cylinder with less stroke is constant


def symbols(strut: Strut, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A cylinder, its barrel at the first of its two points."""
    tone = 0 if strut.name in {part.name for part in pose.skeleton.driven} else 1
    base, tip = (pose.points[name] for name in strut.between)
    length = pose.length(strut)
    if not length.now:
        return
    along = (tip - base) / length.now
    across = measures.barrel * along * 1j
    mouth = _barrel_end(length)
    foot = min(2.2 * measures.pin, 0.2 * mouth)
    piston = base + along * _piston(length, foot, mouth)
    back, front = base + foot * along, base + mouth * along
    wall = (back - across, front - across, front + across, back + across)

    def line(start: complex, end: complex) -> Polyline:
        ends = (xy(start), xy(end))
        return Polyline(role=Role.LINK, of=strut.name, tone=tone, points=ends)

    yield Polygon(role=Role.CYLINDER, of=strut.name, tone=tone, points=tuple(map(xy, wall)))
    yield line(base, back)
    yield line(piston, tip)
    yield line(piston - 0.8 * across, piston + 0.8 * across)


def _barrel_end(length: Travel) -> float:
    """The length of the barrel, at most the shortest length of the cylinder."""
    stroke = length.high - length.low
    return min(max(0.55 * length.low, 1.2 * stroke), 0.85 * length.low)


def _piston(length: Travel, foot: float, mouth: float) -> float:
    """The position of the piston from the base; it moves through the barrel with the stroke."""
    stroke = length.high - length.low
    held = stroke <= _HELD * length.high  # a constant cylinder: its stroke is rounding
    share = 0.5 if held else (length.now - length.low) / stroke
    return foot + (mouth - foot) * (0.12 + 0.76 * share)
