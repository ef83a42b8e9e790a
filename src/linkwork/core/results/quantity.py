"""Named quantities with their units."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import UnknownNameError
from linkwork.core.foundation.names import as_name
from linkwork.core.foundation.units import AngleUnit


class Kind(Enum):
    """What a number measures."""

    ANGLE = "angle"
    LENGTH = "length"
    PER_LENGTH = "per length"
    NUMBER = "number"
    TIME = "time"
    FORCE = "force"
    MOMENT = "moment"
    ENERGY = "energy"
    POWER = "power"
    IMPULSE = "impulse"
    TURN = "angular impulse"


_OF_FORCE = (Kind.FORCE, Kind.MOMENT, Kind.ENERGY, Kind.POWER, Kind.IMPULSE, Kind.TURN)


@dataclass(frozen=True)
class Units:
    """The units of one mechanism: values in file units and rates."""

    angle: AngleUnit
    length: str
    force: str = "N"

    def of(self, kind: Kind) -> str:
        """Unit of a value: ``deg``, ``mm``, ``1/mm``, ``N``, ``N·mm`` or nothing."""
        if kind in _OF_FORCE:
            work = f"{self.force}·{self.length}"
            others = {
                Kind.FORCE: self.force, Kind.POWER: f"{work}/s", Kind.IMPULSE: f"{self.force}·s",
                Kind.TURN: f"{work}·s",
            }  # fmt: skip
            return others.get(kind, work)
        if kind is Kind.TIME:
            return "s"
        return self.angle.value if kind is Kind.ANGLE else self._of_length(kind)

    def of_rate(self, kind: Kind) -> str:
        """The unit of the quantity in derivatives: radians or lengths."""
        return {Kind.ANGLE: "rad", Kind.NUMBER: "1", Kind.TIME: "s"}.get(kind) or self._of_length(
            kind
        )

    def _of_length(self, kind: Kind) -> str:
        if kind is Kind.LENGTH or not self.length:
            return self.length
        return f"1/{self.length}" if kind is Kind.PER_LENGTH else ""

    def scale(self, kind: Kind) -> float:
        """Internal units (radians) per file unit."""
        return self.angle.radians if kind is Kind.ANGLE else 1.0


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A named scalar of the mechanism."""

    name: str
    kind: Kind


class Rate(Enum):
    """A rate of a quantity: ``B.x.d1`` and ``B.x.d2`` are derivatives with respect to the leading
    input, ``B.x.velocity``, ``B.x.acceleration``, ``B.x.jerk`` and ``B.x.snap`` those with respect
    to time.

    Angles are in radians.
    """

    FIRST = "d1"
    SECOND = "d2"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    JERK = "jerk"
    SNAP = "snap"

    @classmethod
    def split(cls, name: str) -> tuple[str, Rate | None]:
        """The quantity's name and the rate that a name contains; ``None`` if it has no rate."""
        own, _, last = as_name(name).rpartition(".")
        rate = next((rate for rate in cls if own and rate.value == last), None)
        return (name, None) if rate is None else (own, rate)

    @property
    def order(self) -> int:
        """The order of the derivative, 1 to 4."""
        higher = {Rate.JERK: 3, Rate.SNAP: 4}
        return 1 if self in (Rate.FIRST, Rate.VELOCITY) else higher.get(self, 2)

    @property
    def needs_series(self) -> bool:
        """Whether it is beyond the two derivatives that all positions have."""
        return self.order > 2

    @property
    def by_time(self) -> bool:
        """Whether the input needs a speed."""
        return self not in (Rate.FIRST, Rate.SECOND)

    @property
    def measure(self) -> str:
        """The rate as a word for labels."""
        ordinal = "first" if self.order == 1 else "second"
        return self.value if self.by_time else f"{ordinal} derivative"

    def check(self, name: str, speed: Array | float | None) -> None:
        """Raise an error for a time derivative if the input has no speed.

        Raises
        ------
        UnknownNameError
            With the name of the derivative with respect to the input.
        """
        if self.by_time and speed is None:
            by_input = Rate.FIRST if self.order == 1 else Rate.SECOND
            if self.needs_series:
                raise UnknownNameError(
                    f'"{name}.{self.value}" needs the speed of the input: set speed in [input]'
                )
            raise UnknownNameError(
                f'"{name}.{self.value}" needs the speed of the input: set speed in [input], or '
                f'use "{name}.{by_input.value}", the derivative with respect to the input'
            )

    def of(self, first: Array, second: Array, speed: Array | float | None) -> Array:
        """The rate, from both derivatives with respect to the input and the input's speed."""
        derivative = first if self.order == 1 else second
        if not self.by_time:
            return derivative
        assert speed is not None
        found: Array = derivative * np.asarray(speed) ** self.order  # eq. (13)
        return found

    def unit(self, kind: Kind, units: Units, by: str) -> str:
        """The unit of the rate; ``by`` is the unit of the input in derivatives."""
        power = "" if self.order == 1 else f"^{self.order}"
        return f"{units.of_rate(kind)}/{'s' if self.by_time else by}{power}"
