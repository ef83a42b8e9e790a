"""Reactions of teeth: a force along the pitch line, and one that pushes the wheels apart.

The force of a tooth acts at the pitch point along the line of action, which is inclined to the
pitch line by the pressure angle, and pushes whatever side it turns to.
"""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import Act, FreeBodies, Holder, Reading
from linkwork.forces.size import Sided
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.results.quantity import Kind

__all__ = ["mesh"]


def mesh(
    name: str, bodies: FreeBodies, links: tuple[str, str], place: ComplexArray,
    away: ComplexArray, pressure: float, slope: Array | float = 0.0,
) -> None:  # fmt: skip
    """Add the force of the first link's teeth on the second's.

    Parameters
    ----------
    place : (B,)
        The pitch point.
    away : (B,)
        The unit vector from the first link's material to the second's, along the line of centres.
    pressure : float
        The pressure angle [rad].
    slope : (B,)
        The angle from the normal of the line of centres to the common tangent of the pitch curves.
    """
    first, second = map(bodies.link, links)
    along = bodies.pair(second, first, place, 1j * away)
    about = f"force of {links[0]} on {links[1]} across the line of centres"
    bodies.read(f"{name}.tangent", Kind.FORCE, about, along)
    acts = _pair(second, first, place, away)
    plus, minus = (_separating(side, pressure, slope) for side in (1.0, -1.0))
    apart = bodies.follow(Sided(unknowns=(along,), plus=plus, minus=minus), *acts)
    about = f"force of {links[0]} on {links[1]} along the line of centres"
    radial = f"{name}.radial"
    bodies.readings.append(
        Reading(name=radial, kind=Kind.FORCE, about=about, terms=(), follow=apart)
    )
    friction = bodies.friction(name)
    if friction is not None:
        # teeth slide at their distance from the pitch point times the relative speed of rotation
        arm = bodies.number(friction.mu) * bodies.number(friction.radius)
        size = Sided(
            unknowns=(along,), plus=arm * np.hypot(1.0, plus), minus=arm * np.hypot(1.0, minus)
        )
        bodies.rub_couple(name, size, second, first)


def _pair(on: Holder, against: Holder, place: ComplexArray, way: ComplexArray) -> tuple[Act, Act]:
    return Act(on, place, way), Act(against, place, -way)


def _separating(side: float, pressure: float, slope: Array | float) -> Array:
    """The force along the line of centres for a unit across it to one side.

    A tooth pushes along ± t + n tan α, t the common tangent and n its normal.
    """
    # eq. (74): p, the direction of the push in the frame of the line of centres
    push = (side * 1j + np.tan(pressure)) * np.exp(1j * slope)
    found: Array = side * push.real / push.imag
    return found
