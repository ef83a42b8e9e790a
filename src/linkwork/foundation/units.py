"""Units of lengths, angles, masses and forces, and conversion between them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from fractions import Fraction
from math import pi, ulp

__all__ = [
    "ANGLES", "FORCES", "LENGTHS", "MASSES", "conversion", "converted", "force_of_inertia",
    "split_unit",
]  # fmt: skip

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
