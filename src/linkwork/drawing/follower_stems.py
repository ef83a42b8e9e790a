"""Stems of followers: from the contact point on a cam to the guiding block."""

from __future__ import annotations

import math

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.mechanism.part.cam import Follower

__all__ = ["stems"]


def stems(pose: Pose, measures: Measures) -> dict[str, complex]:
    """For every slider point that touches a cam: the vector to its block, which is set back.

    0 if the slider has other points: the block is drawn at one of these.
    """
    found = {}
    for follower in pose.skeleton.of(Follower):
        guides = [g for g in pose.skeleton.guides if g.name == follower.slider and g.block]
        if guides:
            along = pose.direction(guides[0])
            away = pose.points[follower.point] - pose.points[follower.center]
            outwards = math.copysign(1.0, (away * along.conjugate()).real)
            alone = all(guide.point == follower.point for guide in guides)
            travel = pose.displacement(guides[0])
            # Long enough that the rail ends before the cam at maximum lift.
            length = travel.high - travel.low + 9 * measures.pin
            found[follower.point] = length * outwards * along if alone else 0j
    return found
