"""Free bodies of a mechanism given by loops, where these read as links and joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from linkwork.circuits.classification import as_linkage
from linkwork.circuits.reading_loops import Seen
from linkwork.core.foundation.arrays import Array
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import RowValues
from linkwork.core.results.quantities.definition import Solved
from linkwork.forces.reactions.applied import AppliedLoads
from linkwork.forces.reactions.drives import drive_inputs, join_pins
from linkwork.forces.reactions.free_bodies import Act, FreeBodies
from linkwork.forces.reactions.geometry import Geometry
from linkwork.forces.reactions.parts import join_parts
from linkwork.forces.reactions.switches import stop_acts

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
