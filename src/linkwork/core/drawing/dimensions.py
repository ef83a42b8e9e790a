"""Positions of the vectors of a loop equation: head to tail around a closed polygon.

A sum has no order of terms. The order in which most vectors end at points of the mechanism places
them over its links.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product

from linkwork.core.drawing.annotations import (
    Annotation,
    SceneOptions,
    force_arrows,
    position_marks,
    rate_arrows,
)
from linkwork.core.drawing.labels import Choice, Obstacles, places_along, places_at, places_within
from linkwork.core.drawing.links import convex_outline, in_line
from linkwork.core.drawing.paths import centre_symbols, centrode_symbols, colour_scale, speed_traces
from linkwork.core.drawing.pose import Pose, printed_formula, printed_name, printed_value
from linkwork.core.drawing.scene import (
    COINCIDENT,
    Box,
    Measures,
    Polyline,
    Primitive,
    Role,
    drawn_arc,
    drawn_line,
    drawn_text,
    text_width,
)
from linkwork.core.foundation.lanes import phase
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.mechanism.skeleton import DrivenPart
from linkwork.core.results.link_motion import centrodes, instant_centres
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import LoopVector, Position, VectorLoop

_NAMED = 0.1  # additional value for an end at a point in the loop's name
_IN_TURN = 0.05  # additional value if this point is next in the name
_MOST = 10  # maximum number of vectors to reorder: 2^10 partial sums from every point


@dataclass(frozen=True)
class Edge:
    """A drawn vector: tail and tip of its arrow."""

    vector: LoopVector
    tail: complex
    tip: complex


@dataclass(frozen=True)
class _Step:
    """A vector as a step of the polygon; ``against``: opposite to its arrow."""

    vector: LoopVector
    way: complex
    against: bool


def polygon(loop: VectorLoop, pose: Pose) -> list[Edge]:
    """The closed polygon of a loop equation, over the mechanism as far as possible.

    Left-hand vectors are traversed forwards, right-hand ones backwards. Loops of more than ten
    vectors keep their written order.
    """
    steps = _written(loop)
    size = max((abs(step.way) for step in steps), default=0.0)
    if not size:
        return []
    best, start = -1.0, 0j
    ordered = steps
    for place in _starts(loop, pose):
        worth, order = _ordered(steps, place, loop, pose, COINCIDENT * size)
        if worth > best + 1e-9:
            best, start, ordered = worth, place, order
    edges = []
    for step in ordered:
        after = start + step.way
        ends = (after, start) if step.against else (start, after)
        edges.append(Edge(step.vector, *ends))
        start = after
    return edges


def _written(loop: VectorLoop) -> list[_Step]:
    """The written order around the loop: the left side, then the right side reversed."""
    left = [_Step(v, v.value, v.backwards) for v in loop.left]
    right = [_Step(v, -v.value, not v.backwards) for v in reversed(loop.right)]
    return left + right


def _starts(loop: VectorLoop, pose: Pose) -> list[complex]:
    """Possible starts of the polygon, the most likely first."""
    named = [pose.points[word] for word in loop.label.split() if word in pose.points]
    fixed = [pose.points[name] for name in pose.skeleton.fixed]
    return list(dict.fromkeys([*named[:1], *fixed, 0j, *pose.points.values()]))


def _ordered(
    steps: Sequence[_Step], start: complex, loop: VectorLoop, pose: Pose, near: float
) -> tuple[float, list[_Step]]:
    """The order with the highest value from a start, and this value; among equals, as written.

    A partial sum does not depend on the order of its vectors, so the best order of a set follows
    from those of the sets with one vector less (Held and Karp 1962).

    References
    ----------
    M. Held, R. M. Karp, A dynamic programming approach to sequencing problems, Journal of the
    Society for Industrial and Applied Mathematics 10 (1962) 196-210, doi:10.1137/0110015.
    """
    words = loop.label.split()
    count = len(steps)

    def worth(place: complex, turn: int) -> float:
        here = [name for name, z in pose.points.items() if abs(z - place) <= near]
        own = [name for name in here if name in words]
        in_turn = any(words[turn % len(words)] == name for name in own)
        return bool(here) + _NAMED * bool(own) + _IN_TURN * in_turn

    if count > _MOST:
        place, total = start, 0.0
        for turn, step in enumerate(steps, 1):
            place += step.way
            total += worth(place, turn)
        return total, list(steps)
    best = {0: (0.0, -1)}
    for chosen in range(1, 2**count):
        place = start + sum(steps[i].way for i in range(count) if chosen >> i & 1)
        # Among equals, the last one written comes last.
        before, last = max((best[chosen ^ (1 << i)][0], i) for i in range(count) if chosen >> i & 1)
        best[chosen] = (round(before + worth(place, chosen.bit_count()), 9), last)
    order, left = [], 2**count - 1
    while left:
        last = best[left][1]
        order.append(steps[last])
        left ^= 1 << last
    return best[2**count - 1][0], order[::-1]


# ----------------------------------------------------------------------
# The vector diagram: the vectors of every loop equation head to tail, with one colour per loop.
#
# An arrow has the direction of its vector, whether the equation adds or subtracts it. If several
# loops share a vector, their arrows are drawn side by side.


_BESIDE = 1.3  # distance of arrows side by side, in pin radii
_LONGEST_HEAD = 0.4  # of an arrow


def vector_edges(loops: Sequence[VectorLoop], pose: Pose) -> list[list[Edge]]:
    """The polygons of all loops, without vectors of length zero."""
    found = [polygon(loop, pose) for loop in loops]
    longest = max((abs(e.tip - e.tail) for edges in found for e in edges), default=0.0)
    return [[e for e in edges if abs(e.tip - e.tail) > COINCIDENT * longest] for edges in found]


def vector_symbols(
    loops: Sequence[VectorLoop], polygons: Sequence[Sequence[Edge]], measures: Measures
) -> tuple[list[Primitive], list[Choice]]:
    """The arrows of all loops, and positions for the names of vectors and loops."""
    drawn: list[Primitive] = []
    names: list[Choice] = []
    before: list[Edge] = []
    for number, edges in enumerate(polygons, 1):
        for edge in edges:
            name = edge.vector.name
            twins = [other for other in before if _same_line(edge, other, measures)]
            before.append(edge)
            ends = tail, tip = _moved(edge, len(twins), measures)
            head = min(measures.head, _LONGEST_HEAD * abs(tip - tail))
            drawn.append(drawn_line(Role.VECTOR, name, ends, number, head))
            if all(other.vector.name != name for other in twins):
                text = printed_formula(name)
                names.append(places_along(Role.VECTOR_NAME, name, text, ends, number, measures))
    for number, (loop, edges) in enumerate(zip(loops, polygons, strict=True), 1):
        if edges:
            names.append(_loop_name(loop, edges, number, measures))
    return drawn, names


def _same_line(one: Edge, other: Edge, measures: Measures) -> bool:
    """Whether two arrows overlap: both lie on the same line and share a part of it."""
    near = COINCIDENT * measures.size
    length = abs(one.tip - one.tail)
    along = (one.tip - one.tail) / length
    tail, tip = ((z - one.tail) * along.conjugate() for z in (other.tail, other.tip))
    if max(abs(tail.imag), abs(tip.imag)) > near:
        return False
    low, high = sorted((tail.real, tip.real))
    return min(high, length) - max(low, 0.0) > near


def _moved(arrow: Edge, before: int, measures: Measures) -> tuple[complex, complex]:
    """The arrow shifted sideways, given the number of others on its line."""
    along = (arrow.tip - arrow.tail) / abs(arrow.tip - arrow.tail)
    if (along.real, along.imag) < (0.0, 0.0):
        along = -along
    steps = (before + 1) // 2 * (1 if before % 2 else -1)
    across = steps * _BESIDE * measures.pin * along * 1j
    return arrow.tail + across, arrow.tip + across


def _loop_name(loop: VectorLoop, arrows: Sequence[Edge], number: int, measures: Measures) -> Choice:
    """Positions for a loop's name near its middle."""
    ends = [end for arrow in arrows for end in (arrow.tail, arrow.tip)]
    text = f"loop {printed_formula(loop.label)}"
    return places_within(Role.LOOP_NAME, loop.label, text, ends, number, measures)


# ----------------------------------------------------------------------
# Dimension lines: lengths of links and of ground, radii of wheels, the input.
#
# Numbers are measured in the drawn position, in the length unit of the axes. A line is placed next
# to its object, on the side and at the distance where it covers least.


_HEAD = 0.7  # of the head of an input arrow
_FURTHER = 1.5  # penalty for a larger distance
_SHARES = (0.5, 0.35, 0.65, 0.22, 0.78)  # of the line: possible positions of the number
_ARC = 8.0  # maximum radius of an angle's arc, in pin radii


_NARROW = 1.0  # rad: smaller angles reserve as much space for the number


@dataclass(frozen=True)
class _Span:
    """Two points whose distance is a dimension, and its text."""

    of: str
    start: complex
    end: complex
    text: str


def dimension_symbols(
    position: Position, pose: Pose, measures: Measures, drawn: Sequence[Primitive]
) -> Annotation:
    """All dimensions of a position; they avoid covering ``drawn``."""
    found: list[Primitive] = []
    names: list[Choice] = []
    for part, (name, value) in zip(pose.skeleton.driven, position.input.items(), strict=False):
        unit = position.input_units.get(name, "")
        shown = printed_value(float(f"{value:.5g}"), unit, position.units)
        if part.kind == "link":
            radians = value * position.units.angle.radians
            lines, place = _angle(part, radians, shown, pose, measures)
            found += lines
            names.append(place)
    for span in (*_inputs(position, pose), *_lengths(pose), *_ground(pose)):
        lines, texts = _freest(span, measures, Obstacles.of([*drawn, *found]))
        found += lines
        names += texts
    for radius in _radii(pose, measures):
        found.append(radius)
        ends = complex(*radius.points[0]), complex(*radius.points[1])
        text = f"R {abs(ends[1] - ends[0]):.5g}"
        names.append(places_along(Role.DIMENSION_NAME, radius.of, text, ends, 0, measures))
    return Annotation(drawn=found, names=names)


def _lengths(pose: Pose) -> Iterator[_Span]:
    """The sides of every link, each pair of points once."""
    seen: set[frozenset[str]] = set()
    for bar in pose.skeleton.bars:
        place = {pose.points[name]: name for name in bar.points}
        if len(place) < 2:
            continue
        outline = convex_outline(place)
        if in_line(outline):
            way = outline[1] - outline[0]
            ordered = sorted(place, key=lambda z: ((z - outline[0]) * way.conjugate()).real)
            sides = list(pairwise(ordered))
        else:
            sides = list(zip(outline, outline[1:] + outline[:1], strict=True))
        for start, end in sides:
            pair = frozenset((place[start], place[end]))
            if pair not in seen:
                seen.add(pair)
                yield _Span(bar.name, start, end, f"{abs(end - start):.5g}")


def _ground(pose: Pose) -> Iterator[_Span]:
    """Distances of neighbouring fixed pivots, left to right."""
    carried = {point for bar in pose.skeleton.bars for point in bar.points}
    pivots = {pose.points[name] for name in pose.skeleton.fixed if name in carried}
    for start, end in pairwise(sorted(pivots, key=lambda z: (z.real, z.imag))):
        yield _Span("ground", start, end, f"{abs(end - start):.5g}")


def _inputs(position: Position, pose: Pose) -> Iterator[_Span]:
    """Driven lengths: of sliders along their lines, of cylinders."""
    guides = {guide.name: guide for guide in pose.skeleton.guides}
    struts = {strut.name: strut for strut in pose.skeleton.struts}
    for part in pose.skeleton.driven:
        if part.name in guides:
            guide = guides[part.name]
            start = pose.points[guide.line[0]]
            end = start + pose.displacement(guide).now * pose.direction(guide)
        elif part.name in struts:
            start, end = (pose.points[name] for name in struts[part.name].between)
        else:
            continue
        if start != end:
            value = position.input.get(part.name, abs(end - start))
            yield _Span(part.name, start, end, f"{printed_name(part.name)} = {value:.5g}")


def _radii(pose: Pose, measures: Measures) -> Iterator[Polyline]:
    """Radii of all wheels, drawn up and to the right."""
    way = cmath.exp(0.25j * cmath.pi)
    for disc in pose.skeleton.of(DiscFigure):
        centre = pose.points[disc.center]
        head = min(_HEAD * measures.head, 0.4 * disc.radius)
        ends = (centre, centre + disc.radius * way)
        yield drawn_line(Role.DIMENSION, disc.link, ends, head=head)


def _angle(
    part: DrivenPart, value: float, shown: str, pose: Pose, measures: Measures
) -> tuple[list[Primitive], Choice]:
    """An arc from the zero direction of the input to the driven link, and its value."""
    bar = next(bar for bar in pose.skeleton.bars if bar.name == part.name)
    others = [pose.points[name] - pose.points[bar.points[0]] for name in bar.points[1:]]
    reach = next((z for z in others if z), measures.size + 0j)
    centre = pose.points[bar.points[0]]
    if part.name not in pose.angles and part.pivot is not None and part.pivot != bar.points[0]:
        centre, reach = pose.points[part.pivot], -reach
    here = pose.angles.get(part.name, phase(reach))
    # keeps the sign of the input, unlike %
    sweep = math.fmod(value, math.tau)
    radius = min(_ARC * measures.pin, 0.75 * abs(reach))
    least = 2.5 * measures.pin / radius
    start = (centre, centre + 1.3 * radius * cmath.exp(1j * (here - sweep)))
    drawn: list[Primitive] = [drawn_line(Role.EXTENSION, part.name, start)]
    # an arc shorter than its arrow head is left out
    if abs(sweep) > least:
        head = _HEAD * measures.head
        arc = drawn_arc(Role.DIMENSION, part.name, centre, radius, here - sweep, sweep, head)
        drawn.append(arc)
    wide = math.copysign(max(abs(sweep), _NARROW), sweep)
    spots = [
        (
            centre + far * radius * cmath.exp(1j * (here - share * wide)),
            4.0 * abs(share - 0.5) + abs(far - 1.4),
        )
        for far in (0.7, 1.2, 1.4, 1.7, 2.0, 2.4)
        for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.1, 0.9, -0.3, 1.3)
    ]
    height = 0.8 * measures.text
    return drawn, places_at(Role.DIMENSION_NAME, part.name, shown, 0, height, spots)


def _freest(
    span: _Span, measures: Measures, obstacles: Obstacles
) -> tuple[list[Primitive], list[Choice]]:
    """The dimension line that covers least, with its number in or next to it."""
    length = abs(span.end - span.start)
    if length < 1e-6 * measures.size:
        return [], []
    height = 0.8 * measures.text
    across = (span.end - span.start) / length * 1j
    first = 2.2 * measures.pin + 0.5 * height
    best: tuple[float, list[Primitive], list[Choice]] | None = None
    for further, side, share in product(range(6), (1, -1), _SHARES):
        away = side * (first + further * 1.1 * height) * across
        lines, texts, boxes = _line(span, away, share, measures)
        cost = _FURTHER * further + abs(share - 0.5) + obstacles.cost(boxes)
        if best is None or cost < best[0]:
            best = cost, lines, texts
    assert best is not None
    return best[1], best[2]


def _line(
    span: _Span, away: complex, share: float, measures: Measures
) -> tuple[list[Primitive], list[Choice], list[Box]]:
    """A dimension line at a distance from its object, with the number at a fraction of its length;
    also returns the boxes it fills.
    """
    height = 0.8 * measures.text
    start, end = span.start + away, span.end + away
    along = (end - start) / abs(end - start)
    length = abs(end - start)
    out = away / abs(away)
    half_width = text_width(span.text, height) / 2 + 0.25 * height
    half_height = 0.6 * height
    room = min(half_width / max(abs(along.real), 1e-9), half_height / max(abs(along.imag), 1e-9))
    head = min(_HEAD * measures.head, 0.35 * length)
    drawn: list[Primitive] = []
    for z in (span.start, span.end):
        ends = (z + 1.3 * measures.pin * out, z + away + 0.7 * measures.pin * out)
        drawn.append(drawn_line(Role.EXTENSION, span.of, ends))
    middle = start + share * (end - start)
    # a number in the line needs space for itself and both arrow heads
    fits = min(share, 1.0 - share) * length > room + 1.5 * head
    for tail, tip in ((middle - room * along, start), (middle + room * along, end)):
        ends = (tail if fits else middle, tip)
        drawn.append(drawn_line(Role.DIMENSION, span.of, ends, head=head))
    boxes = _boxes(start, end, measures)
    if not fits:
        line = (start, end)
        text = places_along(Role.DIMENSION_NAME, span.of, span.text, line, 0, measures)
        return drawn, [text], boxes
    below = (0.0, -0.3 * height)
    written = drawn_text(Role.DIMENSION_NAME, span.of, span.text, middle, below, height)
    return [*drawn, written], [], [*boxes, written.box.grown(0.1 * height)]


def _boxes(start: complex, end: complex, measures: Measures) -> list[Box]:
    """Small boxes that cover a line except its ends."""
    reach = 0.5 * measures.pin
    count = max(2, math.ceil(abs(end - start) / (2 * reach)))
    places = [start + (end - start) * k / count for k in range(1, count)]
    return [Box(z.real, z.imag, z.real, z.imag).grown(reach) for z in places]


# ----------------------------------------------------------------------
# All annotations of a picture, in the order of their placement.


@dataclass(frozen=True)
class Subject:
    """The subject of a picture: a position in its motion, the paths shown, its frame and sizes.

    ``polygons`` are the vector polygons of the loops, if shown.
    """

    position: Position
    motion: Motion | None
    pose: Pose
    traced: tuple[str, ...]
    polygons: tuple[tuple[Edge, ...], ...]
    within: Box
    measures: Measures


def annotation_of(subject: Subject, chosen: SceneOptions, drawn: Sequence[Primitive]) -> Annotation:
    """All annotations combined; they avoid covering ``drawn``, the mechanism."""
    found = list(_of_motion(subject, chosen))
    if chosen.dimensions:
        before = [*drawn, *Annotation.joined(found).drawn]
        found.append(dimension_symbols(subject.position, subject.pose, subject.measures, before))
    if chosen.speed and subject.motion is not None:
        traces, most, more = speed_traces(
            subject.pose, subject.motion, subject.traced, subject.measures
        )
        found.append(Annotation(drawn=traces))
        everything = [*drawn, *Annotation.joined(found).drawn]
        below = Box.around([*subject.within.corners, *(z for p in everything for z in p.outline)])
        found.append(
            colour_scale(subject.motion, subject.traced, most, more, below, subject.measures)
        )
    return Annotation.joined(found)


def _of_motion(subject: Subject, chosen: SceneOptions) -> Iterator[Annotation]:
    """Positions of a task, vectors, rates, forces, centres and centrodes."""
    position, motion, pose, measures = (
        subject.position, subject.motion, subject.pose, subject.measures
    )  # fmt: skip
    if chosen.positions:
        yield position_marks(chosen.positions, measures)
    if chosen.vectors:
        drawn, names = vector_symbols(chosen.vectors, subject.polygons, measures)
        yield Annotation(drawn=drawn, names=names)
    for order, wanted in ((1, chosen.velocities), (2, chosen.accelerations)):
        if wanted:
            yield rate_arrows(position, motion, pose, measures, order)
    if chosen.forces:
        yield force_arrows(chosen.forces, pose, position.units.length, measures)
    if chosen.centres:
        yield centre_symbols(instant_centres(position), subject.within, measures)
    if chosen.centrodes and motion is not None:
        paths = [centrodes(motion, link) for link in chosen.centrodes]
        yield centrode_symbols(paths, pose, subject.within, measures)
