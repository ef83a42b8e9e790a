"""Random masses, loads, springs and friction on mechanisms."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.loops import Loops

__all__ = ["loaded", "rubbed", "sprung"]


def loaded(mechanism: lw.Mechanism, seed: int = 0) -> lw.Mechanism:
    """A copy with masses on all links, loads on points and links, gravity and a speed."""
    random = np.random.default_rng(seed)
    given = mechanism.description
    assert isinstance(given, Linkage | Loops)
    size = mechanism.model.equations.length_scale
    moving = [link for link in given.links if link != "ground"]
    turning = given.turning_on_one_point
    if isinstance(given, Loops):  # a link of one point has no direction there
        moving = [link for link in moving if len(given.links[link]) > 1]
    masses = {}
    for link in moving:
        directed = len(given.links[link]) > 1 or link in turning
        x, y = random.normal(size=2) * 0.3 * size * directed
        inertia = random.uniform(0.0, 1.0) * size**2
        masses[link] = lw.Mass(mass=random.uniform(0.5, 2.0), center=(x, y), inertia=inertia)
    fixed = given.links.get("ground", ())
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


def sprung(mechanism: lw.Mechanism, seed: int = 0) -> lw.Mechanism:
    """A copy with a spring between two points, one between two links, and loads that are formulas
    of the input and the time.
    """
    random = np.random.default_rng(seed)
    given = mechanism.description
    assert isinstance(given, Linkage)
    size = mechanism.model.equations.length_scale
    points = [str(p) for p in random.permutation(list(given.points))]
    links = [str(link) for link in random.permutation(list(given.links))]
    k, free, damping = random.uniform(0.1, 1.0, size=3)
    # between two points of one link it would do nothing
    joined = [frozenset(on) for on in given.links.values()]
    apart = [pair for pair in combinations(points, 2) if not any(on >= {*pair} for on in joined)]
    pulls = [
        lw.Spring(name="pull", between=ends, stiffness=k / size, free=free * size, damping=damping)
        for ends in apart[:1]
    ]
    turning = [link for link in links if len(given.links[link]) > 1 or link == "ground"]
    if len(turning) > 1:
        pair = (turning[0], turning[1])
        pulls.append(
            lw.Spring(name="wind", links=pair, stiffness=k * size, free=10, damping=damping * size)
        )
    which = mechanism.model.equations.inputs[0].name
    load = lw.Load(point=points[-1], force=(f"3*sin({which}) - 2*(t > 40)", "cos(t) - 4"))
    return mechanism.changed(springs=[*given.springs, *pulls], loads=[*given.loads, load])


def rubbed(mechanism: lw.Mechanism, mu: float) -> lw.Mechanism:
    """A copy with friction in every joint that can have it."""
    given = mechanism.description
    assert isinstance(given, Linkage)
    size = mechanism.model.equations.length_scale
    friction: dict[str, lw.Friction] = {}
    for point in given.points:
        if len(list(given.bodies_at(point))) > 1:
            friction[point] = lw.Friction(mu=mu, radius=0.02 * size)
    for part in given.parts:
        sizes = part.friction_sizes
        if part.names and sizes is not None:
            kept = {"radius": 0.01 * size} if "radius" in sizes else {}
            friction[part.label] = lw.Friction(mu=mu, **kept)
    return mechanism.changed(friction=friction)
