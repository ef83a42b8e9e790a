"""What moves with what: the frame of a mechanism in which a drawn shape stands still.

A frame has its origin at a point (or stands still) and turns with a link or with the line between
two points (or does not turn). Whether a shape is rigid in a frame is read off its coordinates in
the rows of a motion, so new symbols need no declaration of their own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.pose import Pose
from linkwork.foundation.arrays import Array, ComplexArray, CountArray
from linkwork.foundation.frozen import FrozenDict
from linkwork.results.motion import Motion

__all__ = ["STILL", "Frame", "Frames"]

_RIGID = 1e-7  # of the drawn size: shapes that move less in a frame stand still in it


@dataclass(frozen=True)
class Frame:
    """Where a shape is carried: by the point ``origin``, turned with ``turn``; "" for ground.

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
        Angles [rad] of what turns, unwrapped along the rows.
    """

    points: FrozenDict[str, ComplexArray]
    turns: FrozenDict[str, Array]

    @classmethod
    def of(cls, motion: Motion, pose: Pose) -> Frames:
        """All frames that shapes of a mechanism may be rigid in."""
        return cls(points=FrozenDict(pose.paths), turns=FrozenDict(_turns(motion, pose)))

    def angle(self, frame: Frame) -> Array | float:
        """The angle of a frame [rad], shape (N,), or 0 if it never turns."""
        return self.turns[frame.turn] if frame.turn else 0.0

    def origin(self, frame: Frame) -> ComplexArray | complex:
        """The origin of a frame, shape (N,), or 0 if it stands still."""
        return self.points[frame.origin] if frame.origin else 0j

    def local(self, frame: Frame, shape: ComplexArray, rows: CountArray) -> ComplexArray:
        """Coordinates in a frame of a shape (R, m) that is given in ``rows``."""
        origin, angle = np.asarray(self.origin(frame)), np.asarray(self.angle(frame))
        if origin.ndim:
            shape = shape - origin[rows][..., None]
        if angle.ndim:
            shape = shape * np.exp(-1j * angle[rows])[..., None]
        return shape

    def placed(self, frame: Frame, local: ComplexArray, rows: CountArray) -> ComplexArray:
        """A shape (m,) of a frame in R rows, shape (R, m)."""
        count = len(rows)
        found = np.broadcast_to(local, (count, len(local)))
        angle, origin = np.asarray(self.angle(frame)), np.asarray(self.origin(frame))
        if angle.ndim:
            found = found * np.exp(1j * angle[rows])[:, None]
        if origin.ndim:
            found = found + origin[rows][:, None]
        return found

    def holding(
        self,
        shape: ComplexArray,
        rows: CountArray,
        size: float,
        *,
        first: str = "",
        closed: bool = False,
    ) -> Frame | None:
        """The frame in which a shape (R, m) is rigid over ``rows``; ground before all others.

        ``first`` is the point or link that is tried before the others; ``size`` is that of the
        drawing. The corners of a ``closed`` shape may be numbered from another one in every row:
        a gear that has turned by a tooth is the same gear.
        """
        middle = shape.mean(axis=1, keepdims=True)
        # direction and origin are sought one after the other, not in pairs: quicker
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
    # the corner nearest to the first one of the first row is numbered first
    corner = np.abs(local - local[0, 0]).argmin(axis=1)
    count = local.shape[1]
    again = np.take_along_axis(local, (corner[:, None] + np.arange(count)) % count, axis=1)
    return _constant(again, size)


def _turns(motion: Motion, pose: Pose) -> Iterator[tuple[str, Array]]:
    """The directions of all links, and of all lines that something runs along."""
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
    """Angles [rad] of vectors (N,), unwrapped over the rows that have one; NaN elsewhere."""
    angle = np.angle(line)
    known = np.isfinite(angle)
    # unwrapping across a NaN would lose all later rows
    angle[known] = np.unwrap(angle[known])
    return angle
