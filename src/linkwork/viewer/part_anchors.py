"""How the parts of a drawn motion move with its points, so that a page can draw other lengths.

Most shapes have their corners at points, or at a fixed distance from one in the frame of a link.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.attachment import STILL, Frame
from linkwork.drawing.moving_scene import MovingScene, moving_scene
from linkwork.drawing.moving_shape import Moving
from linkwork.drawing.scene import Role
from linkwork.foundation.arrays import ComplexArray
from linkwork.results.motion import Motion
from linkwork.viewer.page_data import FrameData, TrackData, TurnSource
from linkwork.viewer.page_shapes import places_of

__all__ = ["anchors_of", "frames_of", "tracks_of", "turn_source", "unlike_parts", "used_turns"]

_SYMBOLS = (Role.GROUND, Role.HATCH, Role.LABEL, Role.INPUT)


def _carriers(scene: MovingScene) -> list[Frame]:
    """The frames in use, as in :func:`~linkwork.viewer.page_shapes.shapes_of`."""
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
                own = scene.frames.points[guide.point]
                path = np.broadcast_to(own, (len(motion),))[rows, None]
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
    size, found = scene.scene.measures.size, {}
    for k, name in enumerate(motion.points):
        own = np.broadcast_to(scene.frames.points[name], (len(motion),))[rows, None]
        local = scene.frames.local(frame, own, rows)[:, 0]
        if np.abs(local - local[0]).max() <= 1e-9 * size:
            found[k] = complex(local[0])
    return found


def _holding(motion: Motion, scene: MovingScene, part: Moving) -> dict[int, complex]:
    """The points that corners of a part can move with: those of its frame, and ends of tracks."""
    assert part.frame is not None
    first, ends, own = len(motion.points), dict[int, complex](), False
    for k, track in enumerate(_tracks(motion, scene)):
        if track.frame == part.frame and (
            part.shape.of == track.name or part.shape.role is Role.LINK
        ):
            ends |= {first + 2 * k: track.ends[0], first + 2 * k + 1: track.ends[1]}
            own |= part.shape.of == track.name
    return ends if own else _rigid_points(motion, scene, part.frame) | ends


def _local(scene: MovingScene, part: Moving) -> ComplexArray:
    """The corners of a part in its frame."""
    assert part.frame is not None
    own = np.array([complex(*place) for place in places_of(part.shape)])
    local: ComplexArray = scene.frames.local(part.frame, own[None], np.array([scene.row]))[0]
    return local


def anchors_of(motion: Motion, scene: MovingScene, part: Moving) -> tuple[int, ...]:
    """The points of its frame that the corners of a part move with; none of an arrow or a path."""
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
