"""Reactions of non-circular gears: forces at their pitch point, which moves."""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.part.teeth import mesh
from linkwork.mechanism.part.noncircular_gear import NoncircularGear

__all__ = ["write"]


def write(gear: NoncircularGear, bodies: FreeBodies) -> None:
    """The tooth force at the pitch radius r = -ψ' d / (1 - ψ'), eq. (68)."""
    geometry = bodies.geometry
    first, second = (geometry.place(center).v for center in gear.centers)
    distance = np.abs(second - first)
    along = (second - first) / distance
    arm = geometry.angle(gear.arm)
    phi, psi = (geometry.angle(wheel) - arm for wheel in gear.wheels)
    with np.errstate(all="ignore"):
        slope = psi.d1 / phi.d1
        bend = (psi.d2 - slope * phi.d2) / phi.d1**2
        radius = -slope * distance / (1.0 - slope)
        # r'(φ), and the tangent of the first pitch curve, which turns by -φ below the pitch point
        change = -bend * distance / (1.0 - slope) ** 2
        tangent = np.arctan2(change, radius)
    place = first + radius * along
    pressure = gear.pressure(bodies.linkage)
    mesh(gear.name, bodies, gear.wheels, place, along, pressure, tangent)
