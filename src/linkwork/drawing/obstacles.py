"""What is drawn already, and what it would cost to cover it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.drawing.box import Box
from linkwork.drawing.scene import Arc, Disc, Hatch, Polygon, Polyline, Primitive, Role, Text
from linkwork.foundation.arrays import Array, BoolArray

__all__ = ["Obstacles"]

#: What it costs to cover a line or disc of a role; covering a pin is worst.
_PENALTY = {
    Role.FRAME: 6.0, Role.WHEEL: 6.0, Role.PITCH: 1.5, Role.MARK: 8.0, Role.BELT: 14.0,
    Role.PLATE: 9.0, Role.HATCH: 6.0, Role.GROUND: 10.0, Role.TRACE: 2.5, Role.SLOT: 12.0,
    Role.SLIDER: 12.0, Role.LINK: 14.0, Role.CYLINDER: 14.0, Role.PIN: 60.0, Role.POINT: 40.0,
    Role.TRACED: 40.0, Role.LIMIT: 40.0, Role.INPUT: 14.0, Role.SPEED_TRACE: 4.0,
    Role.FIXED_CENTRODE: 4.0, Role.MOVING_CENTRODE: 4.0, Role.EXTENSION: 4.0, Role.DIMENSION: 12.0,
    Role.VECTOR: 14.0, Role.VELOCITY: 14.0, Role.ACCELERATION: 14.0, Role.CENTRE: 30.0,
}  # fmt: skip
_INSIDE_PLATE = 1.5
_TEXT = 100.0  # to cover what is written
_OPEN = (Role.FRAME, Role.WHEEL, Role.PITCH)  # discs that names and arrows may stand inside


@dataclass(frozen=True)
class Obstacles:
    """Line pieces (m, 4), discs (d, 3) and plates, with penalties for covering them."""

    pieces: Array
    piece_cost: Array
    discs: Array
    disc_cost: Array
    plates: tuple[Array, ...]

    @classmethod
    def of(cls, drawn: Iterable[Primitive]) -> Obstacles:
        """The obstacles that a drawing is made of."""
        pieces: list[tuple[float, float, float, float]] = []
        piece_cost: list[float] = []
        discs: list[tuple[float, float, float]] = []
        disc_cost: list[float] = []
        plates: list[Array] = []
        for p in drawn:
            found = []
            penalty = _PENALTY.get(p.role, 0.0) * (1.0 - p.fade) ** 2
            if isinstance(p, Disc) and p.role in _OPEN:
                found = list(pairwise(p.rim))
            elif isinstance(p, Disc):
                discs.append((*p.centre, p.radius))
                disc_cost.append(penalty)
            elif isinstance(p, Polyline | Arc):
                found = list(zip(p.points, p.points[1:], strict=False))
            elif isinstance(p, Polygon):
                found = list(zip(p.points, p.points[1:] + p.points[:1], strict=True))
                if p.role is Role.PLATE and not p.fade:
                    plates.append(np.array(p.points))
            elif isinstance(p, Hatch):
                found = list(p.strokes)
            elif isinstance(p, Text):
                found, penalty = list(pairwise(_frame(p.box))), _TEXT
            pieces += [(*a, *b) for a, b in found]
            piece_cost += [penalty] * len(found)
        return cls(
            np.array(pieces).reshape(-1, 4), np.array(piece_cost),
            np.array(discs).reshape(-1, 3), np.array(disc_cost), tuple(plates),
        )  # fmt: skip

    def cost(self, boxes: Sequence[Box]) -> float:
        """The penalty for something that is made of these boxes."""
        covered = np.zeros(len(self.discs), dtype=bool)
        crossed = np.zeros(len(self.pieces), dtype=bool)
        for box in boxes:
            covered |= _covers(self.discs, box)
            crossed |= _crosses(self.pieces, box)
        # A trace of many short pieces counts once per role's penalty, not once per piece.
        values, counts = np.unique(self.piece_cost[crossed], return_counts=True)
        inside = sum(any(_inside(p, box.centre) for box in boxes) for p in self.plates)
        return (
            float(self.disc_cost @ covered)
            + float(values @ (1 + np.log(counts)))
            + _INSIDE_PLATE * inside
        )


def _frame(box: Box) -> list[tuple[float, float]]:
    """The corners of a box, around and back, and across."""
    (left, bottom), (right, top) = box.corners
    around = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)]
    return [*around, (right, top)]


def _covers(discs: Array, box: Box) -> BoolArray:
    """Which discs (d, 3) the box meets, shape (d,)."""
    x, y, r = discs.T
    dx = np.maximum(np.maximum(box.left - x, x - box.right), 0.0)
    dy = np.maximum(np.maximum(box.bottom - y, y - box.top), 0.0)
    return np.asarray(np.hypot(dx, dy) < r * (1 - 1e-9))


def _crosses(pieces: Array, box: Box) -> BoolArray:
    """Which line pieces (m, 4) meet the box, shape (m,): the slab method."""
    start, end = pieces[:, :2], pieces[:, 2:]
    step = end - start
    low = np.array([box.left, box.bottom]) - start
    high = np.array([box.right, box.top]) - start
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = low / step, high / step
    flat = step == 0
    within = (low <= 0) & (high >= 0)
    enter = np.where(flat, np.where(within, -np.inf, np.inf), np.minimum(a, b))
    leave = np.where(flat, np.where(within, np.inf, -np.inf), np.maximum(a, b))
    return np.asarray(
        np.maximum(enter.max(axis=1, initial=0.0), 0.0)
        <= np.minimum(leave.min(axis=1, initial=1.0), 1.0)
    )


def _inside(corners: Array, point: tuple[float, float]) -> bool:
    """Whether a point lies in a convex polygon with counter-clockwise corners (n, 2)."""
    sides = np.roll(corners, -1, axis=0) - corners
    to_point = np.array(point) - corners
    return bool(np.all(sides[:, 0] * to_point[:, 1] - sides[:, 1] * to_point[:, 0] >= 0))
