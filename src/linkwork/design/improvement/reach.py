"""How far a point can be from the fixed pivots of a mechanism, whatever its numbers.

A point is joined to a pivot by sides of links, each no longer than the upper bound of its length:
it is never farther away than the shortest such chain.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from linkwork.foundation.names import GROUND
from linkwork.mechanism.description import Description
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.numerics.lane_bounds import Box

__all__ = ["Reach"]

_ROUNDING = 1e-9  # relative


class Reach:
    """The reach of points from fixed pivots, for numbers in a box."""

    def __init__(self, description: Description, numbers: Sequence[VariedNumber], box: Box) -> None:
        self.pivots: dict[str, tuple[complex, float]] = {}
        self.sides: dict[frozenset[str], float] = {}
        if not isinstance(description, Draft):
            return
        most = dict(zip(numbers, box.most, strict=True))
        for key, length in description.lengths.items():
            high = most.get(VariedNumber(key, "lengths", key), description.numbers(length))
            self.sides[frozenset(key.split())] = float(high)
        fixed = {(q.key, q.axis): k for k, q in enumerate(numbers) if q.table == "points"}
        for name in description.links.get(GROUND, ()):
            place = [description.numbers(x) for x in description.points[name]]
            away = np.zeros(2)
            for axis in (0, 1):
                if (name, axis) in fixed:
                    k = fixed[name, axis]
                    away[axis] = np.abs(np.array([box.least[k], box.most[k]]) - place[axis]).max()
            self.pivots[name] = complex(*place), float(np.hypot(*away))

    def missing(self, name: str, place: complex) -> tuple[str, float, float]:
        """A pivot from which a place is out of reach, its distance, and the reach; or ""."""
        for pivot, (centre, moves) in self.pivots.items():
            most = self._chain(pivot, name) + moves
            away = abs(place - centre)
            if away > most * (1.0 + _ROUNDING):
                return pivot, away, most
        return "", 0.0, math.inf

    def _chain(self, start: str, end: str) -> float:
        """The length of the shortest chain of sides (Bellman and Ford)."""
        far = {start: 0.0}
        for _ in range(len(self.sides)):
            for side, length in self.sides.items():
                for one, other in (tuple(side), tuple(side)[::-1]) if len(side) == 2 else ():
                    if one in far and far[one] + length < far.get(other, math.inf):
                        far[other] = far[one] + length
        return far.get(end, math.inf)
