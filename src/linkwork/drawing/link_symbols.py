"""Symbols of links: a bar between two points, a filled plate through three or more."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import product

from linkwork.drawing.coupling_symbols import couplings
from linkwork.drawing.measures import COINCIDENT, Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Disc, Polygon, Polyline, Primitive, Role, xy
from linkwork.mechanism.figures import Disc as Wheel
from linkwork.mechanism.skeleton import Bar

__all__ = [
    "Gap",
    "convex_outline",
    "in_line",
    "link_symbols",
    "pin_radius",
    "pin_symbols",
    "tones",
    "uncovered",
]

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
            yield Polyline(role=Role.LINK, of=bar.name, tone=tone, points=(xy(start), xy(end)))
    else:
        yield Polygon(role=Role.PLATE, of=bar.name, tone=tone, points=tuple(map(xy, outline)))


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
            yield Disc(role=Role.PIN, of=name, centre=xy(place), radius=radius)
        else:
            role = Role.TRACED if name in skeleton.traced else Role.POINT
            yield Disc(role=role, of=name, centre=xy(place), radius=measures.dot)


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
