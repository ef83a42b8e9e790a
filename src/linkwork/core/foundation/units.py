"""Units of length and angle."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from enum import Enum
from fractions import Fraction
from math import pi, ulp

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray

# ----------------------------------------------------------------------
# Units of lengths, angles, masses and forces, and conversion between them.


#: Metres per unit.
LENGTHS = {
    "mm": Fraction(1, 1000), "cm": Fraction(1, 100), "dm": Fraction(1, 10), "m": Fraction(1),
    "km": Fraction(1000), "in": Fraction(254, 10_000), "ft": Fraction(3048, 10_000),
    "µm": Fraction(1, 1_000_000), "inch": Fraction(254, 10_000), '"': Fraction(254, 10_000),
    "um": Fraction(1, 1_000_000), "yd": Fraction(9144, 10_000),
}  # fmt: skip
#: Degrees per unit.
ANGLES = {
    "deg": Fraction(1), "°": Fraction(1), "rad": Fraction(180.0) / Fraction(pi),
    "turn": Fraction(360),
}  # fmt: skip
#: Kilograms per unit.
MASSES = {
    "kg": Fraction(1), "g": Fraction(1, 1000), "t": Fraction(1000),
    "lb": Fraction("0.45359237"), "slug": Fraction("4.4482216152605") / Fraction("0.3048"),
}  # fmt: skip
#: Newtons per unit.
FORCES = {"N": Fraction(1), "kN": Fraction(1000), "lbf": Fraction("4.4482216152605")}

_DIGITS = 14
_ROUNDING = 2  # units in the last place, so that a conversion back gives the same number


def conversion(unit: str, other: str) -> Fraction | None:
    """The factor from a unit to another of its kind; ``None`` if one of them has no known size."""
    if unit == other:
        return Fraction(1)
    # the micro sign and the Greek letter are one unit
    unit, other = (name.replace("\u03bc", "µ") for name in (unit, other))
    for table in (LENGTHS, ANGLES):
        if unit in table and other in table:
            return table[unit] / table[other]
    return None


def force_of_inertia(mass: str, length: str, force: str) -> float:
    """The unit mass · length / s² in the unit of force: kg mm/s² is 0.001 N."""
    return float(MASSES[mass] * LENGTHS[length.replace("\u03bc", "µ")] / FORCES[force])


def converted(number: float, factor: Fraction | float) -> float:
    """A number times a factor; a number of few digits if it is as near as rounding allows.

    Examples
    --------
    >>> converted(3, conversion("in", "mm")), converted(76.2, conversion("mm", "in"))
    (76.2, 3.0)
    """
    exact = float(Fraction(repr(number)) * Fraction(factor))
    short = float(f"{exact:.{_DIGITS}g}")
    return short if abs(short - exact) <= _ROUNDING * ulp(exact) else exact


def split_unit(text: str, units: Iterable[str]) -> tuple[str, str] | None:
    """The amount and the unit at the end of a text, such as "1/2 in"; ``None`` without a unit.

    Examples
    --------
    >>> split_unit("1/2 in", LENGTHS), split_unit("9.81 m/s^2", LENGTHS)
    (('1/2', 'in'), None)
    """
    for unit in sorted(units, key=len, reverse=True):
        amount = text.rstrip().removesuffix(unit)
        # a name may end with the letters of a unit: "main" is not "ma in"
        if unit and amount != text.rstrip() and re.search(r"[\d.)\s]$", amount):
            return amount.strip(), unit
    return None


# ----------------------------------------------------------------------
# Angle units: radians in computations, the file's unit in files, tables and results.


FULL_TURN = 2.0 * math.pi
# 2π in three parts; products of the first two with 26-bit numbers are exact
_PARTS_OF_A_TURN = tuple(
    map(float.fromhex, ("0x1.921fb5p+2", "0x1.110b46p-24", "0x1.1a62633145c06p-52"))
)
_HALF_A_MANTISSA = 2.0**26


def within_half_a_turn(gap: Array, turns: BoolArray) -> Array:
    """Differences (..., N) in which angles are reduced by whole turns to at most half a turn.

    ``turns`` (N,): which of them are angles [rad].
    """
    return np.where(turns, gap - FULL_TURN * np.round(gap / FULL_TURN), gap)


def least_arc(angles: Array, turn: float = FULL_TURN) -> tuple[float, float]:
    """The begin and the extent of the least arc that contains angles (N,), up to whole turns.

    Angles in one turn without a gap of half a turn begin at the smallest one.
    """
    every = np.sort(np.mod(angles - angles[0], turn))
    gaps = np.diff(every, append=every[0] + turn)
    last = int(gaps.argmax())
    begin = every[(last + 1) % len(every)] + angles[0]
    return float(begin), float(turn - gaps[last])


def arc_in_order(angles: Array, turn: float = FULL_TURN) -> tuple[float, float]:
    """The begin and the extent of the arc through angles (N,) in their order, in the sense in which
    it is less than a turn; the least arc if there is none.
    """
    steps = np.diff(angles)
    forward, backward = float(np.mod(steps, turn).sum()), float(np.mod(-steps, turn).sum())
    if min(forward, backward) >= turn:
        return least_arc(angles, turn)
    begin = float(angles[0])
    return (begin, forward) if forward <= backward else (begin - backward, backward)


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

    def without_turns(self, angles: Array, turns: Array) -> Array:
        """Angles (B,) less whole numbers of turns (B,), correct to the rounding of the result.

        2π is no float: a million rounded turns would move an angle by 2e-10 rad.
        """
        if self is AngleUnit.DEGREE:
            return angles - self.turn * turns
        lower = np.fmod(turns, _HALF_A_MANTISSA)
        for part in _PARTS_OF_A_TURN:
            angles = (angles - (turns - lower) * part) - lower * part
        return angles

    @property
    def sign(self) -> str:
        """The unit as printed after a number, ``°`` or `` rad``."""
        return "°" if self is AngleUnit.DEGREE else " rad"
