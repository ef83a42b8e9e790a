"""Reaction of a cam: it pushes its follower along the normal at the point of contact."""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import FreeBodies, Holder
from linkwork.forces.part.contact import moving_most, normal_away, of_input, sliding
from linkwork.forces.part.guide import line_of
from linkwork.forces.size import Sided
from linkwork.foundation.arrays import ComplexArray
from linkwork.mechanism.part.cam import Cam
from linkwork.mechanism.part.guide import guide_named
from linkwork.mechanism.part.slider import Slider
from linkwork.results.quantity import Kind

__all__ = ["write"]


def write(cam: Cam, bodies: FreeBodies) -> None:
    """The normal force on the follower, positive away from the cam."""
    guide = guide_named(bodies.linkage, cam.slider)
    point = cam.point if guide is None else guide.point_on_line
    assert point is not None
    if isinstance(guide, Slider):
        follower = bodies.link(guide.link)
    else:
        follower = bodies.at(point) if guide is not None else bodies.link(str(cam.link))
    place, normal = (
        _on_face(cam, bodies, follower, point) if cam.contact == "flat" else _at(cam, bodies, point)
    )
    push = bodies.pair(follower, bodies.link(cam.cam), place, normal)
    about = f"force of the cam on {follower.body}"
    bodies.read(f"{cam.name}.normal", Kind.FORCE, about, push, pushes=True)
    friction = bodies.friction(cam.name)
    if friction is not None:
        mu = bodies.number(friction.mu)
        size = Sided(unknowns=(push,), plus=mu, minus=mu)
        rates = _sliding(cam, bodies, follower, point, place)
        pair = follower, bodies.link(cam.cam)
        bodies.rub_force(cam.name, size, pair, place, -1j * normal, rates)


def _sliding(
    cam: Cam, bodies: FreeBodies, follower: Holder, point: str, place: ComplexArray
) -> ComplexArray:
    """The velocity of the follower on the cam at their contact, per unit of each input, (p, B)."""
    geometry = bodies.geometry
    rates = sliding(geometry, point, cam.cam, cam.center)
    # a face turns about its point; the contact is elsewhere on it
    turning = geometry.turning(follower.body) - geometry.turning(cam.cam)
    found: ComplexArray = rates + 1j * turning * (place - geometry.place(point).v)
    return found


def _at(cam: Cam, bodies: FreeBodies, point: str) -> tuple[ComplexArray, ComplexArray]:
    """The knife edge or the roller's centre, and the normal of its path on the cam."""
    geometry = bodies.geometry
    rates = sliding(geometry, point, cam.cam, cam.center)
    along = of_input(rates, moving_most(rates))
    place = geometry.place(point).v
    return place, normal_away(along, place - geometry.place(cam.center).v)


def _on_face(
    cam: Cam, bodies: FreeBodies, follower: Holder, point: str
) -> tuple[ComplexArray, ComplexArray]:
    """The point of a flat face at which it only slides on the cam, and the face's normal."""
    geometry = bodies.geometry
    guide = guide_named(bodies.linkage, cam.slider)
    if guide is not None:
        base, face = point, 1j * line_of(guide.line, geometry)
    else:
        assert cam.pivot is not None
        base, face = cam.pivot, line_of((cam.pivot, point), geometry)
    place = geometry.place(base).v
    normal = normal_away(face, place - geometry.place(cam.center).v)
    turning = geometry.turning(follower.body) - geometry.turning(cam.cam)
    most = moving_most(turning)
    rates = of_input(sliding(geometry, base, cam.cam, cam.center), most)
    # the rate of the base less that by which the follower turns it: n · (v + i ω s t) = 0
    spin = of_input(turning, most)
    with np.errstate(all="ignore"):
        way = -(normal.conj() * rates).real / (normal.conj() * 1j * spin * face).real
    return place + way * face, normal
