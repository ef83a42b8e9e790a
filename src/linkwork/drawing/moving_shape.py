"""Primitives that move: the frame that carries each, or its own course row by row."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.attachment import Frame, Frames
from linkwork.drawing.guide_symbols import tracks
from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.mechanism_scene import symbols
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import (
    Arc,
    Polygon,
    Polyline,
    Primitive,
    Role,
    xy,
)
from linkwork.drawing.shape_corners import corners, same_sizes
from linkwork.foundation.arrays import ComplexArray, CountArray
from linkwork.results.motion import Motion

__all__ = ["Key", "Moving", "attach_shapes", "drawn_symbols", "keyed", "take_over_frames"]

_ARC_PIECES = 32  # of an arc that changes its sweep
#: Kind, role and part of a primitive, and its number among those that agree in all of these.
Key = tuple[type[Primitive], Role, str, int]


@dataclass(frozen=True, kw_only=True)
class Moving:
    """A primitive that moves.

    Parameters
    ----------
    shape : Primitive
        As it is in the reference row.
    frame : Frame, optional
        The frame that carries it; ``None`` if it changes its shape.
    course : array (N, m), optional
        Its corners x + iy row by row if no frame carries it; NaN in rows where it is not drawn.
    """

    shape: Primitive
    frame: Frame | None
    course: ComplexArray | None = None


def drawn_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The symbols of all parts in a pose, without traces, arrows and names."""
    return symbols(pose, tracks(pose, measures, tones(pose)), (), measures)


def keyed(primitives: Iterator[Primitive]) -> Iterator[tuple[Key, Primitive]]:
    """Primitives with keys by which those of two poses correspond."""
    count: dict[tuple[type[Primitive], Role, str], int] = {}
    for primitive in primitives:
        kind = (type(primitive), primitive.role, primitive.of)
        count[kind] = count.get(kind, -1) + 1
        yield (*kind, count[kind]), primitive


def attach_shapes(
    motion: Motion, pose: Pose, measures: Measures, frames: Frames, rows: CountArray
) -> dict[Key, Moving]:
    """Each primitive with the frame that carries it, found from its coordinates in these rows."""
    first: dict[Key, Primitive] = {}
    course: dict[Key, dict[int, Primitive]] = {}
    for k, row in enumerate(rows):
        for key, primitive in keyed(drawn_symbols(pose.moved_to(motion, int(row)), measures)):
            first.setdefault(key, primitive)
            course.setdefault(key, {})[k] = primitive
    return {
        key: _one_attached(first[key], along, frames, rows, motion, measures)
        for key, along in course.items()
    }


def _one_attached(
    shape: Primitive,
    along: Mapping[int, Primitive],
    frames: Frames,
    rows: CountArray,
    motion: Motion,
    measures: Measures,
) -> Moving:
    found = [corners(one) for one in along.values()]
    # a shape missing in some rows, or with other corners, cannot be rigid
    alike = len(along) == len(rows) and len({len(one) for one in found}) == 1
    if alike and same_sizes(along.values(), measures.size):
        frame = frames.holding(
            np.stack(found),
            rows,
            measures.size,
            first=shape.of,
            closed=_closed(shape),
        )
        if frame is not None:
            return Moving(shape=shape, frame=frame)
    return _own_course(shape, along, rows, len(motion))


def _closed(shape: Primitive) -> bool:
    """Whether it does not matter from which corner the corners are numbered."""
    # a line of two ends is the same from either end; an arrow is not
    line = isinstance(shape, Polyline) and len(shape.points) == 2 and not shape.head
    return line or isinstance(shape, Polygon)


def _own_course(
    shape: Primitive, along: Mapping[int, Primitive], rows: CountArray, count: int
) -> Moving:
    """A primitive with its corners row by row; an arc becomes a line."""
    lines = {k: _as_line(one) for k, one in along.items()}
    most = max(len(line) for line in lines.values())
    course = np.full((count, most), complex(np.nan, np.nan))
    for k, line in lines.items():
        course[rows[k], : len(line)] = line
        # a shorter line repeats its last corner, which draws nothing
        course[rows[k], len(line) :] = line[-1]
    if isinstance(shape, Arc):
        own = {"role": shape.role, "of": shape.of, "tone": shape.tone, "head": shape.head}
        shape = Polyline(points=tuple(map(xy, _as_line(shape))), **own)  # type: ignore[arg-type]
    return Moving(shape=shape, frame=None, course=course)


def _as_line(shape: Primitive) -> ComplexArray:
    if not isinstance(shape, Arc):
        return corners(shape)
    angles = shape.start + shape.sweep * np.arange(_ARC_PIECES + 1) / _ARC_PIECES
    line: ComplexArray = complex(*shape.centre) + shape.radius * np.exp(1j * angles)
    return line


def take_over_frames(
    motion: Motion,
    pose: Pose,
    measures: Measures,
    shown: Mapping[Key, Primitive],
    carried: Mapping[Key, Moving],
    rows: CountArray,
) -> list[Moving]:
    """The primitives of a pose, carried as they were with other dimensions."""
    changing = [key for key, part in carried.items() if part.frame is None]
    course: dict[Key, dict[int, Primitive]] = {key: {} for key in changing}
    for k, row in enumerate(rows if changing else ()):
        for key, primitive in keyed(drawn_symbols(pose.moved_to(motion, int(row)), measures)):
            if key in course:
                course[key][k] = primitive
    return [
        _own_course(shape, course[key], rows, len(motion))
        if key in course
        else Moving(shape=shape, frame=carried[key].frame)
        for key, shape in shown.items()
    ]
