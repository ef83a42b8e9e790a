"""Symbols of cams, curves and non-circular gears."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from linkwork.contacts.curves import CurvedSlot, PitchCurve
from linkwork.core.drawing.links import contour_line, contour_mark, convex_outline, stems, tones
from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import (
    Hatch,
    Measures,
    Polyline,
    Primitive,
    Role,
    drawn_area,
    drawn_line,
    xy,
)
from linkwork.core.drawing.wheels import figure_symbols
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.bodies import CamOutline, Contour, Follower

# ----------------------------------------------------------------------
# Symbols of cams: outlines filled as links, flat faces and stems of followers.


_NORMALS = np.exp(2j * math.pi * np.arange(180) / 180)  # samples of faces that touch a cam


@figure_symbols.register
def cam_symbols(
    figure: CamOutline | Follower, pose: Pose, measures: Measures
) -> Iterator[Primitive]:
    """The outline of a cam with a mark in the direction of its link, or its follower."""
    if isinstance(figure, Follower):
        yield from _follower(figure, pose, measures)
        return
    fixed, tone = figure.link == GROUND, tones(pose).get(figure.link, 0)
    role = Role.FRAME if fixed else Role.WHEEL
    yield drawn_area(role, figure.link, contour_line(pose, figure), tone)
    if not fixed:
        yield contour_mark(pose, figure, tone, measures)


def _follower(follower: Follower, pose: Pose, measures: Measures) -> Iterator[Polyline]:
    """A flat face and a stem."""
    lines = []
    place, stem = pose.points[follower.point], stems(pose, measures).get(follower.point)
    if stem:
        lines.append((place, place + stem))
    drawn = any(cam.name == follower.name for cam in pose.skeleton.of(CamOutline))
    if follower.contact == "flat" and drawn:
        lines.append(_face(pose, follower, measures))
    tone = tones(pose).get(follower.link, 0)
    for ends in lines:
        yield drawn_line(Role.LINK, follower.link, ends, tone)


def _face(pose: Pose, follower: Follower, measures: Measures) -> tuple[complex, complex]:
    """The ends of a flat face, which includes all contact points of the cam.

    At the contact with a face of normal n, the outline is furthest in the direction n.
    """
    place, center = pose.points[follower.point], pose.points[follower.center]
    if follower.pivot is None:
        guide = next(g for g in pose.skeleton.guides if g.name == follower.slider)
        along = 1j * pose.direction(guide)
    else:
        arm = place - pose.points[follower.pivot]
        along = arm / abs(arm)
    cam = next(c for c in pose.skeleton.of(CamOutline) if c.name == follower.name)
    outline = np.array(cam.points)
    touched = outline[(outline[:, None] * _NORMALS.conj()).real.argmax(axis=0)]
    reach = float(np.abs((touched * _NORMALS.conj()).imag).max()) + 3 * measures.pin
    middle = ((center - place) * along.conjugate()).real
    ends = [middle - reach, middle + reach]
    if follower.pivot is not None:
        ends = [-abs(place - pose.points[follower.pivot]), max(ends[1], 0.0)]
    return place + ends[0] * along, place + ends[1] * along


# ----------------------------------------------------------------------
# Symbols of curved slots: a line on each side of the curve, hatched on ground.


_OF_PLATE = 40  # points of a moving curve enclosed by its link's plate


@figure_symbols.register
def curve_symbols(contour: CurvedSlot, pose: Pose, measures: Measures) -> Iterator[Primitive]:
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
        yield drawn_line(role, contour.name, [*edge, edge[0]], number)
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
    yield drawn_area(Role.PLATE, contour.link, corners, tone)


# ----------------------------------------------------------------------
# Symbols of non-circular gears: wheels with the shape of their pitch curves.


@figure_symbols.register
def noncircular_gear_symbols(
    curve: PitchCurve, pose: Pose, measures: Measures
) -> Iterator[Primitive]:
    """The wheel, its pitch curve, and a mark in the direction of its link."""
    fixed, tone = curve.link == GROUND, tones(pose).get(curve.link, 0)
    corners = contour_line(pose, curve)
    role = Role.FRAME if fixed else Role.WHEEL
    yield drawn_area(role, curve.link, corners, tone)
    yield drawn_line(Role.PITCH, curve.name, [*corners, corners[0]])
    if not fixed:
        yield contour_mark(pose, curve, tone, measures)
