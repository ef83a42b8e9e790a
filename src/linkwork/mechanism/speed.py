"""The speed of an input: ``"300 rpm"``, ``"25 rad/s"``, ``"50 mm/s"``, or a bare number."""

from __future__ import annotations

import math

from linkwork.foundation.errors import ExpressionError
from linkwork.mechanism.dimensions import Number, Numbers

__all__ = ["speed_per_second", "split_speed"]

_ANGULAR = {"rpm": math.tau / 60.0, "rad/s": 1.0, "deg/s": math.pi / 180.0}  # [rad/s]


def speed_per_second(speed: Number, kind: str, numbers: Numbers, length: str) -> float:
    """The speed in the mechanism's unit per second.

    Parameters
    ----------
    speed : number or str
        A number or formula, optionally with a unit.
    kind : str
        The driven kind: ``slider`` and ``cylinder`` have a linear speed, ``link`` and ``joint`` an
        angular one, ``variable`` either.
    numbers : Numbers
        The dimensions, and the unit of angles.
    length : str
        The unit of lengths; nothing is converted.

    Raises
    ------
    ExpressionError
        If the number cannot be read, or the unit does not fit the driven quantity.
    """
    if not isinstance(speed, str):
        return numbers(speed)
    if (split := split_speed(speed, kind, length)) is not None:
        amount, unit = split
        return numbers(amount) * (
            _ANGULAR[unit] / numbers.unit.radians if unit in _ANGULAR else 1.0
        )
    try:
        return numbers(speed.rstrip())
    except ExpressionError:
        known = ", ".join(_units(kind, length))
        raise ExpressionError(
            f'must be a number and a unit ({known}), got "{speed[:40]}"', speed, 1
        ) from None


def split_speed(speed: str, kind: str, length: str) -> tuple[str, str] | None:
    """The amount and the unit of a speed; ``None`` without a unit. Parameters as above."""
    text = speed.rstrip()
    for unit in sorted(_units(kind, length), key=len, reverse=True):
        amount = text[: -len(unit)]
        # rpm is also written RPM
        if text[-len(unit) :].lower() == unit.lower() and not amount[-1:].isalpha():
            return amount, unit
    return None


def _units(kind: str, length: str) -> list[str]:
    """The units of a driven kind's speed."""
    angular = [] if kind in ("slider", "cylinder") else list(_ANGULAR)
    linear = [] if kind in ("link", "joint") else [f"{length}/s"]
    return angular + linear
