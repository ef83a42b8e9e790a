"""Reaction of a weld: a moment beside the force of the pin that its links share."""

from __future__ import annotations

from linkwork.forces.free_bodies import FreeBodies
from linkwork.mechanism.part.weld import Weld
from linkwork.results.quantity import Kind

__all__ = ["write"]


def write(weld: Weld, bodies: FreeBodies) -> None:
    """The moment on the link named later in the file."""
    links = bodies.linkage.links
    earlier, later = sorted(weld.links, key=list(links).index)
    moment, length = bodies.couple(bodies.link(later), bodies.link(earlier)), bodies.geometry.length
    point = next(point for point in links[earlier] if point in links[later])
    stem = point if len(bodies.joined[point]) == 2 else f"{point}.{later}"
    about = f"moment of {earlier} on {later} at their weld"
    bodies.read(f"{stem}.moment", Kind.MOMENT, about, moment, length)
