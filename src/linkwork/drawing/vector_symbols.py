"""The vector diagram: the vectors of every loop equation head to tail, with one colour per loop.

An arrow has the direction of its vector, whether the equation adds or subtracts it. If several
loops share a vector, their arrows are drawn side by side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.drawing.captions import printed_formula
from linkwork.drawing.label_placement import Choice, places_along, places_within
from linkwork.drawing.measures import COINCIDENT, Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import Polyline, Primitive, Role, xy
from linkwork.drawing.vector_polygon import Edge, polygon
from linkwork.results.vector_loop import LoopVector, VectorLoop

__all__ = ["vector_edges", "vector_symbols"]

_BESIDE = 1.3  # distance of arrows side by side, in pin radii
_LONGEST_HEAD = 0.4  # of an arrow


@dataclass(frozen=True)
class _Arrow:
    """A drawn vector: its ends, and the number of its loop."""

    vector: LoopVector
    tail: complex
    tip: complex
    loop: int


def vector_edges(loops: Sequence[VectorLoop], pose: Pose) -> list[list[Edge]]:
    """The polygons of all loops, without vectors of length zero."""
    found = [polygon(loop, pose) for loop in loops]
    longest = max((abs(e.tip - e.tail) for edges in found for e in edges), default=0.0)
    return [[e for e in edges if abs(e.tip - e.tail) > COINCIDENT * longest] for edges in found]


def vector_symbols(
    loops: Sequence[VectorLoop], polygons: Sequence[Sequence[Edge]], measures: Measures
) -> tuple[list[Primitive], list[Choice]]:
    """The arrows of all loops, and positions for the names of vectors and loops."""
    arrows = [
        _Arrow(edge.vector, edge.tail, edge.tip, number)
        for number, edges in enumerate(polygons, 1)
        for edge in edges
    ]
    drawn: list[Primitive] = []
    names: list[Choice] = []
    for k, arrow in enumerate(arrows):
        twins = [other for other in arrows[:k] if _same_line(arrow, other, measures)]
        tail, tip = _moved(arrow, len(twins), measures)
        head = min(measures.head, _LONGEST_HEAD * abs(tip - tail))
        drawn.append(
            Polyline(
                role=Role.VECTOR,
                of=arrow.vector.name,
                tone=arrow.loop,
                points=(xy(tail), xy(tip)),
                head=head,
            )
        )
        if not any(other.vector.name == arrow.vector.name for other in twins):
            text = printed_formula(arrow.vector.name)
            line = (tail, tip)
            names.append(
                places_along(Role.VECTOR_NAME, arrow.vector.name, text, line, arrow.loop, measures)
            )
    return drawn, names + [
        _loop_name(loop, [a for a in arrows if a.loop == k], k, measures)
        for k, loop in enumerate(loops, 1)
        if any(a.loop == k for a in arrows)
    ]


def _same_line(one: _Arrow, other: _Arrow, measures: Measures) -> bool:
    """Whether two arrows overlap: both lie on the same line and share a part of it."""
    near = COINCIDENT * measures.size
    length = abs(one.tip - one.tail)
    along = (one.tip - one.tail) / length
    tail, tip = ((z - one.tail) * along.conjugate() for z in (other.tail, other.tip))
    if max(abs(tail.imag), abs(tip.imag)) > near:
        return False
    low, high = sorted((tail.real, tip.real))
    return min(high, length) - max(low, 0.0) > near


def _moved(arrow: _Arrow, before: int, measures: Measures) -> tuple[complex, complex]:
    """The arrow shifted sideways, given the number of others on its line."""
    along = (arrow.tip - arrow.tail) / abs(arrow.tip - arrow.tail)
    if (along.real, along.imag) < (0.0, 0.0):
        along = -along
    steps = (before + 1) // 2 * (1 if before % 2 else -1)
    across = steps * _BESIDE * measures.pin * along * 1j
    return arrow.tail + across, arrow.tip + across


def _loop_name(loop: VectorLoop, arrows: list[_Arrow], number: int, measures: Measures) -> Choice:
    """Positions for a loop's name near its middle."""
    ends = [end for arrow in arrows for end in (arrow.tail, arrow.tip)]
    text = f"loop {printed_formula(loop.label)}"
    return places_within(Role.LOOP_NAME, loop.label, text, ends, number, measures)
