"""Known units of length, mass and force, and their conversion."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["FORCES", "LENGTHS", "MASSES", "force_of_inertia"]

_POUND, _FOOT, _POUND_FORCE = 0.45359237, 0.3048, 4.4482216152605

#: Known units, in metres, kilograms and newtons.
LENGTHS: Mapping[str, float] = {
    "mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "µm": 1e-6,
    "in": _FOOT / 12.0, "inch": _FOOT / 12.0, "ft": _FOOT,
}  # fmt: skip
MASSES: Mapping[str, float] = {
    "kg": 1.0, "g": 1e-3, "t": 1e3, "lb": _POUND, "slug": _POUND_FORCE / _FOOT,
}  # fmt: skip
FORCES: Mapping[str, float] = {"N": 1.0, "kN": 1e3, "lbf": _POUND_FORCE}


def force_of_inertia(mass: str, length: str, force: str) -> float:
    """The unit mass · length / s² in the unit of force: kg mm/s² is 0.001 N."""
    return MASSES[mass] * LENGTHS[length] / FORCES[force]
