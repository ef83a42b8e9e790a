"""Reaction of a curve: it pushes its pin along its normal."""

from __future__ import annotations

from typing import Any

import numpy as np

from linkwork.equations.outline import Outline
from linkwork.forces.free_bodies import Act, FreeBodies
from linkwork.forces.part.contact import sliding
from linkwork.forces.size import Sided
from linkwork.foundation.arrays import ComplexArray
from linkwork.foundation.elementwise import chained
from linkwork.foundation.lanes import is_batched
from linkwork.kernels.piecewise import Piecewise
from linkwork.mechanism.part.curve import Curve
from linkwork.results.quantity import Kind

__all__ = ["drive", "write"]


def write(curve: Curve, bodies: FreeBodies) -> None:
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


def drive(curve: Curve, bodies: FreeBodies) -> int:
    """The force along the curve for a unit of work per unit of its coordinate."""
    tangent = _tangent(curve, bodies)
    # the coordinate of a curve is no arc length: the force is the work per unit of it
    along = tangent / np.abs(tangent) ** 2
    place = bodies.geometry.place(curve.point).v
    pin, on = bodies.at(curve.point), bodies.link(curve.on)
    return bodies.unknown(Act(pin, place, along), Act(on, place, -along))


def _tangent(curve: Curve, bodies: FreeBodies) -> ComplexArray:
    """The derivative of the curve by its coordinate, (B,)."""
    numbers, geometry = bodies.linkage.numbers, bodies.geometry
    points = [complex(numbers(x), numbers(y)) for x, y in curve.through]
    outline = Outline.through(points, closed=curve.closed)
    u = geometry.own(curve.name).v
    local = _slope(outline.x, u) + 1j * _slope(outline.y, u)
    found: ComplexArray = local * geometry.direction(curve.on).v
    return found


def _slope(law: Piecewise, u: Any) -> Any:
    """The derivative of a coordinate; the next one is known too."""
    _, first, second = law.jet(u.values if is_batched(u) else u)
    return chained(first, second, u)
