"""Drawn parts as obstacles for labels, with penalties for covering them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.drawing.box import Box
from linkwork.drawing.scene import XY, Arc, Disc, Hatch, Polygon, Polyline, Primitive, Role, Text
from linkwork.foundation.arrays import Array, BoolArray, IndexArray

__all__ = ["Obstacles"]

#: Penalty for covering a line or disc of a role; highest for pins.
_PENALTY = {
    Role.FRAME: 6.0, Role.WHEEL: 6.0, Role.PITCH: 1.5, Role.MARK: 8.0, Role.BELT: 14.0,
    Role.PLATE: 9.0, Role.HATCH: 6.0, Role.GROUND: 10.0, Role.TRACE: 2.5, Role.SLOT: 12.0,
    Role.SLIDER: 12.0, Role.LINK: 14.0, Role.CYLINDER: 14.0, Role.PIN: 60.0, Role.POINT: 40.0,
    Role.WELD: 30.0, Role.TRACED: 40.0, Role.LIMIT: 40.0, Role.INPUT: 14.0, Role.SPEED_TRACE: 4.0,
    Role.FIXED_CENTRODE: 4.0, Role.MOVING_CENTRODE: 4.0, Role.EXTENSION: 4.0, Role.DIMENSION: 12.0,
    Role.VECTOR: 14.0, Role.VELOCITY: 14.0, Role.ACCELERATION: 14.0, Role.FORCE: 14.0,
    Role.CENTRE: 30.0, Role.SPRING: 12.0, Role.POSITION: 30.0,
}  # fmt: skip
_INSIDE_PLATE = 1.5
_TEXT = 100.0  # penalty for covering text
_OPEN = (Role.FRAME, Role.WHEEL, Role.PITCH)  # discs inside which names and arrows may be placed


@dataclass(frozen=True)
class Obstacles:
    """Line pieces (m, 4), discs (d, 3) and sides of plates (n, s, 4), with penalties for covering
    them.

    ``levels`` (l,): the penalties of pieces; ``level`` (m,): the index of each piece's penalty.
    """

    pieces: Array
    level: IndexArray
    levels: Array
    discs: Array
    disc_cost: Array
    plates: Array

    @classmethod
    def of(cls, drawn: Iterable[Primitive]) -> Obstacles:
        """The obstacles of a drawing."""
        pieces: list[tuple[float, float, float, float]] = []
        piece_cost: list[float] = []
        discs: list[tuple[float, float, float]] = []
        disc_cost: list[float] = []
        plates: list[tuple[XY, ...]] = []
        for p in drawn:
            found: list[tuple[XY, XY]] = []
            # covering a faded position has a smaller penalty
            penalty = _PENALTY.get(p.role, 0.0) * (1.0 - p.fade) ** 2
            if isinstance(p, Disc) and p.role in _OPEN:
                found = list(pairwise(p.rim))
            elif isinstance(p, Disc):
                discs.append((*p.centre, p.radius))
                disc_cost.append(penalty)
            elif isinstance(p, Polyline | Arc):
                found = list(pairwise(p.points))
            elif isinstance(p, Polygon):
                found = list(zip(p.points, p.points[1:] + p.points[:1], strict=True))
                if p.role is Role.PLATE and not p.fade:
                    plates.append(p.points)
            elif isinstance(p, Hatch):
                found = list(p.strokes)
            elif isinstance(p, Text):
                found, penalty = list(pairwise(_frame(p.box))), _TEXT
            if penalty:
                pieces += [(*a, *b) for a, b in found]
                piece_cost += [penalty] * len(found)
        levels = sorted(set(piece_cost))
        number = {penalty: k for k, penalty in enumerate(levels)}
        level = np.array([number[penalty] for penalty in piece_cost], dtype=np.intp)
        return cls(
            np.array(pieces).reshape(-1, 4), level, np.array(levels),
            np.array(discs).reshape(-1, 3), np.array(disc_cost), _sides(plates),
        )  # fmt: skip

    def cost(self, boxes: Sequence[Box]) -> float:
        """The penalty of an object made of these boxes."""
        return float(self.costs(np.array([[box.edges for box in boxes]]))[0])

    def costs(self, boxes: Array) -> Array:
        """The penalties (k,) of objects made of b boxes each.

        Parameters
        ----------
        boxes : array (k, b, 4)
            Left, bottom, right, top.
        """
        # A trace of many short pieces counts once per penalty, not once per piece.
        found = np.zeros(len(boxes))
        box, piece = np.nonzero(_near(self.pieces, boxes))
        crossed = _crosses(self.pieces[piece], boxes[box])
        box, level = box[crossed], self.level[piece[crossed]]
        for k, penalty in enumerate(self.levels):
            count = np.bincount(box[level == k], minlength=len(boxes))
            found += np.where(count, penalty * (1.0 + np.log(np.maximum(count, 1))), 0.0)
        inside = np.count_nonzero(_inside(self.plates, boxes), axis=1)
        total: Array = found + _covers(self.discs, boxes) @ self.disc_cost + _INSIDE_PLATE * inside
        return total


def _frame(box: Box) -> list[tuple[float, float]]:
    """The outline and the diagonals of a box."""
    (left, bottom), (right, top) = box.corners
    around = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
    return [*around, (right, top)]


def _sides(plates: Sequence[Sequence[XY]]) -> Array:
    """The sides of convex polygons, (n, s, 4), padded by repeating the last side."""
    most = max(map(len, plates), default=0)
    found = np.empty((len(plates), most, 4))
    for k, corners in enumerate(plates):
        around = np.array([*corners, corners[0]])
        sides = np.hstack((around[:-1], around[1:]))
        found[k, : len(sides)], found[k, len(sides) :] = sides, sides[-1]
    return found


def _near(pieces: Array, boxes: Array) -> BoolArray:
    """Whether pieces (m, 4) may intersect boxes (k, b, 4): those around both do, (k, m)."""
    low, high = boxes[..., :2].min(axis=1), boxes[..., 2:].max(axis=1)
    first = np.minimum(pieces[:, :2], pieces[:, 2:])
    last = np.maximum(pieces[:, :2], pieces[:, 2:])
    near = (first[:, 0] <= high[:, None, 0]) & (last[:, 0] >= low[:, None, 0])
    near &= (first[:, 1] <= high[:, None, 1]) & (last[:, 1] >= low[:, None, 1])
    return np.asarray(near)


def _covers(discs: Array, boxes: Array) -> BoolArray:
    """Whether discs (d, 3) intersect one of the boxes (k, b, 4), (k, d)."""
    x, y, r = discs.T
    left, bottom, right, top = np.moveaxis(boxes, -1, 0)[..., None]
    dx = np.maximum(np.maximum(left - x, x - right), 0.0)
    dy = np.maximum(np.maximum(bottom - y, y - top), 0.0)
    return np.asarray(np.any(np.hypot(dx, dy) < r * (1 - 1e-9), axis=1))


def _crosses(pieces: Array, boxes: Array) -> BoolArray:
    """Whether each line piece (n, 4) intersects one of its boxes (n, b, 4), (n,).

    It does unless x, y or the normal of the piece is a separating axis.
    """
    half = 0.5 * (pieces[:, None, 2:] - pieces[:, None, :2])
    middle = 0.5 * (pieces[:, None, 2:] + pieces[:, None, :2])
    size = 0.5 * (boxes[..., 2:] - boxes[..., :2])
    away = 0.5 * (boxes[..., 2:] + boxes[..., :2]) - middle
    turned = np.abs(half[..., 0] * away[..., 1] - half[..., 1] * away[..., 0])
    apart = np.any(np.abs(away) > size + np.abs(half), axis=-1)
    apart |= turned > size[..., 0] * np.abs(half[..., 1]) + size[..., 1] * np.abs(half[..., 0])
    return np.asarray(np.any(~apart, axis=1))


def _inside(plates: Array, boxes: Array) -> BoolArray:
    """Whether the middle of a box lies in convex plates (n, s, 4), counter-clockwise, (k, n)."""
    middle = 0.5 * (boxes[..., :2] + boxes[..., 2:])[:, :, None, None, :]  # (k, b, 1, 1, 2)
    side, away = plates[..., 2:] - plates[..., :2], middle - plates[..., :2]
    left = side[..., 0] * away[..., 1] - side[..., 1] * away[..., 0] >= 0
    return np.asarray(np.any(np.all(left, axis=-1), axis=1))
