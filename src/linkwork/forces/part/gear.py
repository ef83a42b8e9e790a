"""Reactions of a gear pair: forces at its pitch point."""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.part.teeth import mesh
from linkwork.mechanism.part.gear import Gear

__all__ = ["write"]


def write(gear: Gear, bodies: FreeBodies) -> None:
    """The tooth force on the line of centres at the pitch radii."""
    first, second = (bodies.geometry.place(center).v for center in gear.centers)
    along = (second - first) / np.abs(second - first)
    small, large = gear.pitch_radii(bodies.linkage)
    inside = gear.internal and small < large  # the first wheel is inside the second
    place = first - small * along if inside else first + small * along
    # a pinion in a ring pushes outwards, from the centres to the pitch point
    away = -along if gear.internal else along
    mesh(gear.name, bodies, gear.wheels, place, away, gear.pressure(bodies.linkage))
