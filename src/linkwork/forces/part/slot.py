"""Reaction of a slot: a force on the pin, normal to the slot."""

from __future__ import annotations

from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.part.guide import across_line, along_line
from linkwork.mechanism.part.slot import Slot
from linkwork.results.quantity import Kind

__all__ = ["drive", "write"]


def write(slot: Slot, bodies: FreeBodies) -> None:
    """The normal force on the pin, positive to the left of the line."""
    force = across_line(bodies, slot.point, slot.on, slot.line)
    about = f"force of the slot on the pin {slot.point}, to the left of its line"
    bodies.read(f"{slot.name}.normal", Kind.FORCE, about, force)


def drive(slot: Slot, bodies: FreeBodies) -> int:
    """The force on the pin along the slot."""
    return along_line(bodies, slot.point, slot.on, slot.line)
