"""Axis-parallel rectangles in the plane."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

__all__ = ["XY", "Box"]

#: A point of the plane in the mechanism's length unit.
XY = tuple[float, float]


@dataclass(frozen=True)
class Box:
    """The rectangle from (left, bottom) to (right, top), in the mechanism's length unit."""

    left: float
    bottom: float
    right: float
    top: float

    @classmethod
    def around(cls, points: Iterable[XY]) -> Box:
        """The smallest box around all points, at least one."""
        xs, ys = zip(*points, strict=True)
        return cls(min(xs), min(ys), max(xs), max(ys))

    @property
    def width(self) -> float:
        return self.right - self.left

    @property
    def height(self) -> float:
        return self.top - self.bottom

    @property
    def centre(self) -> XY:
        return (self.left + self.right) / 2, (self.bottom + self.top) / 2

    @property
    def corners(self) -> tuple[XY, XY]:
        return (self.left, self.bottom), (self.right, self.top)

    @property
    def edges(self) -> tuple[float, float, float, float]:
        """Left, bottom, right, top."""
        return self.left, self.bottom, self.right, self.top

    def grown(self, by: float) -> Box:
        """The box enlarged by ``by`` on every side."""
        return Box(self.left - by, self.bottom - by, self.right + by, self.top + by)

    def with_box(self, other: Box) -> Box:
        """The smallest box around both."""
        return Box.around((*self.corners, *other.corners))

    def distance(self, point: XY) -> float:
        """The distance of a point from the box; zero inside."""
        x, y = point
        return math.hypot(
            max(self.left - x, 0.0, x - self.right), max(self.bottom - y, 0.0, y - self.top)
        )
