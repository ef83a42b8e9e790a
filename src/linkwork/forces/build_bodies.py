"""The bodies of a mechanism with all that acts on them: its links, or those read from loops."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from linkwork.forces.applied import AppliedLoads
from linkwork.forces.drives import drive_inputs
from linkwork.forces.free_bodies import Act, FreeBodies
from linkwork.forces.geometry import Geometry
from linkwork.forces.part.index import join_parts
from linkwork.forces.pins import join_pins
from linkwork.forces.read_bodies import read_geometry
from linkwork.forces.stops import stop_acts
from linkwork.mechanism.linkage import Linkage
from linkwork.motion.model import Model
from linkwork.results.quantities.definition import Solved

__all__ = ["free_bodies", "free_bodies_of", "known_acts", "read_bodies", "set_down"]


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
