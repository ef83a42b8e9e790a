"""What is driven: a curved arrow around a pivot, a straight one along a slider or cylinder."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator

from linkwork.drawing.guide_symbols import Track
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Arc, Polyline, Primitive, Role, xy
from linkwork.mechanism.skeleton import Bar, DrivenPart

__all__ = ["input_arrows"]

_SWEEP = math.radians(110)


def input_arrows(
    pose: Pose, found: list[Track], measures: Measures, sense: float
) -> Iterator[Primitive]:
    """An arrow for every input, pointing where it grows, backwards if ``sense`` is negative."""
    guided = {track.name: track for track in found}
    struts = {strut.name: strut for strut in pose.skeleton.struts}
    bars = {bar.name: bar for bar in pose.skeleton.bars}
    for part in pose.skeleton.driven:
        turn = -1 if sense < 0 or part.backwards else 1
        if part.name in guided:
            track = guided[part.name]
            side = measures.block[1] if track.block else measures.slot
            middle = track.places[0] - (side + 1.7 * measures.pin) * track.away
            yield _straight(part, middle, turn * track.along, measures)
        elif part.name in struts:
            base, tip = (pose.points[name] for name in struts[part.name].between)
            along = (tip - base) / abs(tip - base)
            middle = base + 0.4 * (tip - base) + (measures.barrel + 1.7 * measures.pin) * along * 1j
            yield _straight(part, middle, turn * along, measures)
        elif part.name in bars and len(bars[part.name].points) > 1:
            yield _curved(pose, part, bars[part.name], measures, turn)


def _straight(part: DrivenPart, middle: complex, along: complex, measures: Measures) -> Polyline:
    reach = 3.6 * measures.pin * along
    return Polyline(
        role=Role.INPUT,
        of=part.name,
        points=(xy(middle - reach), xy(middle + reach)),
        head=measures.head,
    )


def _curved(pose: Pose, part: DrivenPart, bar: Bar, measures: Measures, turn: int) -> Arc:
    """The arrow around the pivot, where the fewest links are in its way."""
    name = part.pivot or bar.points[0]
    pivot = pose.points[name]
    arms = [pose.points[other] - pivot for other in bar.points if other != name]
    reach = max(arms, key=abs)
    radius = max(2.2 * measures.pin, min(4.6 * measures.pin, 0.6 * abs(reach)))
    heading = cmath.phase(reach)
    taken = [
        cmath.phase(pose.points[other] - pivot)
        for link in pose.skeleton.bars
        if name in link.points
        for other in link.points
        if pose.points[other] != pivot
    ]
    if name in pose.skeleton.fixed:
        taken += [math.radians(degrees) for degrees in (-125, -105, -75, -55)]
    middles = [heading + math.radians(75) * turn + math.tau * k / 24 for k in range(24)]
    best = min(middles, key=lambda middle: _crowding(middle, taken, middles[0]))
    return Arc(
        role=Role.INPUT,
        of=part.name,
        centre=xy(pivot),
        radius=radius,
        start=best - turn * _SWEEP / 2,
        sweep=turn * _SWEEP,
        head=measures.head,
    )


def _crowding(middle: float, taken: list[float], wanted: float) -> float:
    """How many arms an arc around ``middle`` meets; ties go to the arc nearest the wanted one."""
    room = _SWEEP / 2 + math.radians(12)
    met = sum(_between(middle, angle) < room for angle in taken)
    return met + _between(middle, wanted) / 10


def _between(a: float, b: float) -> float:
    """The angle between two directions, 0 to π."""
    return abs(math.remainder(a - b, math.tau))
