"""Outlines of gears with involute teeth of 20° on their pitch circles."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.core.drawing.links import tones
from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import (
    Hatch,
    Measures,
    Primitive,
    Role,
    drawn_area,
    drawn_disc,
    drawn_line,
    xy,
)
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.lanes import phase as phase_of
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.bodies import DiscFigure, Mesh

#: Distances of tips and roots from the pitch circle, in modules (ISO 53).
ADDENDUM, DEDENDUM = 1.0, 1.25

_PRESSURE = math.radians(20.0)
_FLANK = 4  # points along a flank


def tooth_outline(disc: DiscFigure) -> ComplexArray:
    """The outline of a gear about its centre, the first tooth on the real axis.

    The outline of a ring is that of the gear that fills it: its first gap is on the real axis.

    Notes
    -----
    The half width of a tooth at radius ρ is π/(2z) + inv 20° - inv α, cos α = r cos 20°/ρ,
    inv α = tan α - α.

    References
    ----------
    R. L. Norton, Design of Machinery, section 9.3 (involute tooth form).
    """
    assert disc.teeth is not None
    module = 2.0 * disc.radius / disc.teeth
    # a ring is the complement of its gear: tips and roots are exchanged
    up, down = (DEDENDUM, ADDENDUM) if disc.ring else (ADDENDUM, DEDENDUM)
    root, tip = disc.radius - down * module, disc.radius + up * module
    base = disc.radius * math.cos(_PRESSURE)
    radii = np.linspace(max(root, base), tip, _FLANK)
    half = math.pi / (2 * disc.teeth) + _involute(np.array(_PRESSURE))
    # flanks of few teeth would cross above the pointed tip
    half = np.maximum(half - _involute(np.arccos(base / radii)), 0.0)
    # Below the base circle there is no involute: the flank is straight towards the centre.
    if root < base:
        radii, half = np.append(root, radii), np.append(half[0], half)
    flank = radii * np.exp(1j * half)
    tooth = np.concatenate((flank.conj(), flank[::-1]))
    steps = np.exp(2j * math.pi * np.arange(disc.teeth) / disc.teeth)
    outline: ComplexArray = (steps[:, None] * tooth).ravel()
    return outline


def _involute(angle: Array) -> Array:
    found: Array = np.tan(angle) - angle
    return found


def tooth_phases(pose: Pose) -> dict[DiscFigure, float]:
    """The direction [rad] of the first tooth (of a ring: gap) of every gear with known teeth."""
    meshes = [m.discs for m in pose.skeleton.of(Mesh) if all(d.teeth for d in m.discs)]
    return mesh_phases(meshes, pose.angle, pose.points)


def mesh_phases(
    meshes: Iterable[tuple[DiscFigure, DiscFigure]],
    angle: Callable[[str], float],
    points: Mapping[str, complex],
) -> dict[DiscFigure, float]:
    """The direction [rad] of the first tooth (of a ring: gap) of gears in mesh.

    The teeth of the first wheel of a train rotate with its link; those of the following wheels are
    placed in mesh. Since the wheels roll on each other, they rotate with their links too.
    """
    phases: dict[DiscFigure, float] = {}
    left = list(meshes)
    while left:
        # Meshes with a wheel of known phase come first.
        one, other = min(left, key=lambda pair: not phases.keys() & set(pair))
        left.remove((one, other))
        if other in phases:
            one, other = other, one
        phases.setdefault(one, angle(one.link))
        line = phase_of(points[other.center] - points[one.center])
        phases.setdefault(other, _meshing(line, one, phases[one], other))
    return phases


def _meshing(line: float, one: DiscFigure, phase: float, other: DiscFigure) -> float:
    """The phase of a wheel in mesh with one of known phase; ``line``: that of the centres [rad]."""
    assert one.teeth is not None
    assert other.teeth is not None
    if one.ring or other.ring:
        # The point of contact lies beyond the smaller wheel; its teeth are in the ring's gaps.
        line = line if one.ring else line + math.pi
        return line - (line - phase) * one.teeth / other.teeth
    passed = (line - phase) * one.teeth / math.tau
    # at the contact, one gear has a tooth and the other a gap
    return line + math.pi - (0.5 - passed) * math.tau / other.teeth


# ----------------------------------------------------------------------
# Symbols of gears, pulleys, wheels and rollers: circles, with teeth if known and visible.
#
# Every wheel has a mark in the direction of its link, which shows its rotation.


_FEWEST = 6  # minimum number of teeth: fewer have no involute flanks
_SMOOTH = 120  # points of a circle drawn as a line


@dataclass(frozen=True, kw_only=True)
class _Wheel:
    """A drawn wheel; ``phase`` is that of its teeth, ``None`` if drawn without teeth."""

    disc: DiscFigure
    centre: complex
    angle: float
    tone: int
    spoke: bool
    phase: float | None


def wheel_symbols(pose: Pose, measures: Measures, *, moving: bool = False) -> Iterator[Primitive]:
    """All wheels; with ``moving`` only those whose centres move, without their teeth."""
    phases: Mapping[DiscFigure, float] = {} if moving else tooth_phases(pose)
    tone = tones(pose)
    for disc in pose.skeleton.of(DiscFigure):
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
    """The addendum of a gear without known teeth."""
    return min(1.1 * measures.pin, 0.12 * disc_radius)


def outer_radius(disc: DiscFigure, measures: Measures) -> float:
    """The outer radius of a drawn wheel."""
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


def _seen(disc: DiscFigure, measures: Measures) -> bool:
    """Whether teeth are known and large enough to be visible."""
    if disc.teeth is None or disc.teeth < _FEWEST:
        return False
    # pitch relative to the pin: smaller teeth merge in print
    return math.tau * disc.radius / disc.teeth >= 1.2 * measures.pin


def _bar_from_center(pose: Pose, disc: DiscFigure) -> bool:
    """Whether a bar or plate from the wheel's centre already shows its angle."""
    return not disc.ring and any(
        bar.name == disc.link and disc.center in bar.points and len(set(bar.points)) > 1
        for bar in pose.skeleton.bars
    )


def _wheel(wheel: _Wheel, measures: Measures) -> Iterator[Primitive]:
    disc = wheel.disc
    inner = _edge(wheel, measures)
    yield from (_ring if disc.ring else _solid)(wheel, inner, measures)
    if disc.kind == "gear":
        yield drawn_disc(Role.PITCH, disc.name, wheel.centre, disc.radius)
    if disc.link != GROUND and disc.kind != "roller" and wheel.spoke:
        yield from _mark(wheel, measures)


def _edge(wheel: _Wheel, measures: Measures) -> ComplexArray:
    """The contact outline of a wheel: its teeth or a circle, closed."""
    if wheel.phase is not None:
        turned = tooth_outline(wheel.disc) * cmath.exp(1j * wheel.phase)
        return np.append(wheel.centre + turned, wheel.centre + turned[:1])
    return _circle(wheel.centre, _plain_radius(wheel.disc, measures))


def _plain_radius(disc: DiscFigure, measures: Measures) -> float:
    """The radius of a wheel drawn without teeth; for a gear, the tip circle."""
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
        yield drawn_disc(role, disc.link, wheel.centre, radius, wheel.tone)
    else:
        yield drawn_area(role, disc.link, edge[:-1], wheel.tone)
    if fixed:
        inside = float(np.abs(edge - wheel.centre).min())
        yield round_hatching(wheel.centre, inside, -measures.hatch, disc.name)


def _ring(wheel: _Wheel, edge: ComplexArray, measures: Measures) -> Iterator[Primitive]:
    """The area between the inner edge of a ring and its outer circle."""
    disc = wheel.disc
    fixed = disc.link == GROUND
    outside = outer_radius(disc, measures)
    outer = _circle(wheel.centre, outside)
    # Along the edge and back along the outer circle encloses the area between them.
    band = np.concatenate((edge, outer[::-1]))
    role = Role.FRAME_BAND if fixed else Role.BAND
    yield drawn_area(role, disc.link, band, wheel.tone)
    for line in (edge, outer):
        role = Role.FRAME if fixed else Role.WHEEL
        yield drawn_line(role, disc.link, line, wheel.tone)
    if fixed:
        yield round_hatching(wheel.centre, outside, measures.hatch, disc.name)


def _mark(wheel: _Wheel, measures: Measures) -> Iterator[Primitive]:
    """A spoke from the pin to a dot; on a ring a stroke across its rim."""
    disc, way = wheel.disc, cmath.exp(1j * wheel.angle)
    start, end = min(measures.pin, 0.4 * disc.radius), 0.78 * disc.radius
    if disc.ring:
        start, end = disc.radius, outer_radius(disc, measures)
    ends = (wheel.centre + start * way, wheel.centre + end * way)
    yield drawn_line(Role.MARK, disc.link, ends, wheel.tone)
    if not disc.ring:
        dot = min(0.8 * measures.pin, 0.15 * disc.radius)
        yield drawn_disc(Role.MARK, disc.link, ends[1], dot, wheel.tone)


def round_hatching(centre: complex, radius: float, depth: float, of: str) -> Hatch:
    """Strokes at 45° along a circle, outside it, or inside if ``depth`` is negative."""
    count = max(12, round(math.tau * radius / (1.6 * abs(depth))))
    strokes = []
    for k in range(count):
        way = cmath.exp(2j * math.pi * k / count)
        foot = centre + radius * way
        strokes.append((xy(foot), xy(foot + depth * way * (1 - 1j))))
    return Hatch(role=Role.HATCH, of=of, strokes=tuple(strokes))
