"""Reactions of cams, curves and non-circular gears."""

from __future__ import annotations

from typing import Any

import numpy as np

from linkwork.contacts.cams import Cam
from linkwork.contacts.curves import Curve, NoncircularGear, coordinates
from linkwork.contacts.profiles import Outline
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.lanes import chained, is_batched
from linkwork.core.mechanism.part.guides import Slider, guide_named
from linkwork.core.results.quantity import Kind
from linkwork.core.table.rows import Piecewise
from linkwork.forces.reactions.coupling import Sided
from linkwork.forces.reactions.free_bodies import Act, FreeBodies, Holder
from linkwork.forces.reactions.parts import (
    acts_along,
    join_part,
    line_of,
    mesh,
    moving_most,
    normal_away,
    of_input,
    sliding,
)

# ----------------------------------------------------------------------
# Reaction of a cam: it pushes its follower along the normal at the point of contact.


@join_part.register
def join_cam(cam: Cam, bodies: FreeBodies) -> None:
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


# ----------------------------------------------------------------------
# Reaction of a curve: it pushes its pin along its normal.


@join_part.register
def join_curve(curve: Curve, bodies: FreeBodies) -> None:
    """The normal force on the pin, positive to the left of the curve."""
    tangent = _tangent(curve, bodies)
    place = bodies.geometry.place(curve.point).v
    normal = 1j * tangent / np.abs(tangent)
    pair = bodies.at(curve.point), bodies.link(curve.on)
    force = bodies.pair(*pair, place, normal)
    about = f"force of the curve on the pin {curve.point}, to its left"
    bodies.read(f"{curve.name}.normal", Kind.FORCE, about, force)
    friction = bodies.friction(curve.name)
    if friction is not None:
        mu = bodies.number(friction.mu)
        size = Sided(unknowns=(force,), plus=mu, minus=mu)
        rates = sliding(bodies.geometry, curve.point, curve.on, curve.origin)
        bodies.rub_force(curve.name, size, pair, place, -1j * normal, rates)


@acts_along.register
def along_curve(curve: Curve, bodies: FreeBodies) -> tuple[Act, ...]:
    """The force along the curve for a unit of work per unit of its coordinate."""
    tangent = _tangent(curve, bodies)
    # the coordinate of a curve is no arc length: the force is the work per unit of it
    along = tangent / np.abs(tangent) ** 2
    place = bodies.geometry.place(curve.point).v
    pin, on = bodies.at(curve.point), bodies.link(curve.on)
    return Act(pin, place, along), Act(on, place, -along)


def _tangent(curve: Curve, bodies: FreeBodies) -> ComplexArray:
    """The derivative of the curve by its coordinate, (B,)."""
    geometry = bodies.geometry
    outline = Outline.through(coordinates(curve.through, bodies.linkage), closed=curve.closed)
    u = geometry.own(curve.name).v
    local = _slope(outline.x, u) + 1j * _slope(outline.y, u)
    found: ComplexArray = local * geometry.direction(curve.on).v
    return found


def _slope(law: Piecewise, u: Any) -> Any:
    """The derivative of a coordinate; the next one is known too."""
    _, first, second = law.jet(u.values if is_batched(u) else u)
    return chained(first, second, u)


# ----------------------------------------------------------------------
# Reactions of non-circular gears: forces at their pitch point, which moves.


@join_part.register
def join_noncircular_gear(gear: NoncircularGear, bodies: FreeBodies) -> None:
    """The tooth force at the pitch radius r = -ψ' d / (1 - ψ'), eq. (68)."""
    geometry = bodies.geometry
    first, second = (geometry.place(center).v for center in gear.centers)
    distance = np.abs(second - first)
    along = (second - first) / distance
    arm = geometry.angle(gear.arm)
    phi, psi = (geometry.angle(wheel) - arm for wheel in gear.wheels)
    with np.errstate(all="ignore"):
        slope = psi.d1 / phi.d1
        bend = (psi.d2 - slope * phi.d2) / phi.d1**2
        radius = -slope * distance / (1.0 - slope)
        # r'(φ), and the tangent of the first pitch curve, which turns by -φ below the pitch point
        change = -bend * distance / (1.0 - slope) ** 2
        tangent = np.arctan2(change, radius)
    place = first + radius * along
    pressure = gear.pressure(bodies.linkage)
    mesh(gear.name, bodies, gear.wheels, place, along, pressure, tangent)
