"""Symbols of sliders and slots: a block on a rail, a collar on a rod, a pin in a slot."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise, product

import numpy as np

from linkwork.core.drawing.labels import Kept, Obstacles
from linkwork.core.drawing.links import (
    Gap,
    convex_outline,
    couplings,
    hatching,
    in_line,
    stems,
    uncovered,
)
from linkwork.core.drawing.pose import Pose, travel_along
from linkwork.core.drawing.scene import (
    Arc,
    Box,
    Measures,
    Polyline,
    Primitive,
    Role,
    drawn_arc,
    drawn_area,
    drawn_line,
)
from linkwork.core.drawing.wheels import outer_radius
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.bodies import DiscFigure, Guide
from linkwork.core.mechanism.part.guides import GenevaWheel, Strut
from linkwork.core.mechanism.skeleton import Bar, DrivenPart, Rail


@dataclass(frozen=True, kw_only=True)
class Track:
    """The drawn geometry of a slider or slot.

    Parameters
    ----------
    name, on : str
        Names of the slider or slot, and of the link with the line.
    along, away : complex
        Unit vectors of the line and towards the side of the rail and its hatching.
    start, end : complex
        The ends of the travel along the line.
    places : tuple of complex
        The current positions of blocks or pins.
    foot, tip : complex
        The two points of the link that define the line.
    shown : bool
        Whether it has a symbol: slots of Geneva wheels and grooves of couplings are drawn with
        their links.
    """

    name: str
    on: str
    tone: int
    block: bool = True
    fixed: bool = False
    along: complex
    away: complex
    start: complex
    end: complex
    places: tuple[complex, ...]
    foot: complex
    tip: complex
    shown: bool = True


def tracks(pose: Pose, measures: Measures, tone_of: Mapping[str, int]) -> list[Track]:
    """The geometry of all sliders and slots; the points of one slider share it."""
    groups: dict[str, list[Guide]] = {}
    for guide in pose.skeleton.guides:
        groups.setdefault(guide.name, []).append(guide)
    hidden = {wheel.name for wheel in pose.skeleton.of(GenevaWheel)}
    hidden |= {name for coupling in couplings(pose.skeleton) for name in coupling.guides}
    found = [
        replace(_track(pose, measures, guides, tone_of), shown=name not in hidden)
        for name, guides in groups.items()
    ]
    return found + [_rail_track(pose, measures, rail, tone_of) for rail in pose.skeleton.rails]


def _on_link(pose: Pose, rail: Rail, line: tuple[str, str], tone_of: Mapping[str, int]) -> Track:
    """A block on a link."""
    foot, tip = (pose.points[name] for name in line)
    along = (tip - foot) / abs(tip - foot)
    travel = travel_along(pose, rail.points[0], line)
    return Track(
        name=rail.name,
        on=rail.on,
        tone=tone_of.get(rail.on, 1),
        along=along,
        away=along * -1j,
        start=foot + travel.low * along,
        end=foot + travel.high * along,
        places=(pose.points[rail.points[0]],),
        foot=foot,
        tip=tip,
    )


def _rail_track(pose: Pose, measures: Measures, rail: Rail, tone_of: Mapping[str, int]) -> Track:
    """A block on a line, at the joint of the sliding body with another one."""
    if rail.line is not None:
        return _on_link(pose, rail, rail.line, tone_of)
    carrying = [p for p in rail.points if p in pose.skeleton.pins] or list(rail.points[:1])
    places = tuple(pose.points[p] for p in carrying)
    ways = [pose.paths.get(p, np.array([pose.points[p]])) for p in carrying]
    far = np.concatenate([((way - places[0]) * rail.along.conjugate()).real for way in ways])
    return Track(
        name=rail.name,
        on=GROUND,
        tone=1,
        fixed=True,
        along=rail.along,
        away=_rail_side(pose, rail.points, rail.along, measures),
        start=places[0] + float(np.nanmin(far)) * rail.along,
        end=places[0] + float(np.nanmax(far)) * rail.along,
        places=places,
        foot=places[0],
        tip=places[0] + rail.along,
    )


def _track(
    pose: Pose, measures: Measures, guides: list[Guide], tone_of: Mapping[str, int]
) -> Track:
    guide = guides[0]
    along = pose.direction(guide)
    fixed = pose.on_ground(guide)
    # The block is at the joint of the sliding link with another one, or at its first point;
    # it is set back from a cam that it follows.
    stem = stems(pose, measures)
    free = [g for g in guides if g.point not in stem] or guides
    carrying = [g for g in free if g.point in pose.skeleton.pins] or free[:1]
    back = stem.get(carrying[0].point, 0j)
    places = tuple(pose.points[g.point] + back for g in carrying)
    travels = [pose.displacement(g) for g in carrying]
    # where the displacement is zero
    first = places[0] - travels[0].now * along
    low, high = min(t.low for t in travels), max(t.high for t in travels)
    if not guide.block and not fixed and not pose.paths:
        low, high = _slot_without_motion(pose, guide, low, high, measures)
    return Track(
        name=guide.name,
        on=guide.on,
        tone=tone_of.get(guide.on, 1),
        block=guide.block,
        fixed=fixed,
        along=along,
        away=_rail_side(pose, [g.point for g in guides], along, measures) if fixed else along * -1j,
        start=first + low * along,
        end=first + high * along,
        places=places,
        foot=pose.points[guide.line[0]],
        tip=pose.points[guide.line[1]],
    )


def _slot_without_motion(
    pose: Pose, guide: Guide, low: float, high: float, measures: Measures
) -> tuple[float, float]:
    """The default travel without a motion: most of the line if the pin is on it."""
    length = abs(pose.points[guide.line[1]] - pose.points[guide.line[0]])
    margin = 5 * measures.pin
    if margin < low < length - margin:
        return margin, length - margin
    return low - margin, high + margin


def _rail_side(pose: Pose, points: Sequence[str], along: complex, measures: Measures) -> complex:
    """The hatched side of a fixed line, the same in all positions of a motion.

    Below by convention; above only if the links that move the slider are always below the line.
    Upright lines are hatched on the side away from these links.
    """
    upright = abs(along.real) < 0.2
    below = along * -1j if along.real > 0 or upright else along * 1j
    own = set(points)
    others = {
        point for bar in pose.skeleton.bars if own & set(bar.points) for point in bar.points
    } - own
    if not others:
        return below
    start = pose.points[points[0]]
    depths = np.concatenate([
        ((pose.paths.get(name, np.array([pose.points[name]])) - start) * below.conjugate()).real
        for name in sorted(others)
    ])  # fmt: skip
    depths = depths[np.isfinite(depths)]
    if upright:
        # an upright line has no lower side: hatch the side away from the links on average
        return -below if np.mean(depths) > 0.01 * measures.size else below
    # Without a motion, hatch above only if a link is steeply below the line.
    clear = 0.0 if pose.paths else 0.5 * max(abs(pose.points[name] - start) for name in others)
    clear += 1e-6 * measures.size  # a level link does not count as above
    return -below if np.min(depths, initial=np.inf) > clear else below


def track_gaps(found: list[Track], measures: Measures) -> dict[str, list[Gap]]:
    """The hidden parts of the bars of carrying links, by link."""
    gaps: dict[str, list[Gap]] = {}
    for track in found:
        if track.block:
            pieces = [(place, measures.block[0] * track.along) for place in track.places]
        else:
            reach = abs(track.end - track.start) / 2 + _slot_end(measures)
            pieces = [((track.start + track.end) / 2, reach * track.along)]
        gaps.setdefault(track.on, []).extend(pieces)
    return gaps


def guide_symbols(found: list[Track], measures: Measures) -> Iterator[Primitive]:
    """The symbols of all sliders and slots."""
    for track in found:
        if not track.shown:
            continue
        if track.block:
            yield from _blocks(track, measures)
            yield from _rail(track, measures) if track.fixed else _rod(track, measures)
        else:
            yield from _slot(track, measures)


def _blocks(track: Track, measures: Measures) -> Iterator[Primitive]:
    half, height = measures.block
    along, across = half * track.along, height * track.along * 1j
    for z in track.places:
        corners = (z - along - across, z + along - across, z + along + across, z - along + across)
        yield drawn_area(Role.SLIDER, track.name, corners)


def _rail(track: Track, measures: Measures) -> Iterator[Primitive]:
    """A hatched line under the block, slightly longer than its travel."""
    half, height = measures.block
    reach, down = 1.6 * half * track.along, height * track.away
    start, end = track.start - reach + down, track.end + reach + down
    yield drawn_line(Role.GROUND, track.name, (start, end))
    yield hatching(start, end, track.away, measures.hatch, track.name)


def _rod(track: Track, measures: Measures) -> Iterator[Primitive]:
    """The rod of a collar, and an arm to the link if the line is offset."""
    reach = 1.6 * measures.block[0]
    foot = track.foot
    arm = ((track.start - foot) * track.along.conjugate()).imag * track.along * 1j
    knee = foot + arm
    ends = [knee, track.start - reach * track.along, track.end + reach * track.along]
    ends.sort(key=lambda z: (z * track.along.conjugate()).real)
    hidden = [(place, measures.block[0] * track.along) for place in track.places]
    for start, end in uncovered(ends[0], ends[-1], hidden):
        yield _bar(track, start, end)
    if abs(arm) > 1e-6 * measures.size:
        yield _bar(track, foot, knee)


def _bar(track: Track, start: complex, end: complex) -> Polyline:
    return drawn_line(Role.LINK, track.on, (start, end), track.tone)


def _slot_end(measures: Measures) -> float:
    """The distance from the last position of the pin to the end of its slot."""
    return measures.slot + 0.8 * measures.pin


def _slot(track: Track, measures: Measures) -> Iterator[Primitive]:
    """Two parallel lines with round ends around the travel of the pin."""
    width = measures.slot
    # a fixed slot is drawn longer, like rails
    reach = _slot_end(measures) + (3 * measures.pin if track.fixed else 0.0)
    over = (reach - width) * track.along
    start, end = track.start - over, track.end + over
    turn = [width * cmath.exp(1j * cmath.pi * (k / 10 - 0.5)) * track.along for k in range(11)]
    outline = [end + w for w in turn] + [start - w for w in turn]
    if track.fixed:
        yield drawn_line(Role.GROUND, track.name, [*outline, outline[0]])
        down = width * track.away
        yield hatching(start + down, end + down, track.away, measures.hatch, track.name)
        return
    yield drawn_area(Role.SLOT, track.name, outline, track.tone)
    # If all points of the link are off the slot, connect the link to it.
    length, low, high = (
        ((z - track.foot) * track.along.conjugate()).real
        for z in (track.tip, start - width * track.along, end + width * track.along)
    )
    if low > length:
        yield _bar(track, track.tip, start - width * track.along)
    elif high < 0:
        yield _bar(track, end + width * track.along, track.foot)


# ----------------------------------------------------------------------
# Arrows of inputs: curved around a pivot, straight along a slider or cylinder.
#
# An arrow is placed near the driven part where it covers least of the drawing; if nothing is in the
# way, at its default position.


_SWEEP = math.radians(110)
_LONGEST = 15.0  # length of an arrow around a large ring, in pin radii
_TURNED = 0.5  # penalty for rotating an arrow from its default position [1/rad]
_WIDER = (1.0, 1.4)  # multiples of its default radius
_AROUND_PLATE = (1.0, 1.4, 1.9)  # a plate around the pivot may cover the default position
_WIDENED = 9.0  # penalty per multiple
_OTHER_SIDE = 2.0  # penalty for the other side of a slider or cylinder
_FURTHER = 2.0  # penalty for a larger distance from it
_MOVED = 0.3  # penalty for a shift along it by a pin radius


@dataclass(frozen=True)
class _Place:
    """A possible position of an arrow, and its penalty relative to the default."""

    arrow: Arc | Polyline
    cost: float


def input_arrows(
    pose: Pose,
    found: list[Track],
    measures: Measures,
    sense: float,
    drawn: Sequence[Primitive],
    kept: Kept | None = None,
) -> list[Primitive]:
    """An arrow for every input in its positive direction, reversed if ``sense`` is negative.

    The arrows avoid covering ``drawn``; those in ``kept`` are placed as before.
    """
    kept = {} if kept is None else kept
    guided = {track.name: track for track in found}
    struts = {strut.name: strut for strut in pose.skeleton.struts}
    bars = {bar.name: bar for bar in pose.skeleton.bars}
    arrows: list[Primitive] = []
    for part in pose.skeleton.driven:
        turn = -1 if sense < 0 or part.backwards else 1
        places: Iterator[_Place] = iter(())
        if part.name in guided:
            places = _along_track(part, guided[part.name], measures, turn)
        elif part.name in struts:
            places = _along_strut(pose, struts[part.name], measures, turn)
        elif part.name in bars:
            places = _around_pivot(pose, part, bars[part.name], measures, turn)
        key = Role.INPUT, part.name
        choices = list(islice(places, kept[key], kept[key] + 1) if key in kept else places)
        if len(choices) > 1:
            kept[key] = _freest(choices, Obstacles.of([*drawn, *arrows]), measures)
            choices = choices[kept[key] :]
        arrows += [place.arrow for place in choices[:1]]
    return arrows


def _freest(places: Sequence[_Place], obstacles: Obstacles, measures: Measures) -> int:
    """The number of the arrow that covers least; the first among equals."""
    boxes = [[box.edges for box in _boxes(place.arrow, measures)] for place in places]
    # arrays need equal counts: shorter arrows repeat their last box
    most = max(map(len, boxes))
    filled = np.array([own + own[-1:] * (most - len(own)) for own in boxes])
    cost = np.array([place.cost for place in places]) + obstacles.costs(filled)
    return int(np.argmin(cost))


def _boxes(arrow: Arc | Polyline, measures: Measures) -> list[Box]:
    """Small boxes that cover an arrow, with a margin."""
    room = 0.45 * measures.pin
    places = [complex(*arrow.points[0])]
    for start, end in pairwise(complex(*point) for point in arrow.points):
        pieces = max(1, math.ceil(abs(end - start) / (2 * room)))
        places += [start + (end - start) * k / pieces for k in range(1, pieces + 1)]
    boxes = [Box(z.real, z.imag, z.real, z.imag).grown(room) for z in places]
    return [*boxes, Box.around(arrow.arrow_head).grown(0.2 * room)]


def _along_track(part: DrivenPart, track: Track, measures: Measures, turn: int) -> Iterator[_Place]:
    """Positions next to a block or slot: on the side away from its rail, or behind the hatching."""
    side = measures.block[1] if track.block else measures.slot
    behind = side + (measures.hatch if track.fixed else 0.0)
    gap = 1.7 * measures.pin
    for further, moved in product(range(3), (0.0, 3.0, -3.0, 8.0, -8.0)):
        cost = _FURTHER * further + _MOVED * abs(moved)
        along = moved * measures.pin * track.along
        away = (1 + 0.8 * further) * gap
        for off, extra in ((-side - away, 0.0), (behind + away, _OTHER_SIDE)):
            middle = track.places[0] + along + off * track.away
            yield _Place(_straight(part.name, middle, turn * track.along, measures), cost + extra)


def _along_strut(pose: Pose, strut: Strut, measures: Measures, turn: int) -> Iterator[_Place]:
    """Positions next to a cylinder: left of its barrel, elsewhere along it, or to the right."""
    base, tip = (pose.points[name] for name in strut.between)
    if base == tip:
        return
    length = abs(tip - base)
    along = (tip - base) / length
    for further, share in product(range(3), (0.4, 0.5, 0.6, 0.3, 0.7, 0.2, 0.8)):
        cost = _FURTHER * further + _MOVED * abs(share - 0.4) * length / measures.pin
        away = measures.barrel + (1 + 0.8 * further) * 1.7 * measures.pin
        for off, extra in ((away, 0.0), (-away, _OTHER_SIDE)):
            middle = base + (share * length + off * 1j) * along
            yield _Place(_straight(strut.name, middle, turn * along, measures), cost + extra)


def _straight(of: str, middle: complex, along: complex, measures: Measures) -> Polyline:
    reach = 3.6 * measures.pin * along
    return drawn_line(Role.INPUT, of, (middle - reach, middle + reach), head=measures.head)


def _around_pivot(
    pose: Pose, part: DrivenPart, bar: Bar, measures: Measures, turn: int
) -> Iterator[_Place]:
    """Positions around the pivot, by default ahead of the link."""
    name = part.pivot or bar.points[0]
    pivot = pose.points[name]
    others = [pose.points[other] - pivot for other in bar.points if other != name]
    reach = max(others, key=abs, default=0j)
    # A one-point wheel shows its angle by a mark; the arrow is ahead of it.
    reach = reach or measures.size * cmath.exp(1j * pose.angle(bar.name))
    radius = max(2.2 * measures.pin, min(4.6 * measures.pin, 0.6 * abs(reach)))
    discs = [d for d in pose.skeleton.of(DiscFigure) if (d.link, d.center) == (bar.name, name)]
    if discs:
        radius = _around_wheel(discs, measures)
    usual = phase(reach) + math.radians(75) * turn
    plate = len(others) > 1 and not in_line(convex_outline([pivot, *(pivot + z for z in others)]))
    turns = np.linspace(0.0, math.tau, 24, endpoint=False).tolist()
    for away, wider in product(turns, _AROUND_PLATE if plate else _WIDER):
        own = wider * radius
        sweep = turn * min(_SWEEP, _LONGEST * measures.pin / own)
        start = usual + away - sweep / 2
        arrow = drawn_arc(Role.INPUT, part.name, pivot, own, start, sweep, measures.head)
        cost = _TURNED * abs(math.remainder(away, math.tau)) + _WIDENED * (wider - 1.0)
        yield _Place(arrow, cost)


def _around_wheel(discs: Sequence[DiscFigure], measures: Measures) -> float:
    """The radius of an arrow around a wheel: inside it if space permits; outside a ring."""
    most = max(discs, key=lambda disc: disc.radius)
    inside = min(4.6 * measures.pin, 0.6 * most.radius)
    if most.ring or inside < 2.8 * measures.pin:
        return outer_radius(most, measures) + 2.0 * measures.pin
    return inside
