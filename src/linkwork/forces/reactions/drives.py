"""Efforts of the inputs: torques on driven links, forces along driven guides."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.inputs import Input
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.applied import AppliedLoads, virtual_work
from linkwork.forces.reactions.coupling import NormOf
from linkwork.forces.reactions.free_bodies import Act, FreeBodies, Holder, Reading
from linkwork.forces.reactions.parts import drive_part


def drive_inputs(bodies: FreeBodies) -> None:
    """Add the effort of every input, in the order of the inputs."""
    for which in bodies.linkage.inputs:
        kind, name = which.drives
        if kind in ("slider", "cylinder"):
            column, factor = drive_part(bodies, name), 1.0
        else:
            link, against = _links(bodies, which)
            column = bodies.couple(bodies.link(link), bodies.link(against))
            factor = bodies.geometry.length
        effort = effort_kind(bodies.geometry.kind(which.column))
        about = f"effort of the input {which.column}"
        bodies.read(effort_name(which.column), effort, about, column, factor)


def _links(bodies: FreeBodies, which: Input) -> tuple[str, str]:
    """The driven link and the one against which it is driven."""
    kind, name = which.drives
    if kind == "link":
        return name, which.relative_to or GROUND
    # as the equations drive it: the later link, or the one that is not ground
    against, link = bodies.linkage.bodies_at(name)
    return (against, link) if link == GROUND else (link, against)


def effort_name(column: str) -> str:
    """The name of an input's effort."""
    return f"{column}.effort"


def effort_kind(kind: Kind) -> Kind:
    """What the effort of an input measures."""
    return Kind.FORCE if kind is Kind.LENGTH else Kind.MOMENT


# ----------------------------------------------------------------------
# Efforts of the inputs by virtual work.


def efforts(applied: AppliedLoads) -> tuple[Array, Array]:
    """The effort of every input and the size of the largest term of its sum, (p, B) each.

    The size of a term is that of its two factors: where a force is normal to the motion, rounding
    errors are relative to it.
    """
    geometry = applied.geometry
    shape = (len(geometry.driven.equations.inputs), geometry.rows)
    total, largest = np.zeros(shape), np.zeros(shape)
    for load, moved in work_terms(applied):
        # eq. (71)
        total -= (np.conj(load) * moved).real
        largest = np.maximum(largest, np.abs(load) * np.abs(moved))
    return total, largest


def work_terms(applied: AppliedLoads) -> Iterator[tuple[AnyArray, AnyArray]]:
    """Every load (B,), and what it moves per unit of every input, (p, B)."""
    geometry = applied.geometry
    for point, force, _ in applied.forces:
        yield force, geometry.partial(point)
    for link, torque in applied.torques:
        yield torque, geometry.turning(link)
    for body in applied.masses:
        yield body.force, geometry.partial_local(body.link, body.centre)
        yield body.torque, geometry.turning(body.link)


def energies(applied: AppliedLoads) -> dict[str, Array]:
    """Energies, and the power of all loads that store none, (B,) each."""
    geometry, rate = applied.geometry, applied.rate
    zero = np.zeros(geometry.shape)
    found = {
        "kinetic_energy": sum(applied.kinetic, zero),
        "stored_energy": sum(applied.stored, zero),
    }
    pushed = sum((virtual_work(*pair) for pair in applied.moving(geometry)), zero)
    weights = sum((body.weight_rate for body in applied.masses), zero)
    moving = sum((body.kinetic_rate for body in applied.masses), zero)
    stored = sum(applied.stored_rates, zero)
    found["load_power"] = pushed * rate + weights + stored
    found["energy_rate"] = moving + stored
    return found


# ----------------------------------------------------------------------
# Forces in pins: each link at a point is acted on by the pin there, which is in equilibrium.


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
                    bodies.read(name, Kind.FORCE, about, force, pin=(point, other, links[0]))
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
