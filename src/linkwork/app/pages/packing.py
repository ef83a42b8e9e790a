"""Compact columns of smooth numbers: rounded, differenced, and written as short integers.

A column of a cycle changes slowly from row to row, and its differences even less. Values are
rounded to multiples of a step and differenced; the order that needs the fewest bytes is written as
zigzag integers in groups of seven bits. The front end sums them.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from linkwork.app.pages.moving_scene import STILL, Frame, Moving, MovingScene, moving_scene
from linkwork.app.pages.page_data import (
    FrameData,
    PackedColumn,
    Part,
    TrackData,
    TurnData,
    TurnSource,
)
from linkwork.core.drawing.scene import (
    XY,
    Arc,
    Disc,
    Hatch,
    Polygon,
    Polyline,
    Primitive,
    Role,
    Text,
)
from linkwork.core.equations.input_motion import TIME
from linkwork.core.foundation.arrays import EQUAL_ROWS, Array, BoolArray, ComplexArray, CountArray
from linkwork.core.results.motion import Motion

#: The ``order`` of a column of plain floats of eight or four bytes.
PLAIN, SHORT = -1, -2

_FLOATS = {PLAIN: "<f8", SHORT: "<f4"}
_RATE_DIGITS = 7
_BITS = 34  # relative to the largest value: ten digits
_ORDERS = range(8)
_LARGEST = 2.0**52
_LEAST = -1022  # exponent of two of the smallest number written in full


class Pack(Protocol):
    """An encoding of a column."""

    def __call__(
        self, values: Array, solved: BoolArray, *, step: float | None = None, rate: bool = False
    ) -> PackedColumn:
        """The ``solved`` rows of a column (N,)."""


def packed(
    values: Array, solved: BoolArray, *, step: float | None = None, rate: bool = False
) -> PackedColumn:
    """Pack the ``solved`` rows of a column (N,); values that are not finite become gaps.

    Parameters
    ----------
    values : array (N,)
    solved : array (N,) of bool
    step : float, optional
        Rounding step; by default ten digits of the largest value.
    rate : bool
        A derivative, which is unbounded near a dead point: seven digits of usual values.
    """
    known = np.isfinite(values[solved])
    kept = np.where(known, values[solved], 0.0)
    if rate:
        kept, step = _clipped(kept)
    largest = float(np.abs(kept).max(initial=0.0))
    power = math.floor(math.log2(largest)) + 1 - _BITS if largest > 0 else 0
    size = 2.0 ** max(power, _LEAST)
    chosen = size if step is None else step
    whole = np.rint(kept / chosen)
    if np.abs(whole).max(initial=0.0) > _LARGEST / 2 ** max(_ORDERS):
        raise ValueError(f"step {chosen:g} is too fine for values up to {largest:g}")
    order, differences = _smallest(whole.astype(np.int64))
    content = _bytes(differences)
    text = base64.b64encode(content).decode()
    gaps = tuple(np.flatnonzero(~known).tolist())
    return PackedColumn(step=chosen, order=order, content=text, gaps=gaps)


def unpressed(
    values: Array, solved: BoolArray, *, step: float | None = None, rate: bool = False
) -> PackedColumn:
    """Pack a column as plain floats: fast and exact."""
    return _plain(values, solved, PLAIN)


def shortened(
    values: Array, solved: BoolArray, *, step: float | None = None, rate: bool = False
) -> PackedColumn:
    """Pack a column with seven digits, in half the size."""
    return _plain(values, solved, SHORT)


def _clipped(kept: Array) -> tuple[Array, float]:
    """Derivatives limited near dead points, and their rounding step."""
    size = np.abs(kept)
    largest = float(size.max(initial=0.0))
    usual = min(largest, 1e3 * float(np.median(size))) if len(kept) else 0.0
    usual = usual or largest
    step = 10.0 ** np.floor(np.log10(usual) - _RATE_DIGITS) if usual else 1.0
    return np.clip(kept, -1e4 * usual, 1e4 * usual), float(step)


def _plain(values: Array, solved: BoolArray, order: int) -> PackedColumn:
    kept_values = values if solved.all() else values[solved]
    with np.errstate(over="ignore"):
        kept = kept_values.astype(_FLOATS[order])
    # larger values are gaps, as those that are not finite
    fitting = np.isfinite(kept)
    if not fitting.all():
        kept[~fitting] = np.nan
    return PackedColumn(step=1.0, order=order, content=base64.b64encode(kept.tobytes()).decode())


def _smallest(whole: CountArray) -> tuple[int, CountArray]:
    """The differences that need the fewest bytes, and their order."""
    best, least, order = whole, _length(whole), 0
    for k in _ORDERS[1:]:
        whole = np.diff(whole, prepend=0)
        length = _length(whole)
        if length < least:
            best, least, order = whole, length, k
        elif k > order + 1:
            break
    return order, best


def _length(whole: CountArray) -> float:
    """The approximate number of bytes of numbers."""
    return float(np.log2(2.0 * np.abs(whole) + 1.0).sum()) / 7 + len(whole)


def _bytes(whole: CountArray) -> bytes:
    """Zigzag: 0, -1, 1, -2, …; then groups of seven bits, the lowest first."""
    left = ((whole << 1) ^ (whole >> 63)).astype(np.uint64)
    groups = []
    while True:
        groups.append((left & np.uint64(0x7F)).astype(np.uint8))
        left = left >> np.uint64(7)
        if not left.any():
            break
    table = np.stack(groups, axis=1)
    # The last nonzero group of a number ends it; the groups before it are marked.
    last = table.shape[1] - 1 - (table[:, ::-1] != 0).argmax(axis=1)
    last[~table.any(axis=1)] = 0
    place = np.arange(table.shape[1])
    table[place < last[:, None]] |= 0x80
    content: bytes = table[place <= last[:, None]].tobytes()
    return content


# ----------------------------------------------------------------------
# The rows of a motion in playing order.


_MEETING = 1.5  # in multiples of the largest step: runs with nearer ends are joined


def play_order(motion: Motion) -> tuple[CountArray, bool]:
    """Solved rows in order, and whether the first follows the last.

    A table starts anywhere on a circuit, may have a gap without positions, and lists further
    branches at its end. Runs of neighbouring rows are joined at common ends; other runs follow each
    other. The order follows time: it is reversed if the input speed is opposite to the table. Rows
    over the time keep their order, also where the mechanism rests.
    """
    if in_time(motion):
        return np.flatnonzero(motion.found), False
    places = _places(motion)
    runs = _runs(places, motion)
    limit = np.array([bool(what) for what in motion.limit], dtype=bool)
    usual = (places[run[~limit[run]]] for run in runs)
    near = _MEETING * max(map(_largest_step, usual), default=0.0)
    chain = [runs.pop(0)]
    while runs:
        last, first = places[chain[-1][-1]], places[chain[0][0]]
        after = [_apart(places[run[0]], last) for run in runs]
        back = [_apart(places[run[-1]], last) for run in runs]
        before = [_apart(places[run[-1]], first) for run in runs]
        k = int(np.argmin(np.minimum(np.minimum(after, back), before)))
        if before[k] < min(after[k], back[k]) and before[k] <= near:
            chain.insert(0, runs.pop(k))
        elif back[k] < after[k] and back[k] <= near:
            chain.append(runs.pop(k)[::-1])
        else:
            k = k if after[k] <= near else 0
            chain.append(runs.pop(k))
    closed = _apart(places[chain[-1][-1]], places[chain[0][0]]) <= near
    order = np.concatenate(chain)
    order = order[_passed_once(order, places)]
    if closed and len(order) > 2 and _apart(places[order[-1]], places[order[0]]) < 1e-3 * near:
        order = order[:-1]
    if closed:
        order = np.roll(order, -int(np.argmin(order)))
    if motion.speed:
        lead = next(iter(motion.inputs.values()))[motion.asked]
        if (motion.speed < 0) == (lead[-1] > lead[0]):
            order = np.roll(order[::-1], 1) if closed else order[::-1]
    return order, bool(closed and len(order) > 2)


def in_time(motion: Motion) -> bool:
    """Whether the rows are over the time: a law drives the mechanism, or loads move it."""
    return motion.input_units.get(TIME) == "s"


def falling(motion: Motion, rows: Sequence[int]) -> list[bool]:
    """Whether the leading input decreases from each of these rows to the next; for the last row,
    from the one before.
    """
    name, values = next(iter(motion.inputs.items()))
    ahead = np.diff(values[list(rows)])
    turn = {"deg": 360.0, "rad": 2.0 * np.pi}.get(motion.input_units[name])
    if turn is not None:  # the shorter direction
        ahead = np.remainder(ahead + 0.5 * turn, turn) - 0.5 * turn
    falls = (ahead < 0).tolist()
    return [*falls, *falls[-1:]] if falls else [False] * len(rows)


def _places(motion: Motion) -> ComplexArray:
    """Coordinates of all points, and of tips of links that may rotate about one, shape (N, m)."""
    points = [motion.trace(name) for name in motion.points]
    known = np.concatenate(points)[np.isfinite(np.concatenate(points))]
    size = float(np.abs(known - known[:1]).max(initial=0.0)) or 1.0
    radians = motion.units.angle.radians
    tips = [size * np.exp(1j * series.value * radians) for series in motion.links.values()]
    return np.stack([*points, *tips], axis=1)


def _passed_once(order: CountArray, places: ComplexArray) -> BoolArray:
    """The rows to keep: if runs meet in the same position, only the first listed row."""
    there = places[order]
    span = float(np.abs(there - there[0]).max())
    kept = np.ones(len(order), dtype=bool)
    for k in np.flatnonzero(np.abs(np.diff(there, axis=0)).max(axis=1) <= EQUAL_ROWS * span):
        kept[k if order[k] > order[k + 1] else k + 1] = False
    return kept


def _runs(places: ComplexArray, motion: Motion) -> list[CountArray]:
    """Runs of neighbouring solved rows, interrupted at jumps of the mechanism.

    Near a limit, large motions for small input steps on one branch are not jumps.
    """
    rows = np.flatnonzero(motion.found)
    steps = np.abs(np.diff(places[rows], axis=0)).max(axis=1, initial=0.0)
    usual = float(np.quantile(steps, 0.95)) if len(steps) else 0.0
    limit = np.array([bool(what) for what in motion.limit], dtype=bool)[rows]
    branch = np.array(motion.branch)[rows]
    at_limit = (limit[:-1] | limit[1:]) & (branch[:-1] == branch[1:])
    breaks = (np.diff(rows) > 1) | ((steps > 8 * max(usual, 1e-300)) & ~at_limit)
    return list(np.split(rows, np.flatnonzero(breaks) + 1))


def _largest_step(places: ComplexArray) -> float:
    return float(np.abs(np.diff(places, axis=0)).max(initial=0.0))


def _apart(one: ComplexArray, other: ComplexArray) -> float:
    return float(np.abs(one - other).max())


# ----------------------------------------------------------------------
# The shapes and frames of a moving scene in the format of the front end.


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


def _course(course: ComplexArray, solved: BoolArray, pack: Pack) -> Iterator[PackedColumn]:
    for corner in course.T:
        yield pack(np.nan_to_num(corner.real), solved)
        yield pack(np.nan_to_num(corner.imag), solved)


def _shown(course: ComplexArray, pack: Pack) -> PackedColumn:
    there = np.isfinite(course[:, 0].real)
    return pack(there.astype(float), np.ones(len(there), dtype=bool), step=1.0)


# ----------------------------------------------------------------------
# How the parts of a drawn motion move with its points, so that a page can draw other lengths.
#
# Most shapes have their corners at points, or at a fixed distance from one in the frame of a link.


_SYMBOLS = (Role.GROUND, Role.HATCH, Role.LABEL, Role.INPUT)


def _carriers(scene: MovingScene) -> list[Frame]:
    """The frames in use, as in :func:`~linkwork.app.pages.packing.shapes_of`."""
    used = dict.fromkeys(part.frame for part in scene.parts)
    return [frame for frame in used if frame is not None and frame != STILL]


def used_turns(scene: MovingScene) -> list[str]:
    """The links and lines with which parts of a scene turn."""
    return list(dict.fromkeys(frame.turn for frame in _carriers(scene) if frame.turn))


def turn_source(turn: str, motion: Motion, links: Sequence[str]) -> TurnSource:
    """Where the angle of a turn comes from: one of the ``links``, or two points."""
    if turn in links:
        return TurnSource(angle=links.index(turn), start=-1, end=-1)
    bars = {bar.name: list(dict.fromkeys(bar.points)) for bar in motion.skeleton.bars}
    start, end = bars[turn][:2] if turn in bars else turn.split(">")
    points = list(motion.points)
    return TurnSource(angle=-1, start=points.index(start), end=points.index(end))


def frames_of(motion: Motion, scene: MovingScene) -> Iterator[FrameData]:
    """The frames; one that turns about the origin of the plane turns about the point there."""
    points, turns = list(motion.points), used_turns(scene)
    for frame in _carriers(scene):
        origin = points.index(frame.origin) if frame.origin else -1
        if frame.turn and not frame.origin:
            rigid = _rigid_points(motion, scene, frame)
            origin = next((k for k, z in rigid.items() if abs(z) == 0.0), -1)
        yield FrameData(origin=origin, turn=turns.index(frame.turn) if frame.turn else -1)


@dataclass(frozen=True)
class _Track:
    """The track of a guided point in a frame; ``ends``: of the point's path there."""

    name: str
    frame: Frame
    point: int
    along: complex
    ends: tuple[complex, complex]


def _tracks(motion: Motion, scene: MovingScene) -> Iterator[_Track]:
    """The tracks of guides, in every frame in use that has their line."""
    points, rows = list(motion.points), np.flatnonzero(scene.found)
    frames = [STILL, *_carriers(scene)]
    rigid = [_rigid_points(motion, scene, frame) for frame in frames] if points else []
    for guide in motion.skeleton.guides:
        start, end = (points.index(name) for name in guide.line)
        for frame, places in zip(frames, rigid, strict=True):
            if start in places and end in places:
                along = places[end] - places[start]
                along /= abs(along)
                guide_path = scene.frames.points[guide.point]
                path = np.broadcast_to(guide_path, (len(motion),))[rows, None]
                local = scene.frames.local(frame, path, rows)[:, 0]
                order = np.argsort((local * along.conjugate()).real)
                ends = complex(local[order[0]]), complex(local[order[-1]])
                yield _Track(guide.name, frame, points.index(guide.point), along, ends)


def tracks_of(motion: Motion, scene: MovingScene) -> Iterator[TrackData]:
    """The tracks, in the order in which anchors count their ends."""
    carriers = _carriers(scene)
    for track in _tracks(motion, scene):
        yield TrackData(
            point=track.point,
            frame=carriers.index(track.frame) if track.frame != STILL else -1,
            x=track.along.real,
            y=track.along.imag,
        )


def _rigid_points(motion: Motion, scene: MovingScene, frame: Frame) -> dict[int, complex]:
    """Points that are constant in a frame, by index, and where they are in it."""
    rows = np.flatnonzero(scene.found)
    size, rigid = scene.scene.measures.size, {}
    for k, name in enumerate(motion.points):
        path = np.broadcast_to(scene.frames.points[name], (len(motion),))[rows, None]
        local = scene.frames.local(frame, path, rows)[:, 0]
        if np.abs(local - local[0]).max() <= 1e-9 * size:
            rigid[k] = complex(local[0])
    return rigid


def _holding(motion: Motion, scene: MovingScene, part: Moving) -> dict[int, complex]:
    """The points that corners of a part can move with: those of its frame, and ends of tracks."""
    assert part.frame is not None
    first, ends, of_track = len(motion.points), dict[int, complex](), False
    for k, track in enumerate(_tracks(motion, scene)):
        if track.frame == part.frame and (
            part.shape.of == track.name or part.shape.role is Role.LINK
        ):
            ends |= {first + 2 * k: track.ends[0], first + 2 * k + 1: track.ends[1]}
            of_track |= part.shape.of == track.name
    return ends if of_track else _rigid_points(motion, scene, part.frame) | ends


def _local(scene: MovingScene, part: Moving) -> ComplexArray:
    """The corners of a part in its frame."""
    assert part.frame is not None
    corners = np.array([complex(*place) for place in places_of(part.shape)])
    local: ComplexArray = scene.frames.local(part.frame, corners[None], np.array([scene.row]))[0]
    return local


def anchors_of(motion: Motion, scene: MovingScene, part: Moving) -> tuple[int, ...]:
    """The points with which the corners of a part move; none of an arrow or a path."""
    if part.frame is None or part.shape.role in (Role.TRACE, Role.INPUT):
        return ()
    rigid = _holding(motion, scene, part)
    if not rigid:
        return ()
    return tuple(min(rigid, key=lambda k: abs(rigid[k] - z)) for z in _local(scene, part))


def unlike_parts(
    scene: MovingScene, motion: Motion, anchors: Sequence[tuple[int, ...]], changed: Motion | None
) -> tuple[int, ...]:
    """Parts that another motion draws otherwise than by moving their corners with points."""
    if changed is None:
        return tuple(k for k, part in enumerate(scene.parts) if not _is_plain(part))
    other = moving_scene(changed, like=scene, within=scene.scene.within)
    if [p.frame for p in other.parts] != [p.frame for p in scene.parts]:
        return tuple(k for k, part in enumerate(scene.parts) if not _is_plain(part))
    return tuple(
        k
        for k, (part, now) in enumerate(zip(scene.parts, other.parts, strict=True))
        if part.shape.role is not Role.TRACE
        and not _is_moved(scene, part, other, now, anchors[k], motion, changed)
    )


def _is_plain(part: Moving) -> bool:
    """Whether a part is a link between points, a pin or a name."""
    plain = (Role.LINK, Role.PLATE, Role.PIN, Role.POINT, Role.TRACED, Role.LABEL, Role.TRACE)
    return part.frame is not None and part.shape.role in plain


def _is_moved(
    scene: MovingScene,
    part: Moving,
    other: MovingScene,
    now: Moving,
    anchors: tuple[int, ...],
    motion: Motion,
    changed: Motion,
) -> bool:
    on_track = any(k >= len(motion.points) for k in anchors)
    if part.frame is None or (on_track and part.shape.role is Role.HATCH):
        return False  # as many strokes as its length has
    if part.shape.role in _SYMBOLS and len(set(anchors)) <= 1:
        return True  # it stays as it is at its point, whichever way the other drawing turns it
    before, after = _local(scene, part), _local(other, now)
    if len(before) != len(after) or getattr(part.shape, "radius", 0.0) != getattr(
        now.shape, "radius", 0.0
    ):
        return False
    moved = np.zeros(len(before), dtype=complex)
    if anchors:
        old, new = _holding(motion, scene, part), _holding(changed, other, now)
        if not new.keys() >= set(anchors):
            return False
        moved = np.array([new[k] - old[k] for k in anchors])
    gap = float(np.abs(after - before - moved).max(initial=0.0))
    return gap <= 1e-6 * scene.scene.measures.size and math.isfinite(gap)
