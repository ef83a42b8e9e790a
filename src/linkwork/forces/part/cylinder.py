"""Reaction of a cylinder: it has no mass and pushes along its axis only."""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import Act, FreeBodies, Reading
from linkwork.foundation.arrays import Array
from linkwork.mechanism.part.cylinder import Cylinder
from linkwork.results.quantity import Kind

__all__ = ["drive", "write"]


def write(cylinder: Cylinder, bodies: FreeBodies) -> None:
    """A cylinder that is not driven transmits no force."""
    driven = {which.drives for which in bodies.linkage.inputs}
    if ("cylinder", cylinder.name) not in driven:
        _read_ends(cylinder, bodies, None)


def drive(cylinder: Cylinder, bodies: FreeBodies) -> int:
    """The force that pushes its ends apart."""
    first, second = (bodies.geometry.place(point).v for point in cylinder.between)
    along = (second - first) / np.abs(second - first)
    start, end = map(bodies.at, cylinder.between)
    force = bodies.unknown(Act(end, second, along), Act(start, first, -along))
    _read_ends(cylinder, bodies, force)
    return force


def _read_ends(cylinder: Cylinder, bodies: FreeBodies, force: int | None) -> None:
    """The forces of the pins on the cylinder."""
    first, second = (bodies.geometry.place(point).v for point in cylinder.between)
    along = (second - first) / np.abs(second - first)
    for point, sign in zip(cylinder.between, (1.0, -1.0), strict=True):
        names = bodies.carriers[point]
        stem = f"{point}.force" if len(names) < 3 else f"{point}.force.{cylinder.name}"
        # the force on the link named later is read: on the other one it is the opposite
        if len(names) < 2 or (len(names) == 2 and names[-1] != cylinder.name):
            continue
        parts: dict[str, Array] = {"x": along.real, "y": along.imag}
        for axis, part in parts.items():
            about = f"force of the pin {point} on {cylinder.name}"
            bodies.readings.append(
                Reading(
                    name=f"{stem}.{axis}",
                    kind=Kind.FORCE,
                    about=about,
                    terms=() if force is None else ((force, sign * part),),
                )
            )
