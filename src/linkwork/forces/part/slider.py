"""Reactions of a slider: a force normal to its line and a moment."""

from __future__ import annotations

from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.part.guide import line_of, rub_on_line
from linkwork.forces.size import LargerOf, Sided, Size
from linkwork.mechanism.part.slider import Slider
from linkwork.results.quantity import Kind

__all__ = ["drive", "write"]


def write(slider: Slider, bodies: FreeBodies) -> None:
    """The normal force at the slider's first point, positive to the left, and the moment."""
    place = bodies.geometry.place(slider.points[0]).v
    link, on = bodies.link(slider.link), bodies.link(slider.on)
    force = bodies.pair(link, on, place, 1j * line_of(slider.line, bodies.geometry))
    about = f"force of {slider.on} on {slider.link} at {slider.points[0]}, to the left of its line"
    bodies.read(f"{slider.name}.normal", Kind.FORCE, about, force)
    # a slider transmits a moment: its link cannot turn on the other
    moment, length = bodies.couple(link, on), bodies.geometry.length
    about = f"moment of {slider.on} on {slider.link} about {slider.points[0]}"
    bodies.read(f"{slider.name}.moment", Kind.MOMENT, about, moment, length)
    friction = bodies.friction(slider.name)
    if friction is None:
        return
    mu = bodies.number(friction.mu)
    size: Size = Sided(unknowns=(force,), plus=mu, minus=mu)
    if friction.length is not None:
        # both ends push: N/2 ± M/l, together N, or 2 M/l where they push opposite ways
        factors = (mu, 2.0 * mu * length / bodies.number(friction.length))
        size = LargerOf(unknowns=(force, moment), factors=factors)
    rub_on_line(slider.name, bodies, size, (link, on), slider.points[0], slider.line)


def drive(slider: Slider, bodies: FreeBodies) -> int:
    """The force along the line at the slider's first point."""
    place = bodies.geometry.place(slider.points[0]).v
    along = line_of(slider.line, bodies.geometry)
    return bodies.pair(bodies.link(slider.link), bodies.link(slider.on), place, along)
