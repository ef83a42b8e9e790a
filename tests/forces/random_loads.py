"""Random masses and loads on mechanisms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import linkwork as lw
from linkwork.mechanism.linkage import Linkage

__all__ = ["loaded"]


def loaded(mechanism: lw.Mechanism, seed: int = 0) -> lw.Mechanism:
    """A copy with masses on all links, loads on points and links, gravity and a speed."""
    random = np.random.default_rng(seed)
    given = mechanism.description
    assert isinstance(given, Linkage)
    size = mechanism.model.equations.length_scale
    moving = [link for link in given.links if link != "ground"]
    masses = {}
    for link in moving:
        directed = len(given.links[link]) > 1 or link in given.turning_on_one_point
        x, y = random.normal(size=2) * 0.3 * size * directed
        inertia = random.uniform(0.0, 1.0) * size**2
        masses[link] = lw.Mass(mass=random.uniform(0.5, 2.0), center=(x, y), inertia=inertia)
    fixed = given.links["ground"]
    moved = [point for point in given.points if point not in fixed]
    points = list(random.choice(moved, 3)) if moved else []
    loads = [lw.Load(point=str(p), force=tuple(random.normal(size=2) * 10.0)) for p in points]
    loads.append(lw.Load(link=str(random.choice(moving)), torque=10.0 * size))
    driven = [replace(which, speed=None) for which in given.inputs]
    return mechanism.changed(
        length="mm",
        masses=masses,
        loads=loads,
        gravity=lw.Gravity(),
        inputs=[replace(driven[0], speed=2.0), *driven[1:]],
    )
