"""Efforts of the inputs: torques on driven links, forces along driven guides."""

from __future__ import annotations

from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.part.index import drive_part
from linkwork.foundation.names import GROUND
from linkwork.mechanism.driven_input import Input
from linkwork.results.quantity import Kind

__all__ = ["drive_inputs", "effort_kind", "effort_name"]


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
