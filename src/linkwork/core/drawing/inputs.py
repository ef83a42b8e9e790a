"""Arrows of inputs: curved around a pivot, straight along a slider or cylinder.

An arrow is placed near the driven part where it covers least of the drawing; if nothing is in the
way, at its default position.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice, pairwise, product

import numpy as np

from linkwork.core.drawing.guides import Track
from linkwork.core.drawing.labels import Kept, Obstacles
from linkwork.core.drawing.links import convex_outline, in_line
from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import (
    Arc,
    Box,
    Measures,
    Polyline,
    Primitive,
    Role,
    drawn_arc,
    drawn_line,
)
from linkwork.core.drawing.wheels import outer_radius
from linkwork.core.foundation.lanes import phase
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.mechanism.part.guides import Strut
from linkwork.core.mechanism.skeleton import Bar, DrivenPart

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
