"""Symbols of rolling lines, as long as the path of the wheel."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.drawing.ground_symbols import hatching
from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose, travel_along
from linkwork.drawing.scene import Polyline, Primitive, Role, xy
from linkwork.foundation.names import GROUND
from linkwork.mechanism.part.rolling import RollingLine

__all__ = ["symbols"]


def symbols(track: RollingLine, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The line, hatched on ground."""
    foot, tip = (pose.points[name] for name in track.line)
    along = (tip - foot) / abs(tip - foot)
    center = (pose.points[track.center] - foot) * along.conjugate()
    way = travel_along(pose, track.center, track.line)
    margin = max(0.8 * track.radius, 4 * measures.pin)
    low, high = way.low - margin, way.high + margin
    if not pose.paths:
        low, high = min(low, 0.0), max(high, abs(tip - foot))
    start, end = foot + low * along, foot + high * along
    ends = (xy(start), xy(end))
    if track.on == GROUND:
        yield Polyline(role=Role.GROUND, of=track.name, points=ends)
        away = -1j * along * np.sign(center.imag)
        yield hatching(start, end, complex(away), measures.hatch, track.name)
    else:
        tone = tones(pose)[track.on]
        yield Polyline(role=Role.LINK, of=track.on, tone=tone, points=ends)
