"""Angle units: radians in computations, the file's unit in files, tables and results."""

from __future__ import annotations

import math
from enum import Enum

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray

__all__ = ["FULL_TURN", "AngleUnit", "within_half_a_turn"]

FULL_TURN = 2.0 * math.pi


def within_half_a_turn(gap: Array, turns: BoolArray) -> Array:
    """Differences (..., N) in which angles are reduced by whole turns to at most half a turn.

    ``turns`` (N,): which of them are angles [rad].
    """
    return np.where(turns, gap - FULL_TURN * np.round(gap / FULL_TURN), gap)


class AngleUnit(Enum):
    """The unit of the angles in files, tables and results; the value is its name in files.

    Internally every angle is in radians.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.AngleUnit("deg") is lw.AngleUnit.DEGREE
    True
    >>> round(lw.AngleUnit.DEGREE.from_radians(1.0471975511965976), 9)
    60.0
    >>> lw.AngleUnit.RADIAN.turn
    6.283185307179586
    """

    DEGREE = "deg"
    RADIAN = "rad"

    @property
    def radians(self) -> float:
        """Radians per unit."""
        return math.pi / 180.0 if self is AngleUnit.DEGREE else 1.0

    def from_radians(self, angle: float) -> float:
        """The angle in this unit, rounded to ten decimals if that gives the same radians.

        ``60°`` becomes 1.047… radians and must come back as 60, not 59.99999999999999.
        """
        value = angle / self.radians
        short = round(value, 10)
        # equal in all bits, so that no result changes when it is read back
        return short if short * self.radians == angle else value

    @property
    def turn(self) -> float:
        """One full turn in this unit."""
        return 360.0 if self is AngleUnit.DEGREE else FULL_TURN

    @property
    def sign(self) -> str:
        """The unit as printed after a number: ``°`` or `` rad``."""
        return "°" if self is AngleUnit.DEGREE else " rad"
