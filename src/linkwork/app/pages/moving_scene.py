"""Names of points at constant distances from the points, or from their links, over a motion."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from linkwork.core.drawing.guides import input_arrows, tracks
from linkwork.core.drawing.labels import Choice, Obstacles, point_names
from linkwork.core.drawing.links import DEPTH, pin_radius, tones
from linkwork.core.drawing.mechanism_scene import reach_of, symbols, traced
from linkwork.core.drawing.paths import trace_symbols
from linkwork.core.drawing.pose import Pose
from linkwork.core.drawing.scene import (
    Arc,
    Box,
    Measures,
    Polygon,
    Polyline,
    Primitive,
    Role,
    Scene,
    Text,
    corners,
    same_sizes,
    text_width,
    with_corners,
    xy,
)
from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, CountArray, FrozenDict
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.motion import Motion

_NAME_ON_NAME = 100.0
_BELOW = 0.4  # penalty for a position under the ground symbol
_CLEAR = 0.12  # margin of every name [em]
_TURNING = 1.2  # penalty for a position that turns with a link
_FURTHER = 2.0  # penalty for the larger of two distances
_WAYS = 8  # directions from the point relative to a link
_WORST = 0.5  # weight of the worst row in a penalty, relative to the mean of all


def lasting_labels(
    poses: Sequence[Pose],
    drawn: Sequence[Sequence[Primitive]],
    measures: Measures,
) -> list[tuple[Text, str]]:
    """The names in the first pose, each in its best position over all poses.

    Parameters
    ----------
    poses, drawn
        Some rows of a motion, and the drawn primitives of each.

    Returns
    -------
    list of (Text, str)
        Each name, and the link with which its position turns about the point; "" for none.

    Notes
    -----
    Names are placed one by one and moved until no single move improves the result, as in
    :func:`~linkwork.core.drawing.labels.placed`; the penalty of a position is the mean
    of its penalties in all rows plus a share of the worst.
    """
    pose = poses[0]
    names = [_with_more_positions(choice, pose, measures) for choice in point_names(pose, measures)]
    boxes = [_boxes(choice, turns, poses) for choice, turns in names]
    covered = _covered(drawn, boxes)
    fixed = [
        np.array(choice.cost) + _over_rows(cost)
        for (choice, _), cost in zip(names, covered, strict=True)
    ]
    chosen = _settled(fixed, boxes)
    return [
        (choice.places[place], turns[place])
        for (choice, turns), place in zip(names, chosen, strict=True)
    ]


def _boxes(choice: Choice, turns: Sequence[str], poses: Sequence[Pose]) -> Array:
    """The boxes of one name in all poses, shape (rows, places, 4)."""
    name = choice.places[0].of
    edges = np.array([t.box.grown(_CLEAR * t.height).edges for t in choice.places])
    way = np.array([pose.points[name] for pose in poses])
    turned = {turn: _directions(turn, poses) for turn in set(turns)}
    turn = np.stack([turned[turn] for turn in turns], axis=1)  # (rows, places)
    anchors = np.array([complex(*text.anchor) for text in choice.places])
    shift = way[:, None] - way[0] + (anchors - way[0]) * (turn / turn[0] - 1.0)
    moved: Array = edges + np.stack((shift.real, shift.imag, shift.real, shift.imag), axis=-1)
    return moved


def _directions(link: str, poses: Sequence[Pose]) -> ComplexArray:
    """The unit vectors of a link in all poses; constant without a link."""
    if not link:
        return np.ones(len(poses), dtype=complex)
    bar = next(bar for bar in poses[0].skeleton.bars if bar.name == link)
    start, end = list(dict.fromkeys(bar.points))[:2]
    along = np.array([pose.points[end] - pose.points[start] for pose in poses])
    return np.asarray(along / np.abs(along))


def _with_more_positions(
    choice: Choice, pose: Pose, measures: Measures
) -> tuple[Choice, tuple[str, ...]]:
    """More positions for a motion, and the link with which each one turns.

    The name of a pivot may be under its ground symbol, which a crank rarely covers; that of a
    moving point may turn with a link, which then never covers it.
    """
    text = choice.places[0]
    places, cost = list(choice.places), list(choice.cost)
    turns = [""] * len(places)
    if text.of in pose.skeleton.fixed:
        drop = DEPTH * pin_radius(pose, text.of, measures) + 0.5 * measures.pin + 0.76 * text.height
        for further in range(3):
            low = (0.0, -drop - further * text.height)
            places.append(replace(text, offset=low, align=0))
            cost.append(_BELOW + _FURTHER * further)
        return Choice(tuple(places), tuple(cost)), (*turns, "", "", "")
    point = pose.points[text.of]
    reach = math.hypot(text_width(text.text, text.height), 0.92 * text.height) / 2
    for bar in pose.skeleton.bars:
        ends = [pose.points[name] for name in dict.fromkeys(bar.points)]
        if text.of not in bar.points or len(ends) < 2 or ends[0] == ends[1]:
            continue
        along = (ends[1] - ends[0]) / abs(ends[1] - ends[0])
        for further, k in product(range(2), range(_WAYS)):
            away = (1.2 + 1.5 * further) * measures.pin + reach
            anchor = xy(point + away * along * cmath.exp(2j * cmath.pi * k / _WAYS))
            middle = (0.0, -0.3 * text.height)
            places.append(replace(text, anchor=anchor, offset=middle, align=0))
            cost.append(_TURNING + _FURTHER * further)
            turns.append(bar.name)
    return Choice(tuple(places), tuple(cost)), tuple(turns)


def _covered(drawn: Sequence[Sequence[Primitive]], boxes: Sequence[Array]) -> list[Array]:
    """The penalties of every name's positions in every row, each (rows, places)."""
    every = np.concatenate(boxes, axis=1)
    cost = [
        Obstacles.of(shapes).costs(candidates[:, None, :])
        for shapes, candidates in zip(drawn, every, strict=True)
    ]
    return np.split(np.array(cost), np.cumsum([b.shape[1] for b in boxes])[:-1], axis=1)


def _over_rows(cost: Array) -> Array:
    total: Array = (1 - _WORST) * cost.mean(axis=0) + _WORST * cost.max(axis=0)
    return total


def _settled(fixed: Sequence[Array], boxes: Sequence[Array]) -> list[int]:
    """The position of every label, the better of two local optima.

    Names with the fewest free positions are placed first, or last.
    """
    order = sorted(range(len(fixed)), key=lambda k: -float(fixed[k].min()))
    near = _neighbours(boxes)
    tried = [_descended(fixed, boxes, near, one) for one in (order, order[::-1])]
    return min(tried, key=lambda pair: pair[0])[1]


def _descended(
    fixed: Sequence[Array], boxes: Sequence[Array], near: BoolArray, order: Sequence[int]
) -> tuple[float, list[int]]:
    """The penalty and the positions of names placed in an order, then moved one by one."""
    chosen: dict[int, int] = {}
    total = 0.0
    for _ in range(4):
        before, total = dict(chosen), 0.0
        for k in order:
            cost = fixed[k].copy()
            for other, place in chosen.items():
                if near[k, other]:
                    shared = _overlapping(boxes[k], boxes[other][:, place])
                    cost += _NAME_ON_NAME * _over_rows(shared.astype(float))
            chosen[k] = int(cost.argmin())
            total += float(cost.min())
        if chosen == before:
            break
    return total, [chosen[k] for k in range(len(fixed))]


def _neighbours(boxes: Sequence[Array]) -> BoolArray:
    """Whether any positions of two different names can overlap in a row, (n, n)."""
    around = np.stack([
        np.concatenate((box[..., :2].min(axis=1), box[..., 2:].max(axis=1)), axis=-1)
        for box in boxes
    ], axis=1)  # fmt: skip
    near = np.stack([_overlapping(around, box).any(axis=0) for box in around.swapaxes(0, 1)])
    return np.asarray(near & ~np.eye(len(boxes), dtype=bool))


def _overlapping(boxes: Array, others: Array) -> BoolArray:
    """Whether boxes (rows, places, 4) overlap one box per row (rows, 4); shape (rows, places)."""
    other = others[:, None, :]
    return np.asarray(
        (boxes[..., 0] < other[..., 2])
        & (other[..., 0] < boxes[..., 2])
        & (boxes[..., 1] < other[..., 3])
        & (other[..., 1] < boxes[..., 3])
    )


# ----------------------------------------------------------------------
# Attachment of drawn shapes to the moving frame of a mechanism in which they are constant.
#
# A frame has its origin at a point (or fixed) and rotates with a link or with the line between two
# points (or not at all). Whether a shape is constant in a frame is determined from its coordinates
# in the rows of a motion, so new symbols need no declaration.


_RIGID = 1e-7  # of the drawn size: shapes that move less are constant in a frame


@dataclass(frozen=True)
class Frame:
    """The frame of a shape: moves with the point ``origin``, rotates with ``turn``; "" for ground.

    ``turn`` is the name of a link, or ``from>to`` for the line between two points.
    """

    origin: str = ""
    turn: str = ""


STILL = Frame()


@dataclass(frozen=True, kw_only=True)
class Frames:
    """Points and directions of a motion over N rows.

    Parameters
    ----------
    points : Mapping[str, array (N,)]
        Paths x + iy.
    turns : Mapping[str, array (N,)]
        Angles [rad] of rotating parts, unwrapped along the rows.
    """

    points: FrozenDict[str, ComplexArray]
    turns: FrozenDict[str, Array]

    @classmethod
    def of(cls, motion: Motion, pose: Pose) -> Frames:
        """All frames in which shapes of a mechanism may be constant."""
        return cls(points=FrozenDict(pose.paths), turns=FrozenDict(_turns(motion, pose)))

    def angle(self, frame: Frame) -> Array | float:
        """The angle of a frame [rad], shape (N,), or 0 if it does not rotate."""
        return self.turns[frame.turn] if frame.turn else 0.0

    def origin(self, frame: Frame) -> ComplexArray | complex:
        """The origin of a frame, shape (N,), or 0 if it is fixed."""
        return self.points[frame.origin] if frame.origin else 0j

    def local(self, frame: Frame, shape: ComplexArray, rows: CountArray) -> ComplexArray:
        """Coordinates in a frame of a shape (R, m) given in ``rows``."""
        origin, angle = np.asarray(self.origin(frame)), np.asarray(self.angle(frame))
        if origin.ndim:
            shape = shape - origin[rows][..., None]
        if angle.ndim:
            shape = shape * np.exp(-1j * angle[rows])[..., None]
        return shape

    def placed(self, frame: Frame, local: ComplexArray, rows: CountArray) -> ComplexArray:
        """Coordinates (R, m) in R rows of a shape (m,) constant in a frame."""
        count = len(rows)
        placed = np.broadcast_to(local, (count, len(local)))
        angle, origin = np.asarray(self.angle(frame)), np.asarray(self.origin(frame))
        if angle.ndim:
            placed = placed * np.exp(1j * angle[rows])[:, None]
        if origin.ndim:
            placed = placed + origin[rows][:, None]
        return placed

    def holding(
        self,
        shape: ComplexArray,
        rows: CountArray,
        size: float,
        *,
        first: str = "",
        closed: bool = False,
    ) -> Frame | None:
        """The frame in which a shape (R, m) is constant over ``rows``; ground is tried first.

        ``first`` is the point or link tried next; ``size`` is that of the drawing. The corners of
        a ``closed`` shape may start at a different corner in every row: a gear rotated by a tooth
        looks the same.
        """
        middle = shape.mean(axis=1, keepdims=True)
        # searching direction and origin separately is faster than in pairs
        for turn in _ordered(self.turns, first):
            if not _constant(self.local(Frame(turn=turn), shape - middle, rows), size, closed):
                continue
            for origin in _ordered(self.points, first):
                frame = Frame(origin, turn)
                if _constant(self.local(frame, middle, rows), size):
                    return frame
        return None


def _ordered(names: Iterable[str], first: str) -> list[str]:
    return sorted(["", *names], key=lambda name: (bool(name), name != first))


def _constant(local: ComplexArray, size: float, closed: bool = False) -> bool:
    """Whether a shape (R, m) is the same in all rows."""
    if np.abs(local - local[0]).max(initial=0.0) <= _RIGID * size:
        return True
    if not closed:
        return False
    # start at the corner nearest to the first one of the first row
    corner = np.abs(local - local[0, 0]).argmin(axis=1)
    count = local.shape[1]
    again = np.take_along_axis(local, (corner[:, None] + np.arange(count)) % count, axis=1)
    return _constant(again, size)


def _turns(motion: Motion, pose: Pose) -> Iterator[tuple[str, Array]]:
    """The directions of all links and of all guiding lines."""
    skeleton, radians = pose.skeleton, motion.units.angle.radians
    for bar in skeleton.bars:
        if bar.name in motion.links:
            yield bar.name, motion.links[bar.name].value * radians
        elif len(set(bar.points)) > 1:
            start, end = list(dict.fromkeys(bar.points))[:2]
            yield bar.name, _direction(pose.paths[end] - pose.paths[start])
    lines = [strut.between for strut in skeleton.struts]
    lines += [guide.line for guide in skeleton.guides if not pose.on_ground(guide)]
    lines += [figure.turns_with for figure in skeleton.figures if figure.turns_with]
    for start, end in dict.fromkeys(lines):
        yield f"{start}>{end}", _direction(pose.paths[end] - pose.paths[start])


def _direction(line: ComplexArray) -> Array:
    """Angles [rad] of vectors (N,), unwrapped over the rows with a direction; NaN elsewhere."""
    angle = np.angle(line)
    known = np.isfinite(angle)
    # unwrapping across a NaN would lose all later rows
    angle[known] = np.unwrap(angle[known])
    return angle


# ----------------------------------------------------------------------
# Moving primitives: attached to a frame, or with coordinates per row.


_ARC_PIECES = 32  # points of an arc with variable sweep
#: Kind, role and part of a primitive, and its index among primitives equal in these.
Key = tuple[type[Primitive], Role, str, int]


@dataclass(frozen=True, kw_only=True)
class Moving:
    """A moving primitive.

    Parameters
    ----------
    shape : Primitive
        The primitive in the reference row.
    frame : Frame, optional
        Its frame; ``None`` if it deforms.
    course : array (N, m), optional
        Its corners x + iy in every row, if it has no frame; NaN in rows where it is not drawn.
    """

    shape: Primitive
    frame: Frame | None
    course: ComplexArray | None = None


def drawn_symbols(pose: Pose, measures: Measures) -> Iterator[Primitive]:
    """The symbols of all parts in a pose, without traces, arrows and names."""
    return symbols(pose, tracks(pose, measures, tones(pose)), (), measures)


def keyed(primitives: Iterator[Primitive]) -> Iterator[tuple[Key, Primitive]]:
    """Primitives with keys that match those of another pose."""
    count: dict[tuple[type[Primitive], Role, str], int] = {}
    for primitive in primitives:
        kind = (type(primitive), primitive.role, primitive.of)
        count[kind] = count.get(kind, -1) + 1
        yield (*kind, count[kind]), primitive


def attach_shapes(
    motion: Motion, pose: Pose, measures: Measures, frames: Frames, rows: CountArray
) -> dict[Key, Moving]:
    """Each primitive with its frame, from its coordinates in these rows."""
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
    courses = [corners(one) for one in along.values()]
    # a shape missing in some rows, or with other corners, is not rigid
    alike = len(along) == len(rows) and len({len(one) for one in courses}) == 1
    if alike and same_sizes(along.values(), measures.size):
        frame = frames.holding(
            np.stack(courses),
            rows,
            measures.size,
            first=shape.of,
            closed=_closed(shape),
        )
        if frame is not None:
            return Moving(shape=shape, frame=frame)
    return _varying_course(shape, along, rows, len(motion))


def _closed(shape: Primitive) -> bool:
    """Whether the corners may start at any corner."""
    # a line of two points may be reversed, an arrow may not
    line = isinstance(shape, Polyline) and len(shape.points) == 2 and not shape.head
    return line or isinstance(shape, Polygon)


def _varying_course(
    shape: Primitive, along: Mapping[int, Primitive], rows: CountArray, count: int
) -> Moving:
    """A primitive with its corners in every row; an arc becomes a line."""
    lines = {k: _as_line(one) for k, one in along.items()}
    most = max(len(line) for line in lines.values())
    course = np.full((count, most), complex(np.nan, np.nan))
    for k, line in lines.items():
        course[rows[k], : len(line)] = line
        # a shorter line repeats its last corner, which draws nothing
        course[rows[k], len(line) :] = line[-1]
    if isinstance(shape, Arc):
        style = {"role": shape.role, "of": shape.of, "tone": shape.tone, "head": shape.head}
        shape = Polyline(points=tuple(map(xy, _as_line(shape))), **style)  # type: ignore[arg-type]
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
    """The primitives of a pose with the frames of other dimensions."""
    changing = [key for key, part in carried.items() if part.frame is None]
    course: dict[Key, dict[int, Primitive]] = {key: {} for key in changing}
    for k, row in enumerate(rows if changing else ()):
        for key, primitive in keyed(drawn_symbols(pose.moved_to(motion, int(row)), measures)):
            if key in course:
                course[key][k] = primitive
    return [
        _varying_course(shape, course[key], rows, len(motion))
        if key in course
        else Moving(shape=shape, frame=carried[key].frame)
        for key, shape in shown.items()
    ]


# ----------------------------------------------------------------------
# A motion as a moving picture: every primitive is attached to a frame, or has coordinates per row.
#
# The primitives are those of :func:`~linkwork.core.drawing.mechanism_scene.scene_of`. Most are
# rigid:
# they are fixed to ground, a link or a point. Others (pistons, rods partly hidden by a collar, …)
# have coordinates for every row. Names and arrows keep their positions over the whole motion.
# Nothing is solved here.


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
        """The picture in a solved row; ``turned``: with reversed arrows of inputs."""
        if not self.found[row]:
            raise InputError(f"row {row} of the motion has no position to draw")
        shapes = tuple(filter(None, (self._placed(part, row) for part in self.parts)))
        if turned:
            shapes = tuple(map(_turned, shapes))
        return replace(self.scene, primitives=shapes)

    def _placed(self, part: Moving, row: int) -> Primitive | None:
        if part.frame is None:
            assert part.course is not None
            course = part.course[row]
            return with_corners(part.shape, course) if np.isfinite(course[0]) else None
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
        :func:`~linkwork.core.drawing.mechanism_scene.reach_of`.
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
    drawn_tracks = tracks(pose, measures, tones(pose))
    drawn = [part.shape for part in parts]
    for arrow in input_arrows(pose, drawn_tracks, measures, sense, drawn):
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
