"""Reactions of teeth: a force along the pitch line, and one that pushes the wheels apart.

The force of a tooth acts at the pitch point along the line of action, which is inclined to the
pitch line by the pressure angle, and pushes whatever side it turns to.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from linkwork.forces.free_bodies import Act, FreeBodies, Holder, Reading
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
    apart = bodies.follow(along, partial(_separating, pressure=pressure, slope=slope), *acts)
    about = f"force of {links[0]} on {links[1]} along the line of centres"
    radial = f"{name}.radial"
    bodies.readings.append(
        Reading(name=radial, kind=Kind.FORCE, about=about, terms=(), follow=apart)
    )


def _pair(on: Holder, against: Holder, place: ComplexArray, way: ComplexArray) -> tuple[Act, Act]:
    return Act(on, place, way), Act(against, place, -way)


def _separating(tangent: Array, *, pressure: float, slope: Array | float) -> Array:
    """The force along the line of centres that belongs to the one across it.

    A tooth pushes along ± t + n tan α, t the common tangent and n its normal.
    """
    side = np.sign(tangent)
    # eq. (74): p, the direction of the push in the frame of the line of centres
    push = (side * 1j + np.tan(pressure)) * np.exp(1j * np.asarray(slope))
    found: Array = np.where(side == 0.0, 0.0, tangent * push.real / push.imag)
    return found
