"""Cams and curves of an inversion: the same shapes, in frames that are turned."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from linkwork.mechanism.contacts import Cam, Curve
from linkwork.mechanism.followers import follower_frame
from linkwork.mechanism.linkage import GROUND, Linkage
from linkwork.mechanism.parts import Number

__all__ = ["inverted_cam", "inverted_curve"]

_Pairs = tuple[tuple[Number, Number], ...]


def inverted_cam(linkage: Linkage, cam: Cam, name: Callable[[str], str], turn: float) -> Cam:
    """A cam where links have other names, and the old ground's angle counts from ``turn`` [rad].

    That was the direction of the line from which it counts now.
    """
    link = None if cam.link is None else name(cam.link)
    same = replace(cam, cam=name(cam.cam), link=link)
    if cam.cam == GROUND and cam.profile:
        return replace(same, profile=_turned_back(cam.profile, turn))
    shift = turn * ((cam.cam == GROUND) - (follower_frame(linkage, cam) == GROUND))
    if not shift or not cam.segments:
        return same
    degrees = linkage.angle.from_radians(shift)
    start = cam.start
    return replace(
        same,
        start=f"({start}) + ({degrees!r})" if isinstance(start, str) else start + degrees,
    )


def inverted_curve(curve: Curve, name: Callable[[str], str], turn: float) -> Curve:
    """A curve on the same link; one of the old ground is seen from where its angle counts now."""
    same = replace(curve, on=name(curve.on))
    if curve.on != GROUND:
        return same
    return replace(same, through=_turned_back(curve.through, turn))


def _turned_back(pairs: _Pairs, turn: float) -> _Pairs:
    """Coordinates in axes that are turned by ``turn`` [rad]."""
    if not turn:
        return pairs
    c, s = math.cos(turn), math.sin(turn)

    def combined(x: Number, y: Number, by_x: float, by_y: float) -> Number:
        if isinstance(x, str) or isinstance(y, str):
            return f"({by_x!r})*({x}) + ({by_y!r})*({y})"
        return by_x * x + by_y * y

    return tuple((combined(x, y, c, s), combined(x, y, -s, c)) for x, y in pairs)
