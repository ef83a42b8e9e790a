"""The sizes of symbols: fractions of the drawn size, smaller where pins stand close together."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from linkwork.drawing.box import Box

__all__ = ["COINCIDENT", "Measures"]

#: Relative to the size of a drawing, or to its longest vector: places as near as this are one.
#: Rounding moves solved places far less, and a reader sees no difference below 1e-4.
COINCIDENT = 1e-6

_PIN_OF_SIZE = 0.0115  # pin radius over drawn size: 10 points of diameter on a six-inch figure
_SMALLEST_OF_SIZE = 0.0055  # below this a pin is no longer seen as a circle
_PIN_OF_GAP = 0.22  # pin radius over the distance of its nearest neighbour


@dataclass(frozen=True, kw_only=True)
class Measures:
    """Lengths of a drawing, all in the mechanism's length unit.

    Parameters
    ----------
    size : float
        The larger side of what is drawn.
    pin : float
        The radius of a pin; every other symbol is a multiple of it.
    larger : float
        How much larger than usual names are, for small pictures; symbols grow by its root.
    """

    size: float
    pin: float
    larger: float = 1.0

    @classmethod
    def of(cls, box: Box, gaps: Iterable[float], larger: float = 1.0) -> Measures:
        """Measures for what fills a box, with gaps between pins that do not change in the motion.

        A mechanism of a single point counts as one unit long.
        """
        size = max(box.width, box.height) or 1.0
        # points at the same place have no gap
        shortest = min((gap for gap in gaps if gap > 1e-6 * size), default=size)
        least, most = (
            share * size * math.sqrt(larger) for share in (_SMALLEST_OF_SIZE, _PIN_OF_SIZE)
        )
        return cls(size=size, pin=min(most, max(_PIN_OF_GAP * shortest, least)), larger=larger)

    @property
    def stroke(self) -> float:
        """The width of a thin line; roles count their line widths in it."""
        return 0.22 * self.pin

    @property
    def dot(self) -> float:
        """The radius of a point that is no pin."""
        return 0.5 * self.pin

    @property
    def text(self) -> float:
        """The font size (one em) of names: readable however small the pins are."""
        return 0.0275 * self.larger * self.size

    @property
    def block(self) -> tuple[float, float]:
        """Half length and half height of a sliding block."""
        return 3.0 * self.pin, 1.9 * self.pin

    @property
    def slot(self) -> float:
        """Half the width of a slot: a pin and some play."""
        return 1.55 * self.pin

    @property
    def barrel(self) -> float:
        """Half the width of a cylinder."""
        return 1.7 * self.pin

    @property
    def hatch(self) -> float:
        """The depth of hatching, and the distance of its strokes along the line."""
        return 1.4 * self.pin

    @property
    def head(self) -> float:
        """The length of an arrow head."""
        return 2.2 * self.pin
