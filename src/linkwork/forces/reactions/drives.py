"""Efforts of the inputs: torques on driven links, forces along driven guides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkwork.circuits.classification import as_linkage
from linkwork.circuits.reading_loops import Seen
from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import RowValues
from linkwork.core.results.quantities.definition import Solved
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.coupling import NormOf
from linkwork.forces.reactions.free_bodies import Act, FreeBodies, Holder, Reading
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry, virtual_work
from linkwork.forces.reactions.parts import drive_part, join_parts
from linkwork.forces.reactions.switches import stop_acts


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


# ----------------------------------------------------------------------
# Free bodies of a mechanism given by loops, where these read as links and joints.


_APART = 1e-9  # of the longest link: distance of the points of both descriptions


def read_geometry(geometry: Geometry) -> Geometry | None:
    """The rows of a mechanism's loops as those of a linkage.

    ``None`` if the loops do not read as one, or its points move otherwise.
    """
    seen = as_linkage(geometry.driven)
    if not isinstance(seen, Seen) or seen.loose:
        return None
    v = _rows(geometry, seen)
    solver, rate = seen.model.compiled.solver, geometry.input_rates
    bend = np.zeros(len(rate))
    if geometry.model is not geometry.driven:
        rate, bend = rate.T, geometry.input_bends.T
    rates = solver.rates(v, rate, input_bend=bend)
    found = np.asarray(np.isfinite(v).all(axis=1), dtype=bool)
    own = Geometry(seen.model, RowValues(seen.model, v, rates.first, rates.second, found))
    shared = [point for point in geometry.points if point in own.points]
    for point in shared:
        place = geometry.place(point)
        # at dead points, which have no forces, Newton-Raphson is less precise
        apart = np.where(np.isfinite(place.d1), np.abs(place.v - own.place(point).v), 0.0)
        if np.nanmax(apart, initial=0.0) > _APART * geometry.length:
            return None
    return own


def _rows(geometry: Geometry, seen: Seen) -> Array:
    """The variables of the linkage in all rows: angles turn as those of the loops."""
    model, other = geometry.driven, seen.model.equations
    names = [variable.name for variable in model.equations.variables]
    here = geometry.variables
    solver = model.compiled.solver
    start = solver.solve(model.equations.start[None, :]).v[0]
    v = np.tile(other.start, (geometry.rows, 1))
    # directions are sums of the loops' angles; lengths follow by Newton-Raphson
    for k, variable in enumerate(other.unknowns):
        for own in seen.turning.get(variable.name, ()):
            v[:, k] += here[:, names.index(own)] - start[names.index(own)]
    count = len(other.unknowns)
    for k in range(len(other.inputs)):
        own_input = len(model.equations.unknowns) + k
        v[:, count + k] += here[:, own_input] - start[own_input]
    lost = ~np.isfinite(here).all(axis=1)
    solved = seen.model.compiled.solver.solve(v[~lost])
    v[lost] = np.nan
    v[~lost] = np.where((solved.failed_block < 0)[:, None], solved.v, np.nan)
    return v


# ----------------------------------------------------------------------
# The bodies of a mechanism with all that acts on them: its links, or those read from loops.


def free_bodies(linkage: Linkage, geometry: Geometry, applied: AppliedLoads) -> FreeBodies:
    """The links with the reactions of all joints, loads and springs."""
    bodies = FreeBodies(linkage, geometry, applied)
    join_pins(bodies)
    join_parts(bodies)
    drive_inputs(bodies)
    return bodies


def free_bodies_of(model: Model, solved: Solved) -> FreeBodies:
    """The free bodies of a linkage at solved positions, with all loads."""
    description = model.description
    assert isinstance(description, Linkage)
    geometry = Geometry(model, solved)
    applied = AppliedLoads(geometry, model.speed or 0.0)
    applied.weigh(description)
    return free_bodies(description, geometry, applied)


def read_bodies(geometry: Geometry, applied: AppliedLoads) -> FreeBodies | None:
    """The free bodies of loops that read as a linkage with everything that is loaded."""
    own = read_geometry(geometry)
    if own is None:
        return None
    linkage = own.model.description
    assert isinstance(linkage, Linkage)
    loads = set_down(applied, linkage)
    return None if loads is None else free_bodies(linkage, own, loads)


def set_down(applied: AppliedLoads, linkage: Linkage) -> AppliedLoads | None:
    """The loads on loops as loads on the links read from them; ``None`` if some have none."""
    given = applied.geometry.links
    own = {link: _same_link(link, points, given, linkage) for link, points in given.items()}
    masses = [replace(body, link=own[body.link]) for body in applied.masses]
    torques = [(own[link], torque) for link, torque in applied.torques]
    forces = []
    for point, force, link in applied.forces:
        carrier = None if link is None else own[link]
        if carrier is None and point not in linkage.points:
            # only pins are points of what was read: the link of the file that carries it
            carrier = next((own[name] for name, on in given.items() if point in on), "")
        forces.append((point, force, carrier))
    carriers = [*(body.link for body in masses), *(link for link, _ in torques)]
    carriers += [link for _, _, link in forces if link is not None]
    if not all(carriers):
        return None
    return replace(applied, masses=masses, torques=torques, forces=forces)


def _same_link(
    link: str, points: tuple[str, ...], given: Mapping[str, tuple[str, ...]], linkage: Linkage
) -> str:
    """The name of a link of loops in the linkage that was read from them; "" if it is not there."""
    if link in linkage.links:
        return link
    # a block has one point, and another name if the file has a link of that name
    blocks = [
        name for name, on in linkage.links.items() if name not in given and tuple(on) == points
    ]
    return blocks[0] if len(points) == len(blocks) == 1 else ""


def known_acts(bodies: FreeBodies) -> list[Act]:
    """Everything that acts on the bodies and is known."""
    geometry, applied = bodies.geometry, bodies.applied
    acts = [
        Act(bodies.link(link) if link else bodies.at(point), applied.geometry.place(point).v, force)
        for point, force, link in applied.forces
    ]
    none = np.zeros(geometry.rows, dtype=complex)
    acts += [Act(bodies.link(link), none, none, torque) for link, torque in applied.torques]
    acts += [
        Act(bodies.link(body.link), body.place, body.force, body.torque) for body in applied.masses
    ]
    return [*acts, *stop_acts(bodies)]
