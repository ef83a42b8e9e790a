"""All annotations of a picture, in the order of their placement."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from linkwork.drawing.annotation import Annotation
from linkwork.drawing.box import Box
from linkwork.drawing.centre_symbols import centre_symbols, centrode_symbols
from linkwork.drawing.dimension_symbols import dimension_symbols
from linkwork.drawing.force_arrows import force_arrows
from linkwork.drawing.measures import Measures
from linkwork.drawing.pose import Pose
from linkwork.drawing.position_marks import position_marks
from linkwork.drawing.rate_arrows import rate_arrows
from linkwork.drawing.scene import Primitive
from linkwork.drawing.scene_options import SceneOptions
from linkwork.drawing.speed_trace import colour_scale, speed_traces
from linkwork.drawing.vector_polygon import Edge
from linkwork.drawing.vector_symbols import vector_symbols
from linkwork.results.instant_centres import centrodes, instant_centres
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["Subject", "annotation_of"]


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
