"""Symbols of belts and chains: two runs tangent to both pulleys, and an arc around each."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator

from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Arc, Polyline, Primitive, Role, xy
from linkwork.foundation.elementwise import phase
from linkwork.mechanism.part.belt import BeltRun

__all__ = ["symbols"]


def symbols(belt: BeltRun, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The runs of a belt; radii to both ends of a run are parallel, at ±β from the line of centres.

    cos β = (r1 - r2)/d for an open belt; a crossed one ends on the other side of the second
    pulley: cos β = (r1 + r2)/d.
    """
    one, other = (pose.points[name] for name in belt.centers)
    first, second = belt.radii
    if belt.crossed:
        second = -second
    along = phase(other - one)
    beta = math.acos((first - second) / abs(other - one))
    for side in (1, -1):
        way = cmath.exp(1j * (along + side * beta))
        ends = (xy(one + first * way), xy(other + second * way))
        yield Polyline(role=Role.BELT, of=belt.name, points=ends)
    around = math.tau - 2 * beta
    yield Arc(
        role=Role.BELT,
        of=belt.name,
        centre=xy(one),
        radius=first,
        start=along + beta,
        sweep=around,
    )
    yield Arc(
        role=Role.BELT,
        of=belt.name,
        centre=xy(other),
        radius=abs(second),
        start=along - (around / 2 if belt.crossed else beta),
        sweep=around if belt.crossed else 2 * beta,
    )
