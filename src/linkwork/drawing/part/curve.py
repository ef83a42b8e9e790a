"""Symbols of curved slots: a line on each side of the curve, hatched on ground."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from linkwork.drawing.contour_line import contour_line
from linkwork.drawing.link_symbols import convex_outline, tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Hatch, Polygon, Polyline, Primitive, Role, xy
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.names import GROUND
from linkwork.mechanism.figures import Contour
from linkwork.mechanism.part.curve import CurvedSlot

__all__ = ["symbols"]

_OF_PLATE = 40  # points of a moving curve enclosed by its link's plate


def symbols(contour: CurvedSlot, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A slot along the curve."""
    tone = tones(pose)
    fixed = contour.link == GROUND
    line = contour_line(pose, contour)
    along, away = _outwards(line, contour.closed)
    edges = _edges(line, along, measures.slot, contour.closed)
    role = Role.GROUND if fixed else Role.SLOT
    number = tone.get(contour.link, 0)
    if not fixed:
        yield from _plate(pose, contour, line, number)
    for edge in edges:
        points = (*map(xy, edge), xy(edge[0]))
        yield Polyline(role=role, of=contour.name, tone=number, points=points)
    if fixed:
        yield _hatching(line + measures.slot * away, along, away, measures, contour.name)


def _outwards(line: ComplexArray, closed: bool) -> tuple[ComplexArray, ComplexArray]:
    """Unit tangents of a curve, and unit normals towards its convex side."""
    steps = np.roll(line, -1) - np.roll(line, 1) if closed else np.gradient(line)
    along = steps / np.abs(steps)
    turned = float(np.angle(along[1:] / along[:-1]).sum())
    if abs(turned) < 0.1:
        side = -1.0 if (along * 1j).imag.mean() > 0 else 1.0
    else:
        side = -math.copysign(1.0, turned)
    return along, side * 1j * along


def _edges(
    line: ComplexArray, along: ComplexArray, width: float, closed: bool
) -> list[ComplexArray]:
    """The lines on both sides of a curve; for an open curve joined by round ends."""
    left, right = line + 1j * width * along, line - 1j * width * along
    if closed:
        return [left, right]
    turn = 1j * np.exp(-1j * math.pi * np.arange(1, 10) / 10)
    start, end = line[0] - width * along[0] * turn, line[-1] + width * along[-1] * turn
    return [np.concatenate((left, end, right[::-1], start))]


def _hatching(
    line: ComplexArray, along: ComplexArray, away: ComplexArray, measures: Measures, of: str
) -> Hatch:
    """Strokes at 45° behind a curve."""
    depth = measures.hatch
    way = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(line)))))
    count = max(2, math.floor(way[-1] / depth))
    feet = np.searchsorted(way, way[-1] * (np.arange(count) + 0.5) / count)
    strokes = tuple((xy(line[k]), xy(line[k] + depth * (away[k] - along[k]))) for k in feet)
    return Hatch(role=Role.HATCH, of=of, strokes=strokes)


def _plate(pose: Pose, contour: Contour, line: ComplexArray, tone: int) -> Iterator[Primitive]:
    """The plate of a moving link with a curved slot."""
    own = next(bar.points for bar in pose.skeleton.bars if bar.name == contour.link)
    around = [complex(z) for z in line[:: max(1, len(line) // _OF_PLATE)]]
    corners = convex_outline([*around, *(pose.points[name] for name in own)])
    yield Polygon(role=Role.PLATE, of=contour.link, tone=tone, points=tuple(map(xy, corners)))
