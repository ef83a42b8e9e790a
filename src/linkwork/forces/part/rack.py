"""Reactions of a rack and pinion: forces at the pitch point."""

from __future__ import annotations

from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.part.guide import line_of
from linkwork.forces.part.teeth import mesh
from linkwork.mechanism.part.rack import Rack

__all__ = ["write"]


def write(rack: Rack, bodies: FreeBodies) -> None:
    """The tooth force where the pitch circle touches the pitch line of the rack."""
    linkage, geometry = bodies.linkage, bodies.geometry
    slider = rack.guide(linkage)
    assert slider is not None
    # from the pinion to the rack
    side = linkage.side_of(slider.line, rack.center)
    away = -side * 1j * line_of(slider.line, geometry)
    place = geometry.place(rack.center).v + linkage.numbers(rack.radius) * away
    links = (rack.pinion, slider.link)
    mesh(rack.name, bodies, links, place, away, rack.pressure(linkage))
