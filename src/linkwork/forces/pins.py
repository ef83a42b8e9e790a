"""Forces in pins: each link at a point is acted on by the pin there, which is in equilibrium."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.forces.free_bodies import Act, FreeBodies, Holder, Reading
from linkwork.forces.size import NormOf
from linkwork.results.quantity import Kind

__all__ = ["join_pins", "read_first_links"]


def join_pins(bodies: FreeBodies) -> None:
    """Add the forces between all links that share a point.

    The first link at a point takes what acts on the pin: loads, guides, cylinders; the others act
    on it through the pin.
    """
    for point, links in bodies.joined.items():
        # a pin of one link transmits no force
        if len(links) < 2:
            continue
        place = bodies.geometry.place(point).v
        for other in links[1:]:
            forces = []
            for axis, unit in (("x", 1.0 + 0j), ("y", 1j)):
                along = np.array([unit])
                force = bodies.pair(Holder(other), Holder(links[0], point), place, along)
                forces.append(force)
                for name in _names(bodies, point, other, axis):
                    about = f"force of the pin {point} on {other}"
                    reading = Reading(
                        name=name, kind=Kind.FORCE, about=about, terms=((force, 1.0),),
                        pin=(point, other, links[0]),
                    )  # fmt: skip
                    bodies.readings.append(reading)
            _rub_pin(bodies, point, other, links[0], (forces[0], forces[1]))


def _rub_pin(bodies: FreeBodies, point: str, link: str, first: str, force: tuple[int, int]) -> None:
    """Friction of a link on the pin, which is fixed in the first link."""
    friction = bodies.friction(point)
    if friction is None:
        return
    arm = bodies.number(friction.mu) * bodies.number(friction.radius)
    name = point if len(bodies.carriers[point]) < 3 else f"{point}.{link}"
    bodies.rub_couple(name, NormOf(unknowns=force, factor=arm), Holder(link), Holder(first))


def _names(bodies: FreeBodies, point: str, link: str, axis: str) -> list[str]:
    """What a force on a link at a pin is called."""
    names = bodies.carriers[point]
    if len(names) > 2:
        return [f"{point}.force.{link}.{axis}"]
    return [f"{point}.force.{axis}"] if link == names[-1] else []


def read_first_links(bodies: FreeBodies, known: Sequence[Act]) -> None:
    """Name the force on the first link at every pin of three: the sum of what it takes."""
    for point, links in bodies.joined.items():
        if len(bodies.carriers[point]) < 3 or not links:
            continue
        # loads, guides and cylinders act on the pin, and so on its first link
        given = bodies.through(point, known)
        forces = [(k, bodies.through(point, acts)) for k, acts in enumerate(bodies.unknowns)]
        for axis, part in (("x", np.real), ("y", np.imag)):
            bodies.readings.append(
                Reading(
                    name=f"{point}.force.{links[0]}.{axis}",
                    kind=Kind.FORCE,
                    about=f"force of the pin {point} on {links[0]}",
                    terms=tuple((k, part(force)) for k, force in forces if np.any(force)),
                    constant=part(given),
                    pin=(point, links[0], ""),
                )
            )
