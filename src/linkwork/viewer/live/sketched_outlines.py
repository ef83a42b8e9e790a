"""Outlines of cams, curves and non-circular gears of a draft, which has no equations yet."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable

from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.figures import Outlines
from linkwork.mechanism.part.cam import Cam
from linkwork.mechanism.part.curve import Curve
from linkwork.mechanism.part.noncircular_gear import NoncircularGear

__all__ = ["sketched_outlines"]

_CORNERS = 72  # of a circle


def sketched_outlines(draft: Draft) -> Outlines:
    """Base circles of cams, given points of profiles and curves, circles that share the distance
    of two centres.
    """
    found: dict[str, tuple[str, str, Iterable[complex]]] = {}
    for cam in draft.of(Cam):
        base = 0.0 if cam.base is None else draft.numbers(cam.base)
        points = _points(draft, cam.profile) if cam.profile else _circle(base)
        found[cam.name] = (cam.cam, cam.center, points)
    for curve in draft.of(Curve):
        found[curve.name] = (curve.on, curve.origin, _points(draft, curve.through))
    for gear in draft.of(NoncircularGear):
        for suffix, wheel, center in zip(gear.curves, gear.wheels, gear.centers, strict=True):
            points = _circle(gear.distance(draft) / 2)
            found[f"{gear.name}{suffix}"] = (wheel, center, points)
    return found


def _circle(radius: float) -> list[complex]:
    return [cmath.rect(radius, math.tau * k / _CORNERS) for k in range(_CORNERS)]


def _points(linkage: Bodies, pairs: Iterable[tuple[Number, Number]]) -> list[complex]:
    return [complex(linkage.numbers(x), linkage.numbers(y)) for x, y in pairs]
