"""Pressure angles: between the force on a guided part and the direction in which it can move.

On a follower with a knife edge or a roller the cam acts along the normal of the path that the
follower's point has on the cam: normal to its velocity relative to the cam. A link that moves a
block acts along its own line. Where the point does not move on the cam the angle is NaN.

References
----------
R. L. Norton, Cam Design and Manufacturing Handbook, 2nd ed., Industrial Press 2009, chapter 7.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.expression.jets import Jet
from linkwork.mechanism.dyad import Dyad
from linkwork.mechanism.part.cam import CamOutline, Follower
from linkwork.results.quantities.definition import (
    UNKNOWN,
    MechanismNames,
    RowQuantity,
    Solved,
    folded,
)
from linkwork.results.quantity import Kind

__all__ = ["PRESSURE_ANGLE"]

_QUARTER = np.pi / 2  # between a line and its normal


def _followers(names: MechanismNames) -> dict[str, Follower]:
    """Followers that touch the cam at one point of their own, by the name of the cam."""
    followers = names.skeleton.of(Follower) if names.lead else ()
    return {f.name: f for f in followers if f.contact != "flat"}


def _blocks(names: MechanismNames) -> dict[str, Dyad]:
    return {dyad.guide.name: dyad for dyad in names.dyads if dyad.guide is not None}


def _guided(names: MechanismNames) -> Mapping[str, Kind]:
    return dict.fromkeys([*_followers(names), *_blocks(names)], Kind.ANGLE)


def _angle(names: MechanismNames, solved: Solved, part: str) -> Jet:
    followers = _followers(names)
    if part in followers:
        follower = followers[part]
        force = _sliding(names, solved, follower).direction() + _QUARTER
        if follower.pivot is None:
            way = _line(names, solved, follower.slider or "")
        else:
            arm = solved.place(follower.point) - solved.place(follower.pivot)
            way = arm.direction() + _QUARTER
    else:
        dyad = _blocks(names)[part]
        force = (solved.place(dyad.pin) - solved.place(dyad.arms[0])).direction()
        way = _line(names, solved, part)
    return folded(force - way, np.pi)  # eq. (58)


def _line(names: MechanismNames, solved: Solved, guide: str) -> Jet:
    line = next(g.line for g in names.skeleton.guides if g.name == guide)
    start, end = (solved.place(point) for point in line)
    return (end - start).direction()


def _sliding(names: MechanismNames, solved: Solved, follower: Follower) -> Jet:
    """The follower point's velocity relative to the cam, per unit of the input."""
    outlines = names.skeleton.of(CamOutline)
    cam = next(outline for outline in outlines if outline.name == follower.name)
    turning = solved.own(cam.link)
    arm = solved.place(follower.point) - solved.place(cam.center)
    # less the velocity of the cam's own point at the same place
    rate = arm.d1 - 1j * turning.d1 * arm.v
    bend = arm.d2 - 1j * (turning.d2 * arm.v + turning.d1 * arm.d1)
    return Jet(rate, bend, UNKNOWN)


PRESSURE_ANGLE = (
    RowQuantity(
        word="pressure_angle",
        about="between the force on the guided part and its way",
        kind=Kind.ANGLE,
        needs=1,
        of=_guided,
        evaluate=_angle,
    ),
)
