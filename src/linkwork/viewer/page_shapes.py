"""The shapes and frames of a moving scene in the format of the front end."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from linkwork.drawing.attachment import STILL, Frame
from linkwork.drawing.moving_scene import MovingScene
from linkwork.drawing.moving_shape import Moving
from linkwork.drawing.scene import XY, Arc, Disc, Hatch, Polygon, Polyline, Primitive, Text
from linkwork.foundation.arrays import BoolArray, ComplexArray
from linkwork.results.motion import Motion
from linkwork.viewer.packing import Pack
from linkwork.viewer.page_data import FrameData, PackedColumn, Part, TurnData

__all__ = ["OWN_COURSE", "places_of", "shapes_of", "still_shape"]

#: Gives x, y, x, y, … of places in the frame of a shape.
Local = Callable[[tuple[XY, ...]], tuple[float, ...]]

#: The frame of a deforming shape.
OWN_COURSE = -2

_DIGITS = 7  # digits of coordinates, relative to the size of the drawing
_KINDS: dict[type[Primitive], str] = {
    Arc: "line", Polyline: "line", Polygon: "area", Disc: "disc", Hatch: "strokes", Text: "text"
}  # fmt: skip


def shapes_of(
    motion: Motion, scene: MovingScene, pack: Pack
) -> tuple[tuple[TurnData, ...], tuple[FrameData, ...], tuple[Part, ...]]:
    """The turns, the frames in use, and all shapes from bottom to top."""
    used = dict.fromkeys(part.frame for part in scene.parts)
    carriers = [frame for frame in used if frame is not None and frame != STILL]
    turns = list(dict.fromkeys(frame.turn for frame in carriers if frame.turn))
    points = list(motion.points)
    return (
        tuple(
            TurnData(name=name, angle=pack(scene.frames.turns[name], scene.found)) for name in turns
        ),
        tuple(
            FrameData(
                origin=points.index(frame.origin) if frame.origin else -1,
                turn=turns.index(frame.turn) if frame.turn else -1,
            )
            for frame in carriers
        ),
        tuple(_part(part, scene, carriers, pack) for part in scene.parts),
    )


def _part(part: Moving, scene: MovingScene, carriers: list[Frame], pack: Pack) -> Part:
    shape = part.shape
    number = OWN_COURSE
    if part.frame is not None:
        number = -1 if part.frame == STILL else carriers.index(part.frame)

    def local(places: tuple[XY, ...]) -> tuple[float, ...]:
        """x, y, x, y, … in the frame of the part."""
        line = np.array([complex(*place) for place in places])
        if part.frame is not None and len(line):
            line = scene.frames.local(part.frame, line[None], np.array([scene.row]))[0]
        return _flat(line, scene.scene.measures.size)

    still = _shape(shape, number, local)
    if part.course is None:
        return still
    course = tuple(_course(part.course, scene.found, pack))
    return replace(still, points=(), course=course, shown=_shown(part.course, pack))


def still_shape(shape: Primitive, size: float) -> Part:
    """A shape in the plane; ``size`` is that of the drawing."""

    def flat(places: tuple[XY, ...]) -> tuple[float, ...]:
        return _flat(np.array([complex(*place) for place in places]), size)

    return _shape(shape, -1, flat)


def _shape(shape: Primitive, frame: int, local: Local) -> Part:
    text = shape if isinstance(shape, Text) else None
    return Part(
        kind=_KINDS[type(shape)],
        role=shape.role.name.lower(),
        of=shape.of,
        tone=shape.tone,
        frame=frame,
        points=local(places_of(shape)),
        radius=shape.radius if isinstance(shape, Disc) else 0.0,
        head=local(shape.arrow_head) if isinstance(shape, Polyline | Arc) else (),
        text=text.text if text else "",
        offset=text.offset if text else (),
        height=text.height if text else 0.0,
        align=text.align if text else 0,
        course=(),
        shown=None,
    )


def places_of(shape: Primitive) -> tuple[XY, ...]:
    """The points of a drawn shape."""
    match shape:
        case Polyline() | Arc():
            return shape.shaft
        case Polygon():
            return shape.points
        case Disc():
            return (shape.centre,)
        case Hatch():
            return shape.outline
        case Text():
            return (shape.anchor,)
        case _:
            raise TypeError(f"{type(shape).__name__} is not known to pages")


def _flat(line: ComplexArray, size: float) -> tuple[float, ...]:
    digits = _DIGITS - math.ceil(math.log10(size))
    pairs = np.ascontiguousarray(line, dtype=complex).view(float)
    return tuple((np.round(pairs, digits) + 0.0).tolist())


def _course(course: ComplexArray, found: BoolArray, pack: Pack) -> Iterator[PackedColumn]:
    for corner in course.T:
        yield pack(np.nan_to_num(corner.real), found)
        yield pack(np.nan_to_num(corner.imag), found)


def _shown(course: ComplexArray, pack: Pack) -> PackedColumn:
    there = np.isfinite(course[:, 0].real)
    return pack(there.astype(float), np.ones(len(there), dtype=bool), step=1.0)
