"""Reactions of a belt: the tensions of its two strands."""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import Act, FreeBodies, Reading
from linkwork.forces.size import Sided
from linkwork.foundation.arrays import ComplexArray
from linkwork.mechanism.part.belt import Belt
from linkwork.results.quantity import Kind

__all__ = ["write"]


def write(belt: Belt, bodies: FreeBodies) -> None:
    """Half of the pull in one strand and against it in the other, and the tension of both."""
    wheels = tuple(map(bodies.link, belt.wheels))
    strands = []
    for side in (1.0, -1.0):
        start, end = _strand(belt, bodies, side)
        way = (end - start) / np.abs(end - start)
        strands.append((Act(wheels[0], start, way), Act(wheels[1], end, -way)))
    left, right = strands
    pull = bodies.unknown(*(act.times(0.5) for act in left), *(act.times(-0.5) for act in right))
    given = None if belt.pretension is None else bodies.linkage.numbers(belt.pretension)
    # without pretension the slack strand has none
    half = 0.5 if given is None else 0.0
    size = Sided(unknowns=(pull,), plus=half, minus=half, constant=given or 0.0)
    both = bodies.follow(size, *left, *right)
    for number, own in ((1, 0.5), (2, -0.5)):
        about = f"tension of the strand {'left' if number == 1 else 'right'} of the centres"
        name = f"{belt.name}.tension{number}"
        reading = Reading(
            name=name, kind=Kind.FORCE, about=about, terms=((pull, own),), follow=both, pushes=True
        )
        bodies.readings.append(reading)


def _strand(belt: Belt, bodies: FreeBodies, side: float) -> tuple[ComplexArray, ComplexArray]:
    """The tangent points of a strand on both wheels."""
    first, second = (bodies.geometry.place(center).v for center in belt.centers)
    small, large = belt.pitch_radii(bodies.linkage)
    # the strands of a crossed belt touch the second wheel on its other side
    large = -large if belt.crossed else large
    distance = np.abs(second - first)
    cosine = (small - large) / distance
    out = (second - first) / distance * (cosine + side * 1j * np.sqrt(1.0 - cosine**2))
    return first + small * out, second + large * out
