"""The vectors of the loop equations over a motion, in the form that the front end draws."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from linkwork.drawing.captions import printed_formula
from linkwork.drawing.measures import COINCIDENT
from linkwork.drawing.pose import Pose
from linkwork.drawing.vector_polygon import polygon
from linkwork.foundation.arrays import ComplexArray
from linkwork.results.motion import Motion
from linkwork.results.vector_loop import MovingLoop
from linkwork.viewer.packing import Pack
from linkwork.viewer.page_data import PackedColumn, VectorData

__all__ = ["loop_arrows"]


def loop_arrows(loops: Sequence[MovingLoop], motion: Motion, pack: Pack) -> Iterator[VectorData]:
    """Every vector once, head to tail around its loop, in the order chosen for the first row."""
    if not motion.found.any():
        return
    row = int(np.flatnonzero(motion.found)[0])
    pose = Pose.at_row(motion, row)
    ways = {name: motion.trace(name) for name in motion.points}
    sizes = [np.nanmax(np.abs(v.values)) for loop in loops for v in (*loop.left, *loop.right)]
    near = COINCIDENT * float(max(sizes, default=0.0))
    known: list[tuple[str, ComplexArray]] = []
    for number, loop in enumerate(loops, 1):
        for name, tail, tip in _around(loop, row, pose, ways, near):
            if np.nanmax(np.abs(tip - tail)) <= near:
                continue
            if any(name == other and _together(tail, place, near) for other, place in known):
                continue
            known.append((name, tail))
            ends = [_point(place, ways, near) for place in (tail, tip)]
            free = -1 in ends
            yield VectorData(
                name=printed_formula(name),
                start=-1 if free else ends[0],
                end=-1 if free else ends[1],
                tone=number,
                course=tuple(_course(tail, tip, motion, pack)) if free else (),
            )


def _around(
    loop: MovingLoop, row: int, pose: Pose, ways: dict[str, ComplexArray], near: float
) -> Iterator[tuple[str, ComplexArray, ComplexArray]]:
    """Name, tail and tip (N,) of every vector, beginning at the start of a row's polygon."""
    shown = loop.at(row)
    moving = dict(zip(map(id, (*shown.left, *shown.right)), (*loop.left, *loop.right), strict=True))
    left = set(map(id, shown.left))
    edges = polygon(shown, pose)
    if not edges:
        return
    first = edges[0]
    start = first.tip if (id(first.vector) in left) == first.vector.backwards else first.tail
    words = [word for word in loop.label.split() if word in pose.points]
    names = [*words, *pose.skeleton.fixed, *pose.points]
    at = next((name for name in names if abs(pose.points[name] - start) <= near), None)
    place: ComplexArray = np.full(len(next(iter(ways.values()))), start) if at is None else ways[at]
    for edge in edges:
        vector, own = moving[id(edge.vector)], id(edge.vector) in left
        after = place + (vector.values if own else -vector.values)
        ends = (after, place) if own == vector.backwards else (place, after)
        yield vector.name, *ends
        place = after


def _point(place: ComplexArray, ways: dict[str, ComplexArray], near: float) -> int:
    """The index of the point at this position in all rows; -1 if there is none."""
    alike = (k for k, way in enumerate(ways.values()) if _together(place, way, near))
    return next(alike, -1)


def _together(one: ComplexArray, other: ComplexArray, near: float) -> bool:
    return bool(np.nanmax(np.abs(one - other)) <= near)


def _course(
    tail: ComplexArray, tip: ComplexArray, motion: Motion, pack: Pack
) -> Iterator[PackedColumn]:
    for values in (tail.real, tail.imag, tip.real, tip.imag):
        yield pack(values, motion.found)
