"""Reaction of a slot: a force on the pin, normal to the slot."""

from __future__ import annotations

from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.part.guide import across_line, along_line, rub_on_line
from linkwork.forces.size import Sided
from linkwork.mechanism.part.slot import Slot
from linkwork.results.quantity import Kind

__all__ = ["drive", "write"]


def write(slot: Slot, bodies: FreeBodies) -> None:
    """The normal force on the pin, positive to the left of the line."""
    force = across_line(bodies, slot.point, slot.on, slot.line)
    about = f"force of the slot on the pin {slot.point}, to the left of its line"
    bodies.read(f"{slot.name}.normal", Kind.FORCE, about, force)
    friction = bodies.friction(slot.name)
    if friction is not None:
        mu = bodies.number(friction.mu)
        size = Sided(unknowns=(force,), plus=mu, minus=mu)
        pair = bodies.at(slot.point), bodies.link(slot.on)
        rub_on_line(slot.name, bodies, size, pair, slot.point, slot.line)


def drive(slot: Slot, bodies: FreeBodies) -> int:
    """The force on the pin along the slot."""
    return along_line(bodies, slot.point, slot.on, slot.line)
