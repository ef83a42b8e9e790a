"""Positions of the vectors of a loop equation: head to tail around a closed polygon.

A sum has no order of terms. The order in which most vectors end at points of the mechanism places
them over its links.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.core.drawing.labels import Choice, places_along, places_within
from linkwork.core.drawing.pose import Pose, printed_formula
from linkwork.core.drawing.scene import COINCIDENT, Measures, Primitive, Role, drawn_line
from linkwork.core.results.vector_loop import LoopVector, VectorLoop

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
