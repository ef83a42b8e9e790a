"""Given forces and torques."""

from __future__ import annotations

from linkwork.forces.applied import AppliedLoads
from linkwork.forces.free_bodies import FreeBodies
from linkwork.mechanism.part.load import Load

__all__ = ["apply_load", "write"]


def write(load: Load, bodies: FreeBodies) -> None:
    """A load has no reaction of its own."""
    apply_load(load, bodies.applied)


def apply_load(load: Load, applied: AppliedLoads) -> None:
    """The force or torque in all rows."""
    if load.torque is not None:
        assert load.link is not None
        applied.turn(load.link, applied.value(load.torque))
        return
    assert load.point is not None
    x, y = map(applied.value, load.force or ())
    force = x + 1j * y
    if load.turns_with is not None:
        force = force * applied.geometry.direction(load.turns_with).v
    applied.push(load.point, force, load.link)
