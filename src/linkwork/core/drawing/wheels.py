"""Outlines of gears with involute teeth of 20° on their pitch circles."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import singledispatch

import numpy as np

from linkwork.core.drawing.links import hatching, pin_radius, tones
from linkwork.core.drawing.pose import Pose, Travel, travel_along
from linkwork.core.drawing.scene import (
    Hatch,
    Measures,
    Primitive,
    Role,
    drawn_arc,
    drawn_area,
    drawn_disc,
    drawn_line,
    xy,
)
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.lanes import phase, phase as phase_of
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.bodies import DiscFigure, Figure, Mesh
from linkwork.core.mechanism.part.gears import BeltRun, RackBar
from linkwork.core.mechanism.part.guides import GenevaWheel, Strut
from linkwork.core.mechanism.part.index import open_room
from linkwork.core.mechanism.part.rolling import RollingLine
from linkwork.core.mechanism.part.springs import RigidJoint, SpringFigure

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


# ----------------------------------------------------------------------
# Symbols of parts, by the kinds of their figures.


# ----------------------------------------------------------------------
# Symbols of parts, by the kinds of their figures.


@singledispatch
def figure_symbols(figure: Figure, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The symbol of a figure."""
    raise NotImplementedError(type(figure).__name__)


def part_symbols(figures: Iterable[Figure], pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The symbols of figures; wheels are drawn together, so that their teeth mesh."""
    for figure in figures:
        if not isinstance(figure, DiscFigure | Mesh):
            open_room(type(figure), "drawing")
            yield from figure_symbols(figure, pose, measures)


# ----------------------------------------------------------------------
# Symbols of belts and chains: two runs tangent to both pulleys, and an arc around each.


@figure_symbols.register
def belt_symbols(belt: BeltRun, pose: Pose, measures: Measures) -> Iterator[Primitive]:
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
        yield drawn_line(Role.BELT, belt.name, (one + first * way, other + second * way))
    around = math.tau - 2 * beta
    start, sweep = (along - around / 2, around) if belt.crossed else (along - beta, 2 * beta)
    yield drawn_arc(Role.BELT, belt.name, one, first, along + beta, around)
    yield drawn_arc(Role.BELT, belt.name, other, abs(second), start, sweep)


# ----------------------------------------------------------------------
# Symbol of a cylinder: barrel, piston and rod between two points.


_HELD = 1e-9  # of its length: a cylinder with less stroke is constant


@figure_symbols.register
def cylinder_symbols(strut: Strut, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A cylinder, its barrel at the first of its two points."""
    tone = 0 if strut.name in {part.name for part in pose.skeleton.driven} else 1
    base, tip = (pose.points[name] for name in strut.between)
    length = pose.length(strut)
    if not length.now:
        return
    along = (tip - base) / length.now
    across = measures.barrel * along * 1j
    mouth = _barrel_end(length)
    foot = min(2.2 * measures.pin, 0.2 * mouth)
    piston = base + along * _piston(length, foot, mouth)
    back, front = base + foot * along, base + mouth * along
    wall = (back - across, front - across, front + across, back + across)

    yield drawn_area(Role.CYLINDER, strut.name, wall, tone)
    head = (piston - 0.8 * across, piston + 0.8 * across)
    for ends in ((base, back), (piston, tip), head):
        yield drawn_line(Role.LINK, strut.name, ends, tone)


def _barrel_end(length: Travel) -> float:
    """The length of the barrel, at most the shortest length of the cylinder."""
    stroke = length.high - length.low
    return min(max(0.55 * length.low, 1.2 * stroke), 0.85 * length.low)


def _piston(length: Travel, foot: float, mouth: float) -> float:
    """The position of the piston from the base; it moves through the barrel with the stroke."""
    stroke = length.high - length.low
    held = stroke <= _HELD * length.high  # a constant cylinder: its stroke is rounding
    share = 0.5 if held else (length.now - length.low) / stroke
    return foot + (mouth - foot) * (0.12 + 0.76 * share)


# ----------------------------------------------------------------------
# Symbols of racks: a bar with its pitch line, as long as the path of the pinion.


@figure_symbols.register
def rack_symbols(rack: RackBar, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A bar and its pitch line."""
    guides = [guide for guide in pose.skeleton.guides if guide.name == rack.slider]
    guide = guides[0]
    along = pose.direction(guide)
    foot = pose.points[guide.line[0]]
    center = (pose.points[rack.center] - foot) * along.conjugate()
    side = math.copysign(1.0, center.imag)
    pitch = center.imag - side * rack.radius
    way = pose.displacement(guide)
    margin = max(4 * measures.pin, 0.6 * rack.radius)
    own = [((pose.points[g.point] - foot) * along.conjugate()).real for g in guides]
    start = min(center.real + way.now - way.high - margin, *own)
    end = max(center.real + way.now - way.low + margin, *own)
    beyond = addendum_of(rack.radius, measures)
    low, high = pitch - side * 1.5 * beyond, pitch + side * beyond
    corners = [complex(start, low), complex(end, low), complex(end, high), complex(start, high)]
    bar = (foot + corner * along for corner in corners)
    yield drawn_area(Role.WHEEL, rack.link, bar, tones(pose)[rack.link])
    ends = (foot + complex(x, pitch) * along for x in (start, end))
    yield drawn_line(Role.PITCH, rack.name, ends)


# ----------------------------------------------------------------------
# Symbols of rolling lines, as long as the path of the wheel.


@figure_symbols.register
def rolling_symbols(track: RollingLine, pose: Pose, measures: Measures) -> Iterator[Primitive]:
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
    if track.on == GROUND:
        yield drawn_line(Role.GROUND, track.name, (start, end))
        away = -1j * along * np.sign(center.imag)
        yield hatching(start, end, complex(away), measures.hatch, track.name)
    else:
        yield drawn_line(Role.LINK, track.on, (start, end), tones(pose)[track.on])


# ----------------------------------------------------------------------
# Symbol of a Geneva wheel: a star with slots and locking arcs, and the locking disc of its driver.
#
# The locking arcs keep the wheel at rest while the pin is outside the slots.


_LOCK = 0.82  # radius of the locking arcs over that of the pin's circle
_PIECE = 0.08  # angle of a piece of an arc [rad]


@figure_symbols.register
def slot_symbols(wheel: GenevaWheel, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The star and, if the pin turns about a fixed pivot, the locking disc."""
    centre, pin = pose.points[wheel.center], pose.points[wheel.pin]
    along = pose.points[wheel.rim] - centre
    radius, tone = abs(along), tones(pose)
    driver = _driver(pose, wheel)
    lock, distance, depth = 0.0, 0.0, abs(pin - centre)
    if driver is not None:
        middle = pose.points[driver[1]]
        lock, distance = _LOCK * abs(pin - middle), abs(middle - centre)
        depth = distance - abs(pin - middle)
    star = _star(wheel.count, radius, depth, lock, distance, measures)
    corners = centre + along / radius * star
    yield drawn_area(Role.WHEEL, wheel.link, corners, tone.get(wheel.link, 0))
    if driver is not None:
        room = 0.3 * measures.pin
        disc = _cut_disc(lock - room, radius + room, distance)
        corners = middle + (pin - middle) / abs(pin - middle) * disc
        yield drawn_area(Role.WHEEL, driver[0], corners, tone.get(driver[0], 0))


def rounds(wheel: GenevaWheel, pose: Pose) -> Iterator[tuple[str, float]]:
    """Centre and radius of the wheel, and of the locking disc."""
    yield wheel.center, abs(pose.points[wheel.rim] - pose.points[wheel.center])
    driver = _driver(pose, wheel)
    if driver is not None:
        yield driver[1], _LOCK * abs(pose.points[wheel.pin] - pose.points[driver[1]])


def _driver(pose: Pose, wheel: GenevaWheel) -> tuple[str, str] | None:
    """The link with the pin, and its fixed pivot."""
    fixed = set(pose.skeleton.fixed)
    return next(
        (
            (bar.name, point)
            for bar in pose.skeleton.bars
            for point in bar.points
            if wheel.pin in bar.points and point in fixed and point != wheel.pin
        ),
        None,
    )


def _star(
    count: int, radius: float, depth: float, lock: float, distance: float, measures: Measures
) -> ComplexArray:
    """The outline about the centre, one slot on the real axis."""
    half, step = measures.slot, math.tau / count
    mouth = math.asin(min(half / radius, 0.5))
    bottom = depth + half * np.exp(1j * np.linspace(1.5 * math.pi, 0.5 * math.pi, 12))
    slot = [radius * cmath.exp(-1j * mouth), *bottom, radius * cmath.exp(1j * mouth)]
    start, end = mouth, step - mouth
    rim = _arc(0.0, radius, start, end)
    # the locking arc is about the driver's pivot where the wheel rests, midway between two slots
    reach = _angle(radius, distance, lock)
    if start < step / 2 - reach:
        middle = distance * cmath.exp(0.5j * step)
        far = _angle(lock, distance, radius)
        back = 0.5 * step + math.pi
        rim = np.concatenate((
            _arc(0.0, radius, start, step / 2 - reach),
            _arc(middle, lock, back + far, back - far),
            _arc(0.0, radius, step / 2 + reach, end),
        ))  # fmt: skip
    side = np.concatenate((slot, rim))
    turned: ComplexArray = (np.exp(1j * step * np.arange(count))[:, None] * side).ravel()
    return turned


def _cut_disc(radius: float, cut: float, distance: float) -> ComplexArray:
    """The outline of a disc without the circle ``cut`` at a distance on the real axis."""
    own, other = _angle(radius, distance, cut), _angle(cut, distance, radius)
    disc = _arc(0.0, radius, own, math.tau - own)
    if not own:
        return disc
    return np.concatenate((disc, _arc(distance, cut, math.pi + other, math.pi - other)))


def _angle(one: float, distance: float, other: float) -> float:
    """The angle at the centre of circle ``one`` of its intersection with ``other``; 0 if none."""
    if not abs(one - other) < distance < one + other:
        return 0.0
    return math.acos((one**2 + distance**2 - other**2) / (2.0 * one * distance))


def _arc(centre: complex, radius: float, start: float, end: float) -> ComplexArray:
    count = max(2, math.ceil(abs(end - start) / _PIECE))
    return np.asarray(centre + radius * np.exp(1j * np.linspace(start, end, count)))


# ----------------------------------------------------------------------
# Symbols of springs: a zigzag between two points that compresses with the length.


_COILS = 9
_END = 0.14  # straight fraction of the length at each end


@figure_symbols.register
def spring_symbols(spring: SpringFigure, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A zigzag; none if the points coincide."""
    start, end = (pose.points[name] for name in spring.between)
    length = abs(end - start)
    if not length:
        return
    along = (end - start) / length
    across = 2.6 * measures.pin * 1j * along
    first, pitch = _END * length, (1.0 - 2.0 * _END) * length / _COILS
    corners = [start, start + first * along]
    for k in range(_COILS):
        side = across if k % 2 == 0 else -across
        corners.append(start + (first + (k + 0.5) * pitch) * along + side)
    corners += [end - first * along, end]
    yield drawn_line(Role.SPRING, spring.name, corners)


# ----------------------------------------------------------------------
# Symbols of rigid joints: a filled corner between two welded links.


_RADIUS = 2.0  # size of the filled corner, in pin radii
_NARROWEST = math.radians(50.0)  # visible part of a corner next to a pin
_PIECES = 12  # points of its arc


@figure_symbols.register
def weld_symbols(joint: RigidJoint, pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The filled corner between the two links, or over both if they are in line."""
    points = {bar.name: bar.points for bar in pose.skeleton.bars}
    ways = [_direction(pose, name, points.get(name, ()), joint.point) for name in joint.links]
    turn = phase(ways[1] / ways[0])
    if turn <= -math.pi + 1e-9:
        turn = math.pi  # collinear: always on the same side
    middle = ways[0] * cmath.exp(0.5j * turn)
    half = 0.5 * max(abs(turn), _NARROWEST)
    radius = _RADIUS * pin_radius(pose, joint.point, measures)
    place = pose.points[joint.point]
    arc = [
        place + radius * middle * cmath.exp(1j * half * (2.0 * k / _PIECES - 1.0))
        for k in range(_PIECES + 1)
    ]
    yield drawn_area(Role.WELD, " ".join(joint.links), [place, *arc])


def _direction(pose: Pose, link: str, carried: tuple[str, ...], point: str) -> complex:
    """The unit vector from a point along its link."""
    place = pose.points[point]
    away = [pose.points[name] - place for name in carried if name != point]
    nearest = min(away, key=abs, default=0j)
    if nearest == 0:
        return cmath.exp(1j * pose.angle(link))
    return nearest / abs(nearest)
