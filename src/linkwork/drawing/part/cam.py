"""Symbols of cams: outlines filled as links, flat faces and stems of followers."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from linkwork.drawing.contour_line import contour_line, contour_mark
from linkwork.drawing.follower_stems import stems
from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polygon, Polyline, Primitive, Role, xy
from linkwork.foundation.names import GROUND
from linkwork.mechanism.part.cam import CamOutline, Follower

__all__ = ["symbols"]

_NORMALS = np.exp(2j * math.pi * np.arange(180) / 180)  # samples of faces that touch a cam


def symbols(figure: CamOutline | Follower, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The outline of a cam with a mark in the direction of its link, or its follower."""
    if isinstance(figure, Follower):
        yield from _follower(figure, pose, measures)
        return
    fixed, tone = figure.link == GROUND, tones(pose).get(figure.link, 0)
    yield Polygon(
        role=Role.FRAME if fixed else Role.WHEEL,
        of=figure.link,
        tone=tone,
        points=tuple(map(xy, contour_line(pose, figure))),
    )
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
    for start, end in lines:
        yield Polyline(role=Role.LINK, of=follower.link, tone=tone, points=(xy(start), xy(end)))


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
