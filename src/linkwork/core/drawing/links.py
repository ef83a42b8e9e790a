"""Symbols of Oldham couplings: two discs with a groove across, and the cross that slides in both.

A coupling is a link without pins that slides along two links, each about a fixed pivot on its line.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import (
    COINCIDENT,
    Hatch,
    Measures,
    Polyline,
    Primitive,
    Role,
    drawn_area,
    drawn_disc,
    drawn_line,
    xy,
)
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.mechanism.bodies import Contour, DiscFigure as Wheel, Follower, Guide
from linkwork.core.mechanism.skeleton import Bar, Skeleton


@dataclass(frozen=True, kw_only=True)
class Coupling:
    """The link that slides in two discs, and for each disc its guide and its fixed centre."""

    cross: str
    discs: tuple[tuple[Guide, str], ...]

    @property
    def links(self) -> set[str]:
        """The links drawn as discs and cross."""
        return {self.cross, *(guide.on for guide, _ in self.discs)}

    @property
    def guides(self) -> set[str]:
        """The names of the sliders drawn as grooves."""
        return {guide.name for guide, _ in self.discs}

    def radius(self, pose: Pose, disc: int) -> float:
        """The radius of a disc: up to its furthest point, and to the other centre at least.

        The middle of a square cross moves on the circle through both centres.
        """
        guide, centre = self.discs[disc]
        points = next(bar.points for bar in pose.skeleton.bars if bar.name == guide.on)
        reached = (*points, self.discs[1 - disc][1])
        return max(abs(pose.points[name] - pose.points[centre]) for name in reached)


def couplings(skeleton: Skeleton) -> list[Coupling]:
    """All couplings of a mechanism."""
    points = {bar.name: bar.points for bar in skeleton.bars}
    by_link: dict[str, dict[str, Guide]] = {}
    for guide in skeleton.guides:
        if guide.block:
            by_link.setdefault(guide.link, {}).setdefault(guide.name, guide)
    found = []
    for link, guides in by_link.items():
        carried = [(guide, _centre(skeleton, guide, points)) for guide in guides.values()]
        discs = tuple((guide, centre) for guide, centre in carried if centre is not None)
        free = not set(points.get(link, ())) & set(skeleton.pins)
        if free and len(discs) == len(guides) == 2 == len({guide.on for guide, _ in discs}):
            found.append(Coupling(cross=link, discs=discs))
    return found


def _centre(skeleton: Skeleton, guide: Guide, points: dict[str, tuple[str, ...]]) -> str | None:
    """The fixed pivot of the link with the guide's line, if it is on that line."""
    if guide.offset or guide.on not in points:
        return None
    return next((name for name in guide.line if name in skeleton.fixed), None)


def coupling_symbols(
    found: list[Coupling], pose: Pose, measures: Measures, tone: Mapping[str, int]
) -> Iterator[Primitive]:
    """The discs, their grooves, and the cross."""
    half = 2.0 * measures.pin
    for coupling in found:
        own = next((b.points for b in pose.skeleton.bars if b.name == coupling.cross), ())
        middle = pose.points[coupling.discs[0][0].point]
        sizes = [coupling.radius(pose, k) for k in range(2)]
        reach = max([0.4 * min(sizes), *(abs(pose.points[name] - middle) for name in own)])
        for (guide, name), radius in zip(coupling.discs, sizes, strict=True):
            centre, number = pose.points[name], tone.get(guide.on, 1)
            yield drawn_disc(Role.WHEEL, guide.on, centre, radius, number)
        for (guide, name), radius in zip(coupling.discs, sizes, strict=True):
            along = pose.direction(guide)
            groove = _bar(pose.points[name], along, (radius**2 - half**2) ** 0.5, half)
            yield drawn_area(Role.SLOT, guide.name, groove, tone.get(guide.on, 1))
        for guide, _ in coupling.discs:
            tongue = _bar(middle, pose.direction(guide), reach, 0.8 * half)
            yield drawn_area(Role.SLIDER, coupling.cross, tongue)


def _bar(middle: complex, along: complex, reach: float, half: float) -> list[complex]:
    """A rectangle about its middle."""
    ends = (-reach - 1j * half, reach - 1j * half, reach + 1j * half, -reach + 1j * half)
    return [middle + along * end for end in ends]


# ----------------------------------------------------------------------
# Symbols of links: a bar between two points, a filled plate through three or more.


_IN_LINE = 1e-6  # relative deviation from a line below which a link is a bar
_ON_SIDE = 1e-9  # relative double area of a triangle below which its corner is ignored

#: A piece of a line hidden by a slot or block: its middle, and the vector to its end.
Gap = tuple[complex, complex]


def tones(pose: Pose) -> Mapping[str, int]:
    """The tone of every link: 0 if driven, otherwise its number."""
    driven = {part.name for part in pose.skeleton.driven}
    free = [bar.name for bar in pose.skeleton.bars if bar.name not in driven]
    return dict.fromkeys(driven, 0) | {name: k for k, name in enumerate(free, 1)}


def link_symbols(pose: Pose, gaps: Mapping[str, list[Gap]]) -> Iterator[Primitive]:
    """The symbols of all links; ``gaps`` are the interruptions of bars by slots and blocks."""
    tone = tones(pose)
    hidden = {name for coupling in couplings(pose.skeleton) for name in coupling.links}
    for bar in (bar for bar in pose.skeleton.bars if bar.name not in hidden):
        yield from _link(pose, bar, tone[bar.name], gaps.get(bar.name, []))


def _link(pose: Pose, bar: Bar, tone: int, gaps: list[Gap]) -> Iterator[Primitive]:
    points = [pose.points[name] for name in dict.fromkeys(bar.points)]
    if len(points) < 2:
        return
    outline = convex_outline(points)
    if in_line(outline):
        for start, end in uncovered(outline[0], outline[-1], gaps):
            yield drawn_line(Role.LINK, bar.name, (start, end), tone)
    else:
        yield drawn_area(Role.PLATE, bar.name, outline, tone)


def pin_radius(pose: Pose, name: str, measures: Measures) -> float:
    """The radius of a pin, reduced at the centre of a small wheel."""
    discs = pose.skeleton.of(Wheel)
    # wheels of a draft may have no radius yet
    radii = (0.4 * disc.radius for disc in discs if disc.center == name and disc.radius > 0)
    # still a length beside the coordinates of a much larger mechanism
    return min([measures.pin, *(max(radius, COINCIDENT * measures.size) for radius in radii)])


def pin_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A circle at every pin, a dot at every other drawn point."""
    skeleton = pose.skeleton
    joined = set(skeleton.pins) | {p for strut in skeleton.struts for p in strut.between}
    for name, place in pose.points.items():
        if name in pose.construction:
            continue
        if name in joined:
            radius = pin_radius(pose, name, measures)
            yield drawn_disc(Role.PIN, name, place, radius)
        else:
            role = Role.TRACED if name in skeleton.traced else Role.POINT
            yield drawn_disc(role, name, place, measures.dot)


def convex_outline(points: Iterable[complex]) -> list[complex]:
    """The corners of the smallest convex polygon around points, counter-clockwise.

    Collinear points are reduced to the two ends.

    References
    ----------
    A. M. Andrew, Another efficient algorithm for convex hulls in two dimensions,
    Information Processing Letters 9 (1979) 216-219, doi:10.1016/0020-0190(79)90072-3.
    """
    ordered = sorted(set(points), key=lambda z: (z.real, z.imag))
    # Sorting alone fails for an upright line whose x values differ by rounding.
    ends = max(product(ordered, ordered), key=lambda pair: abs(pair[1] - pair[0]))
    if in_line([ends[0], *ordered, ends[1]]):
        return list(ends)
    # Corners on a side, up to rounding, are removed in every position of a link.
    flat = _ON_SIDE * abs(ends[1] - ends[0]) ** 2
    lower, upper = _half_outline(ordered, flat), _half_outline(ordered[::-1], flat)
    return lower[:-1] + upper[:-1]


def _half_outline(ordered: list[complex], flat: float) -> list[complex]:
    chain: list[complex] = []
    for z in ordered:
        while len(chain) > 1 and _left_of(chain[-2], chain[-1], z) <= flat:
            chain.pop()
        chain.append(z)
    return chain


def _left_of(a: complex, b: complex, z: complex) -> float:
    """Twice the area of the triangle a b z, positive if z lies to the left of a → b."""
    return ((b - a).conjugate() * (z - a)).imag


def in_line(points: list[complex]) -> bool:
    """Whether points are collinear; the first and last are furthest apart."""
    start, end = points[0], points[-1]
    length = abs(end - start)
    return all(abs(_left_of(start, end, z)) <= _IN_LINE * length * length for z in points)


def uncovered(start: complex, end: complex, gaps: list[Gap]) -> Iterator[tuple[complex, complex]]:
    """The parts of the line from start to end without the gaps on it."""
    length = abs(end - start)
    if not length:
        return
    along = (end - start) / length
    holes = []
    for middle, half in gaps:
        place = (middle - start) * along.conjugate()
        turned = half * along.conjugate()
        if max(abs(place.imag), abs(turned.imag)) <= _IN_LINE * length:
            holes.append((place.real - abs(half), place.real + abs(half)))
    reached = 0.0
    for low, high in [*sorted(holes), (length, length)]:
        if low > reached:
            yield start + reached * along, start + min(low, length) * along
        reached = max(reached, high)


# ----------------------------------------------------------------------
# Ground symbols: a hatched triangle under each pivot; hatching of lines.


_FLOOR = 3.1  # below the pivot, in radii of its pin
DEPTH = _FLOOR + 1.4  #: Distance to the lower end of the hatching.


def ground_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """A triangle with a hatched base line under every pivot on ground."""
    skeleton = pose.skeleton
    carried = {point for bar in skeleton.bars for point in bar.points}
    carried |= {point for strut in skeleton.struts for point in strut.between}
    held = {point for figure in skeleton.figures for point in figure.ends}
    carried |= held - {guide.point for guide in skeleton.guides}  # on a guide already
    for name in skeleton.fixed:
        if name in carried:
            own = replace(measures, pin=pin_radius(pose, name, measures))
            yield from _pivot(name, pose.points[name], own)


def _pivot(name: str, place: complex, measures: Measures) -> Iterator[Primitive]:
    half, floor, depth = 1.9 * measures.pin, 2.9 * measures.pin, _FLOOR * measures.pin
    left, right = place - half - 1j * depth, place + half - 1j * depth
    yield drawn_area(Role.GROUND, name, (place, left, right))
    start, end = place - floor - 1j * depth, place + floor - 1j * depth
    yield drawn_line(Role.GROUND, name, (start, end))
    yield hatching(start, end, -1j, measures.hatch, name)


def hatching(start: complex, end: complex, away: complex, depth: float, of: str) -> Hatch:
    """Strokes at 45° behind the line from start to end, on the side of the unit vector ``away``."""
    along = (end - start) / abs(end - start)
    length = abs(end - start)
    # equally spaced strokes, with a distance of about their depth
    count = max(2, math.floor((length - depth) / depth + 1.5))
    step = (length - depth) / (count - 1)
    feet = [start + (depth + k * step) * along for k in range(count)]
    return Hatch(
        role=Role.HATCH,
        of=of,
        strokes=tuple((xy(foot), xy(foot + depth * (away - along))) for foot in feet),
    )


# ----------------------------------------------------------------------
# The drawn line of a contour, and the spoke that shows the angle of its link.


_MOST = 400  # approximate number of drawn points: about a hundredth of the size apart


def contour_line(pose: Pose, contour: Contour) -> ComplexArray:
    """The drawn points of an outline or curve at the current position."""
    points = pose.placed(contour)
    last = len(points) - 1
    shown = np.unique([*range(0, last, max(1, round(last / _MOST))), last])
    # A closed outline may repeat its first point at the end.
    again = contour.closed and abs(points[last] - points[0]) <= 1e-9 * float(np.ptp(points.real))
    found: ComplexArray = points[shown[:-1] if again else shown]
    return found


def contour_mark(pose: Pose, contour: Contour, tone: int, measures: Measures) -> Polyline:
    """A spoke that shows the rotation of a body with a round outline."""
    way = np.exp(1j * pose.angle(contour.link))
    centre = pose.points[contour.center]
    reach = 0.7 * float(np.abs(np.array(contour.points)).min())
    ends = (centre + min(measures.pin, 0.5 * reach) * way, centre + reach * way)
    return drawn_line(Role.MARK, contour.link, ends, tone)


# ----------------------------------------------------------------------
# Stems of followers: from the contact point on a cam to the guiding block.


def stems(pose: Pose, measures: Measures) -> dict[str, complex]:
    """For every slider point that touches a cam: the vector to its block, which is set back.

    0 if the slider has other points: the block is drawn at one of these.
    """
    found = {}
    for follower in pose.skeleton.of(Follower):
        guides = [g for g in pose.skeleton.guides if g.name == follower.slider and g.block]
        if guides:
            along = pose.direction(guides[0])
            away = pose.points[follower.point] - pose.points[follower.center]
            outwards = math.copysign(1.0, (away * along.conjugate()).real)
            alone = all(guide.point == follower.point for guide in guides)
            travel = pose.displacement(guides[0])
            # Long enough that the rail ends before the cam at maximum lift.
            length = travel.high - travel.low + 9 * measures.pin
            found[follower.point] = length * outwards * along if alone else 0j
    return found
