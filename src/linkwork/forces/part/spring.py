"""Forces of springs and dampers."""

from __future__ import annotations

from typing import Any

import numpy as np

from linkwork.forces.free_bodies import FreeBodies, Reading
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.spring import Spring
from linkwork.results.quantity import Kind

__all__ = ["wound_angle", "write"]


def write(spring: Spring, bodies: FreeBodies) -> None:
    """Its tension between two points, or its torque between two links."""
    if not spring.pulls:
        return
    if spring.between is not None:
        _pull(spring, spring.between, bodies)
    elif spring.links is not None:
        _wind(spring, spring.links, bodies)


def _pull(spring: Spring, between: tuple[str, str], bodies: FreeBodies) -> None:
    applied, numbers = bodies.applied, bodies.geometry.numbers
    start, end = map(bodies.geometry.place, between)
    span = end - start
    length = np.abs(span.v) * applied.passed.get(spring.name, 1.0)
    with np.errstate(all="ignore"):
        # a spring of no length has no direction
        along: Any = np.where(length == 0.0, 0.0, span.v / length)
        rate = (along.conj() * span.d1).real
    tension = _force(spring, bodies, length - numbers(spring.free), rate)
    pull = tension * along
    applied.push(between[0], pull)
    applied.push(between[1], -pull)
    about = "tension of the spring and its damper"
    name = f"{spring.name}.tension"
    bodies.readings.append(
        Reading(name=name, kind=Kind.FORCE, about=about, terms=(), constant=tension)
    )


def _wind(spring: Spring, links: tuple[str, str], bodies: FreeBodies) -> None:
    linkage, geometry, applied = bodies.linkage, bodies.geometry, bodies.applied
    first, second = map(geometry.angle, links)
    turn = second - first
    torque = _force(spring, bodies, turn.v - wound_angle(spring, linkage), turn.d1)
    applied.turn(links[0], torque)
    applied.turn(links[1], -torque)
    about = f"torque of the spring on {links[0]}, and against it on {links[1]}"
    name = f"{spring.name}.torque"
    bodies.readings.append(
        Reading(name=name, kind=Kind.MOMENT, about=about, terms=(), constant=torque)
    )


def wound_angle(spring: Spring, linkage: Linkage) -> float:
    """The angle [rad] from the first link to the second of an unloaded torsion spring.

    The sketch is within half a turn of it; from there windings count.
    """
    assert spring.links is not None
    free = linkage.numbers(spring.free) * linkage.angle.radians
    first, second = map(linkage.sketched_angle, spring.links)
    return free + FULL_TURN * round((second - first - free) / FULL_TURN)


def _force(spring: Spring, bodies: FreeBodies, stretch: Array, rate: Array) -> Array:
    """Stiffness times stretch and damping times its rate; the energy of the spring is noted."""
    numbers, applied = bodies.geometry.numbers, bodies.applied
    stiffness, damping = numbers(spring.stiffness), numbers(spring.damping)
    speed = rate * applied.rate if applied.moves else np.zeros(bodies.geometry.shape)
    applied.stored.append(0.5 * stiffness * stretch**2)
    applied.stored_rates.append(stiffness * stretch * speed)
    found: Array = stiffness * stretch + damping * speed
    return found
