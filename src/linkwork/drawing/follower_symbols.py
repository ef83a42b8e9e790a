"""Followers of cams: flat faces, and the stems between a cam and the block that guides them."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polyline, Primitive, Role, xy
from linkwork.mechanism.contact_shapes import Follower

__all__ = ["follower_symbols", "stems"]

_NORMALS = np.exp(2j * math.pi * np.arange(180) / 180)  # of the faces that touch a cam somewhere


def follower_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """Flat faces and stems."""
    tone = tones(pose)
    lengths = stems(pose, measures)
    for follower in pose.skeleton.contacts.followers:
        lines = []
        place = pose.points[follower.point]
        if lengths.get(follower.point):
            lines.append((place, place + lengths[follower.point]))
        if follower.contact == "flat":
            lines.append(_face(pose, follower, measures))
        for start, end in lines:
            yield Polyline(
                role=Role.LINK,
                of=follower.link,
                tone=tone.get(follower.link, 0),
                points=(xy(start), xy(end)),
            )


def stems(pose: Pose, measures: Measures) -> dict[str, complex]:
    """For every point of a slider that touches a cam: from it to the block, which is set back.

    Nothing (0) if the slider has other points: the block is drawn at one of these.
    """
    found = {}
    for follower in pose.skeleton.contacts.followers:
        guides = [g for g in pose.skeleton.guides if g.name == follower.slider and g.block]
        if guides:
            along = pose.direction(guides[0])
            away = pose.points[follower.point] - pose.points[follower.center]
            outwards = math.copysign(1.0, (away * along.conjugate()).real)
            alone = all(guide.point == follower.point for guide in guides)
            travel = pose.displacement(guides[0])
            # So long that the block's rail ends before the cam at its highest.
            length = travel.high - travel.low + 9 * measures.pin
            found[follower.point] = length * outwards * along if alone else 0j
    return found


def _face(pose: Pose, follower: Follower, measures: Measures) -> tuple[complex, complex]:
    """The ends of a flat face: it reaches as far as the cam ever touches it.

    Where a face with normal n touches, the outline is furthest in the direction n.
    """
    place, center = pose.points[follower.point], pose.points[follower.center]
    if follower.pivot is None:
        guide = next(g for g in pose.skeleton.guides if g.name == follower.slider)
        along = 1j * pose.direction(guide)
    else:
        arm = place - pose.points[follower.pivot]
        along = arm / abs(arm)
    cam = next(c for c in pose.skeleton.contacts.contours if c.name == follower.name)
    outline = np.array(cam.points)
    touched = outline[(outline[:, None] * _NORMALS.conj()).real.argmax(axis=0)]
    reach = float(np.abs((touched * _NORMALS.conj()).imag).max()) + 3 * measures.pin
    middle = ((center - place) * along.conjugate()).real
    ends = [middle - reach, middle + reach]
    if follower.pivot is not None:
        ends = [-abs(place - pose.points[follower.pivot]), max(ends[1], 0.0)]
    return place + ends[0] * along, place + ends[1] * along
