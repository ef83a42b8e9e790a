"""A motion as a moving picture: every primitive is attached to a frame, or has coordinates per row.

The primitives are those of :func:`~linkwork.drawing.mechanism_scene.scene_of`. Most are rigid: they
are fixed to ground, a link or a point. Others (pistons, rods partly hidden by a collar, …) have
coordinates for every row. Names and arrows keep their positions over the whole motion. Nothing is
solved here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.drawing.attachment import STILL, Frame, Frames
from linkwork.drawing.box import Box
from linkwork.drawing.drawn_box import reach_of
from linkwork.drawing.guide_symbols import tracks
from linkwork.drawing.input_arrow import input_arrows
from linkwork.drawing.lasting_labels import lasting_labels
from linkwork.drawing.link_symbols import tones
from linkwork.drawing.measures import Measures
from linkwork.drawing.mechanism_scene import traced
from linkwork.drawing.moving_shape import (
    Key,
    Moving,
    attach_shapes,
    drawn_symbols,
    keyed,
    take_over_frames,
)
from linkwork.drawing.pose import Pose
from linkwork.drawing.scene import (
    Arc,
    Polyline,
    Primitive,
    Role,
    Scene,
    Text,
    xy,
)
from linkwork.drawing.shape_corners import corners, with_corners
from linkwork.drawing.trace_path import trace_symbols
from linkwork.foundation.arrays import BoolArray, ComplexArray, CountArray
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion

__all__ = ["MovingScene", "moving_scene"]

_SAMPLED = 31  # rows at which names must not collide
_FEW = 9  # the same, for a quick picture
_TRIED = 25  # rows used to find the frame of a shape


@dataclass(frozen=True, kw_only=True)
class MovingScene:
    """A drawn motion.

    Parameters
    ----------
    scene : Scene
        The picture in the reference row, with names and arrows.
    row : int
        The reference row.
    found : array (N,) of bool
        Rows that can be drawn.
    frames : Frames
        The frames over the motion.
    parts : tuple of Moving
        The primitives, bottom to top.
    """

    scene: Scene
    row: int
    found: BoolArray
    frames: Frames
    parts: tuple[Moving, ...]

    def at(self, row: int, *, turned: bool = False) -> Scene:
        """The picture in a found row; ``turned``: with reversed arrows of inputs."""
        if not self.found[row]:
            raise InputError(f"row {row} of the motion has no position to draw")
        shapes = tuple(filter(None, (self._placed(part, row) for part in self.parts)))
        if turned:
            shapes = tuple(map(_turned, shapes))
        return replace(self.scene, primitives=shapes)

    def _placed(self, part: Moving, row: int) -> Primitive | None:
        if part.frame is None:
            assert part.course is not None
            own = part.course[row]
            return with_corners(part.shape, own) if np.isfinite(own[0]) else None
        if part.frame == STILL:
            return part.shape
        local = self.frames.local(part.frame, corners(part.shape)[None], np.array([self.row]))[0]
        return with_corners(part.shape, self.frames.placed(part.frame, local, np.array([row]))[0])

    @property
    def view(self) -> Box:
        """The box of the picture over the whole motion."""
        box = self.scene.box
        rows = np.flatnonzero(self.found)
        outlines: dict[Frame, list[complex]] = {}
        around: list[ComplexArray] = []
        for part in self.parts:
            # names may be clipped at the edge, so that the picture does not jump
            if part.frame == STILL or isinstance(part.shape, Text):
                continue
            if part.frame is not None:
                outlines.setdefault(part.frame, []).extend(
                    complex(*place) for place in part.shape.outline
                )
            elif part.course is not None:
                around.append(part.course[rows])
        for frame, outline in outlines.items():
            local = self.frames.local(frame, np.array([outline]), np.array([self.row]))[0]
            around.append(self.frames.placed(frame, local, rows))
        for some in around:
            places = some[np.isfinite(some)]
            if len(places):
                x, y = places.real, places.imag
                box = box.with_box(
                    Box(float(x.min()), float(y.min()), float(x.max()), float(y.max()))
                )
        return box


def moving_scene(
    motion: Motion,
    *,
    traces: Sequence[str] | None = None,
    within: Box | None = None,
    like: MovingScene | None = None,
    sampled: bool = False,
) -> MovingScene:
    """Draw a motion.

    Parameters
    ----------
    motion : Motion
        A motion with at least one position.
    traces : sequence of str, optional
        The points whose paths are shown; by default those of ``[trace]``.
    within : Box, optional
        The reference for sizes of symbols, the same for all motions of one picture; by default
        :func:`~linkwork.drawing.drawn_box.reach_of`.
    like : MovingScene, optional
        A drawn motion of the same mechanism with other dimensions: the frames of shapes and the
        positions of names are reused if the shapes are equal. This is fast enough for use during
        the drag of a dimension.
    sampled : bool
        Find the frame of each shape from some of the rows, which is many times faster. A shape that
        is drawn in none of these rows is omitted.

    Raises
    ------
    InputError
        If no position was found, or the mechanism has no points.
    UnknownNameError
        If a traced point does not exist.
    """
    box = reach_of(motion) if within is None else within
    rows = np.flatnonzero(motion.found)
    pose = Pose.at_row(motion, int(rows[0]))
    measures = Measures.of(box, pose.gaps)
    frames = Frames.of(motion, pose)
    shown = dict(keyed(drawn_symbols(pose, measures)))
    carried = None if like is None else _carried(like)
    # different symbols: no correspondence
    if carried is None or carried.keys() != shown.keys():
        like = carried = None
    if carried is None and sampled:
        carried = attach_shapes(motion, pose, measures, frames, _some(rows, _TRIED))
    if carried is not None and carried.keys() == shown.keys():
        parts = take_over_frames(motion, pose, measures, shown, carried, rows)
    else:
        parts = list(attach_shapes(motion, pose, measures, frames, rows).values())
    paths = trace_symbols(pose, traced(pose, traces), measures)
    parts += [Moving(shape=path, frame=STILL) for path in paths]
    row = int(rows[0])
    if like is None:
        parts += _arrows(pose, measures, motion.speed, frames, parts)
        # names come last, since they avoid all moving parts
        moving = MovingScene(
            scene=_scene(motion, parts, measures, box),
            row=row,
            found=motion.found,
            frames=frames,
            parts=tuple(parts),
        )
        parts += _names(motion, pose, moving, _some(rows, _FEW if sampled else _SAMPLED))
    else:
        parts += _arrows_as_before(like, frames, row)
        parts += _names_as_before(like, pose, frames, row, measures)
    parts.sort(key=lambda part: part.shape.layer)
    return MovingScene(
        scene=_scene(motion, parts, measures, box),
        row=row,
        found=motion.found,
        frames=frames,
        parts=tuple(parts),
    )


def _scene(motion: Motion, parts: Sequence[Moving], measures: Measures, within: Box) -> Scene:
    return Scene(
        primitives=tuple(part.shape for part in parts),
        measures=measures,
        within=within,
        unit=motion.units.length,
        title=motion.mechanism,
    )


def _turned(shape: Primitive) -> Primitive:
    """The reversed arrow of an input; other primitives unchanged."""
    if shape.role is Role.INPUT and isinstance(shape, Arc):
        return replace(shape, start=shape.start + shape.sweep, sweep=-shape.sweep)
    if shape.role is Role.INPUT and isinstance(shape, Polyline):
        return replace(shape, points=shape.points[::-1])
    return shape


def _some(rows: CountArray, count: int) -> CountArray:
    """At most ``count`` rows from the first to the last."""
    spread = np.linspace(0, len(rows) - 1, count).round().astype(int)
    some: CountArray = rows[list(dict.fromkeys(spread.tolist()))]
    return some


def _carried(scene: MovingScene) -> dict[Key, Moving]:
    """The primitives of a moving scene by key, without traces, arrows and names."""
    drawn = [
        part
        for part in scene.parts
        if part.shape.role not in (Role.TRACE, Role.INPUT) and not isinstance(part.shape, Text)
    ]
    # by identity: shapes of one kind may be equal
    by_shape = {id(part.shape): part for part in drawn}
    return {key: by_shape[id(shape)] for key, shape in keyed(part.shape for part in drawn)}


def _arrows(
    pose: Pose,
    measures: Measures,
    speed: float | None,
    frames: Frames,
    parts: Sequence[Moving],
) -> Iterator[Moving]:
    """An arrow for every input, attached to the driven part as in the reference row."""
    sense = -1.0 if (speed or 0.0) < 0 else 1.0
    found = tracks(pose, measures, tones(pose))
    drawn = [part.shape for part in parts]
    for arrow in input_arrows(pose, found, measures, sense, drawn):
        yield Moving(shape=arrow, frame=_driving(pose, arrow, frames))


def _arrows_as_before(like: MovingScene, frames: Frames, row: int) -> Iterator[Moving]:
    """The arrows of another motion, at the same positions on the driven parts."""
    for part in like.parts:
        if part.shape.role is Role.INPUT and part.frame is not None:
            local = like.frames.local(part.frame, corners(part.shape)[None], np.array([like.row]))[
                0
            ]
            places = frames.placed(part.frame, local, np.array([row]))[0]
            yield replace(part, shape=with_corners(part.shape, places))


def _driving(pose: Pose, arrow: Primitive, frames: Frames) -> Frame:
    """The part with the arrow of an input: the driven link, block or cylinder."""
    skeleton = pose.skeleton
    for part in skeleton.driven:
        if part.name != arrow.of:
            continue
        for strut in skeleton.struts:
            if strut.name == part.name:
                return Frame(strut.between[0], ">".join(strut.between))
        for guide in skeleton.guides:
            if guide.name == part.name:
                line = ">".join(guide.line)
                return Frame(guide.point, line if line in frames.turns else "")
        for rail in skeleton.rails:
            if rail.name == part.name:
                return Frame(rail.points[0], "")
        for bar in skeleton.bars:
            if bar.name == part.name:
                turn = bar.name if bar.name in frames.turns else ""
                return Frame(part.pivot or bar.points[0], turn)
    return STILL


def _names(motion: Motion, pose: Pose, moving: MovingScene, rows: CountArray) -> Iterator[Moving]:
    """The names of points, each in a direction that is free in these rows."""
    poses = [pose.moved_to(motion, int(row)) for row in rows]
    drawn = [moving.at(int(row)).primitives for row in rows]
    for text, turn in lasting_labels(poses, drawn, moving.scene.measures):
        still = text.of in pose.skeleton.fixed
        yield Moving(shape=text, frame=STILL if still else Frame(text.of, turn))


def _names_as_before(
    like: MovingScene, pose: Pose, frames: Frames, row: int, measures: Measures
) -> Iterator[Moving]:
    """The names of points in their directions from another motion."""
    height = measures.text
    for part in like.parts:
        text, frame = part.shape, part.frame
        if not isinstance(text, Text) or frame is None:
            continue
        grown = height / text.height
        anchor = pose.points[text.of]
        if frame != STILL:
            local = like.frames.local(frame, corners(text)[None], np.array([like.row]))[0]
            anchor = complex(frames.placed(frame, grown * local, np.array([row]))[0, 0])
        offset = (text.offset[0] * grown, text.offset[1] * grown)
        shape = replace(text, anchor=xy(anchor), offset=offset, height=height)
        yield Moving(shape=shape, frame=frame)
