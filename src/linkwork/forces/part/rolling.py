"""Reactions of a rolling wheel: a normal force and a grip at the point of contact."""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import FreeBodies, Reading
from linkwork.forces.part.guide import along_line, line_of
from linkwork.foundation.arrays import ComplexArray
from linkwork.mechanism.part.rolling import Rolling
from linkwork.results.quantity import Kind

__all__ = ["drive", "write"]


def write(rolling: Rolling, bodies: FreeBodies) -> None:
    """The force that presses on the wheel, and the grip that keeps it from slipping."""
    place, away, along = _contact(rolling, bodies)
    wheel, on = bodies.link(rolling.wheel), bodies.link(rolling.on)
    normal = bodies.pair(wheel, on, place, away)
    about = f"force that presses {rolling.on} and {rolling.wheel} together"
    bodies.read(f"{rolling.name}.normal", Kind.FORCE, about, normal, pushes=True)
    grip = bodies.pair(wheel, on, place, along)
    about = f"force of {rolling.on} on {rolling.wheel} that keeps it from slipping"
    friction = bodies.friction(rolling.name)
    adhesion = None if friction is None else (normal, bodies.number(friction.mu))
    bodies.readings.append(
        Reading(
            name=f"{rolling.name}.tangent", kind=Kind.FORCE, about=about, terms=((grip, 1.0),),
            adhesion=adhesion,
        )
    )  # fmt: skip


def _contact(
    rolling: Rolling, bodies: FreeBodies
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """The point of contact, the normal towards the wheel, the tangent."""
    geometry, linkage = bodies.geometry, bodies.linkage
    center, small = geometry.place(rolling.center).v, linkage.numbers(rolling.radius)
    if rolling.line is not None:
        along = line_of(rolling.line, geometry)
        away = linkage.side_of(rolling.line, rolling.center) * 1j * along
        return center - small * away, away, along
    assert rolling.circle is not None
    middle, large = geometry.place(rolling.circle).v, linkage.numbers(rolling.circle_radius or 0)
    out = (center - middle) / np.abs(center - middle)
    if not rolling.inside:
        return middle + large * out, out, 1j * out
    side = 1.0 if large > small else -1.0  # the smaller of both is inside the other
    return middle + side * large * out, -out, 1j * out


def drive(rolling: Rolling, bodies: FreeBodies) -> int:
    """The force on the wheel's centre along the line."""
    assert rolling.line is not None
    return along_line(bodies, rolling.center, rolling.on, rolling.line)
