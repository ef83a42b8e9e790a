"""Parts with teeth, whose force is inclined by the pressure angle."""

from __future__ import annotations

import math
from dataclasses import dataclass

from linkwork.foundation.file_keys import Key, Number as NumberKey
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.part.part import NamedPart, PartChecks

__all__ = ["PRESSURE_KEY", "ToothedPart"]

_USUAL = math.radians(20.0)  # ISO 53
_STEEPEST = math.radians(45.0)

PRESSURE_KEY = Key(
    "pressure_angle",
    NumberKey("angle"),
    "Pressure angle of the teeth, for forces; default 20 degrees",
)


@dataclass(frozen=True, kw_only=True)
class ToothedPart(NamedPart):
    """A pair of teeth in mesh; forces need its ``pressure_angle`` [file's angle unit]."""

    pressure_angle: Number | None = None

    @property
    def friction_sizes(self) -> tuple[str, ...]:
        return ("radius",)

    def pressure(self, linkage: Bodies) -> float:
        """The angle between the force of a tooth and the pitch line [rad]."""
        if self.pressure_angle is None:
            return _USUAL
        return linkage.numbers(self.pressure_angle) * linkage.angle.radians

    def check_pressure(self, checks: PartChecks) -> None:
        """Report a pressure angle that no teeth have."""
        if self.pressure_angle is None:
            return
        angle = checks.number(self.pressure_angle, "pressure_angle")
        if not 0.0 <= angle * checks.linkage.angle.radians <= _STEEPEST:
            most = checks.linkage.angle.from_radians(_STEEPEST)
            checks.add(f"must be from 0 to {most:g}, got {angle:g}", "pressure_angle")
