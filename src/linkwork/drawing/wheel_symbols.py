"""Gears, pulleys, wheels and rollers: circles, with teeth where they are known and can be seen.

Every wheel bears a mark in the direction of its link, so that it is seen to turn.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Disc as Circle, Hatch, Polygon, Polyline, Primitive, Role, xy
from linkwork.drawing.tooth_outline import ADDENDUM, DEDENDUM, tooth_outline, tooth_phases
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.names import GROUND
from linkwork.mechanism.figures import Disc

__all__ = ["addendum_of", "outer_radius", "wheel_symbols"]

_FEWEST = 6  # teeth that are drawn: fewer are no gear with involute flanks
_SMOOTH = 120  # points of a circle that is drawn as a line


@dataclass(frozen=True, kw_only=True)
class _Wheel:
    """A wheel where it is drawn; ``phase`` is that of its teeth, nothing if it is drawn plain."""

    disc: Disc
    centre: complex
    angle: float
    tone: int
    spoke: bool
    phase: float | None


def wheel_symbols(pose: Pose, measures: Measures, *, moving: bool = False) -> Iterator[Primitive]:
    """All wheels; with ``moving`` only those whose centres move, without their teeth."""
    phases: Mapping[Disc, float] = {} if moving else tooth_phases(pose)
    tone = tones(pose)
    for disc in pose.skeleton.of(Disc):
        if moving and (disc.link == GROUND or not pose.moves(disc.center)):
            continue
        shown = phases.get(disc) if _seen(disc, measures) else None
        yield from _wheel(
            _Wheel(
                disc=disc,
                centre=pose.points[disc.center],
                angle=pose.angle(disc.link),
                tone=tone.get(disc.link, 0),
                spoke=not _bar_from_center(pose, disc),
                phase=shown,
            ),
            measures,
        )


def addendum_of(disc_radius: float, measures: Measures) -> float:
    """How far a gear without known teeth reaches beyond its pitch circle."""
    return min(1.1 * measures.pin, 0.12 * disc_radius)


def outer_radius(disc: Disc, measures: Measures) -> float:
    """The radius of everything that is drawn of a wheel."""
    if disc.kind != "gear":
        return disc.radius + (_rim(measures) if disc.ring else 0.0)
    if _seen(disc, measures):
        assert disc.teeth is not None
        module = 2.0 * disc.radius / disc.teeth
        return disc.radius + (
            DEDENDUM * module + _rim(measures) if disc.ring else ADDENDUM * module
        )
    beyond = addendum_of(disc.radius, measures)
    return disc.radius + beyond + (_rim(measures) if disc.ring else 0.0)


def _rim(measures: Measures) -> float:
    return 1.6 * measures.pin


def _seen(disc: Disc, measures: Measures) -> bool:
    """Whether teeth are known and so far apart that they can be seen."""
    if disc.teeth is None or disc.teeth < _FEWEST:
        return False
    # the pitch against the pin: smaller teeth run together in print
    return math.tau * disc.radius / disc.teeth >= 1.2 * measures.pin


def _bar_from_center(pose: Pose, disc: Disc) -> bool:
    """Whether the wheel's link is drawn as a bar or plate from its centre: that shows its angle."""
    return not disc.ring and any(
        bar.name == disc.link and disc.center in bar.points and len(set(bar.points)) > 1
        for bar in pose.skeleton.bars
    )


def _wheel(wheel: _Wheel, measures: Measures) -> Iterator[Primitive]:
    disc = wheel.disc
    inner = _edge(wheel, measures)
    yield from (_ring if disc.ring else _solid)(wheel, inner, measures)
    if disc.kind == "gear":
        yield Circle(role=Role.PITCH, of=disc.name, centre=xy(wheel.centre), radius=disc.radius)
    if disc.link != GROUND and disc.kind != "roller" and wheel.spoke:
        yield from _mark(wheel, measures)


def _edge(wheel: _Wheel, measures: Measures) -> ComplexArray:
    """Where a wheel touches another one: its teeth or a circle, closed."""
    if wheel.phase is not None:
        turned = tooth_outline(wheel.disc) * cmath.exp(1j * wheel.phase)
        return np.append(wheel.centre + turned, wheel.centre + turned[:1])
    return _circle(wheel.centre, _plain_radius(wheel.disc, measures))


def _plain_radius(disc: Disc, measures: Measures) -> float:
    """The circle of a wheel that is drawn without teeth: of a gear, that of their tips."""
    if disc.kind != "gear":
        return disc.radius
    beyond = addendum_of(disc.radius, measures)
    return disc.radius + (-beyond if disc.ring else beyond)


def _circle(centre: complex, radius: float) -> ComplexArray:
    found: ComplexArray = centre + radius * np.exp(2j * math.pi * np.arange(_SMOOTH + 1) / _SMOOTH)
    return found


def _solid(wheel: _Wheel, edge: ComplexArray, measures: Measures) -> Iterator[Primitive]:
    disc = wheel.disc
    fixed = disc.link == GROUND
    role = Role.FRAME if fixed else Role.WHEEL
    if wheel.phase is None:
        radius = _plain_radius(disc, measures)
        yield Circle(
            role=role, of=disc.link, tone=wheel.tone, centre=xy(wheel.centre), radius=radius
        )
    else:
        corners = tuple(map(xy, edge[:-1]))
        yield Polygon(role=role, of=disc.link, tone=wheel.tone, points=corners)
    if fixed:
        inside = float(np.abs(edge - wheel.centre).min())
        yield round_hatching(wheel.centre, inside, -measures.hatch, disc.name)


def _ring(wheel: _Wheel, edge: ComplexArray, measures: Measures) -> Iterator[Primitive]:
    """What is between the edge of a ring and its outer circle."""
    disc = wheel.disc
    fixed = disc.link == GROUND
    outside = outer_radius(disc, measures)
    outer = _circle(wheel.centre, outside)
    # Out along the edge, back along the outer circle: the area between them.
    band = tuple(map(xy, np.concatenate((edge, outer[::-1]))))
    yield Polygon(
        role=Role.FRAME_BAND if fixed else Role.BAND, of=disc.link, tone=wheel.tone, points=band
    )
    for line in (edge, outer):
        yield Polyline(
            role=Role.FRAME if fixed else Role.WHEEL,
            of=disc.link,
            tone=wheel.tone,
            points=tuple(map(xy, line)),
        )
    if fixed:
        yield round_hatching(wheel.centre, outside, measures.hatch, disc.name)


def _mark(wheel: _Wheel, measures: Measures) -> Iterator[Primitive]:
    """A spoke from the pin to a dot; on a ring a stroke across its rim."""
    disc, way = wheel.disc, cmath.exp(1j * wheel.angle)
    start, end = min(measures.pin, 0.4 * disc.radius), 0.78 * disc.radius
    if disc.ring:
        start, end = disc.radius, outer_radius(disc, measures)
    ends = (xy(wheel.centre + start * way), xy(wheel.centre + end * way))
    yield Polyline(role=Role.MARK, of=disc.link, tone=wheel.tone, points=ends)
    if not disc.ring:
        dot = min(0.8 * measures.pin, 0.15 * disc.radius)
        yield Circle(role=Role.MARK, of=disc.link, tone=wheel.tone, centre=ends[1], radius=dot)


def round_hatching(centre: complex, radius: float, depth: float, of: str) -> Hatch:
    """Strokes at 45° along a circle, outside it, or inside if ``depth`` is negative."""
    count = max(12, round(math.tau * radius / (1.6 * abs(depth))))
    strokes = []
    for k in range(count):
        way = cmath.exp(2j * math.pi * k / count)
        foot = centre + radius * way
        strokes.append((xy(foot), xy(foot + depth * way * (1 - 1j))))
    return Hatch(role=Role.HATCH, of=of, strokes=tuple(strokes))
