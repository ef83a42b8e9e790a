"""Named quantities with units: how a column of numbers is called and measured."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from linkwork.foundation.angles import AngleUnit

__all__ = ["Kind", "Quantity", "Units"]


class Kind(Enum):
    """What a number measures."""

    ANGLE = "angle"
    LENGTH = "length"
    NUMBER = "number"


@dataclass(frozen=True)
class Units:
    """The units of one mechanism: everyday values and rates."""

    angle: AngleUnit
    length: str

    def of(self, kind: Kind) -> str:
        """Unit of a value: ``deg``, ``mm`` or nothing."""
        return {Kind.ANGLE: self.angle.value, Kind.LENGTH: self.length}.get(kind, "")

    def of_rate(self, kind: Kind) -> str:
        """Unit in which a derivative counts the quantity: radians, lengths."""
        return {Kind.ANGLE: "rad", Kind.LENGTH: self.length}.get(kind, "1")

    def scale(self, kind: Kind) -> float:
        """Internal units (radians) per everyday unit."""
        return self.angle.radians if kind is Kind.ANGLE else 1.0


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A named scalar of the mechanism."""

    name: str
    kind: Kind
