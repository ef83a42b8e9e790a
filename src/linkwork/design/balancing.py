"""Counterweights that remove the shaking force of a four-bar.

The centre of mass of the moving links stays at rest if the vectors that turn with crank and rocker
vanish (R. S. Berkof, G. G. Lowen 1969, doi:10.1115/1.3591524).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from linkwork.core import motion
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.machine import Mass
from linkwork.design.results import Counterweight, Counterweights
from linkwork.forces.reactions.solving import forces_of_motion


def _weights(linkage: Linkage, radius: float | Mapping[str, float]) -> Iterator[Counterweight]:
    """The counterweights of crank and rocker at a distance from their pins on ground."""
    sides, coupler = _four_bar(linkage)
    # in the frames of their links
    first, second = (
        _local(linkage, link, moving) - _local(linkage, link, fixed)
        for link, fixed, moving in sides
    )
    start, end = (_local(linkage, coupler, moving) for _, _, moving in sides)
    mass, centre, _ = _mass(linkage, coupler)
    share = (centre - start) / (end - start)
    for (link, fixed, _), arm, part in zip(
        sides, (first, second), (1.0 - share, share), strict=True
    ):
        link_mass, place, _ = _mass(linkage, link)
        # eq. (80)
        needed = -(link_mass * (place - _local(linkage, link, fixed)) + mass * part * arm)
        size = abs(needed)
        distance = radius[link] if isinstance(radius, Mapping) else radius
        if not distance > 0.0:
            raise InputError(f'the radius on "{link}" must be positive, got {distance:g}')
        way = needed / size if size else 1.0 + 0j
        at = _local(linkage, link, fixed) + distance * way
        yield Counterweight(
            link=link,
            product=size,
            angle=math.degrees(math.atan2(way.imag, way.real)),
            mass=size / distance,
            place=(at.real, at.imag),
        )


def _balanced(linkage: Linkage, weights: tuple[Counterweight, ...]) -> Linkage:
    """The linkage with its counterweights."""
    masses = dict(linkage.masses)
    for weight in weights:
        link_mass, centre, inertia = _mass(linkage, weight.link)
        total = link_mass + weight.mass
        if not total:
            continue
        place = complex(*weight.place)
        both = (link_mass * centre + weight.mass * place) / total
        inertia += link_mass * abs(centre - both) ** 2 + weight.mass * abs(place - both) ** 2
        masses[weight.link] = Mass(mass=total, center=(both.real, both.imag), inertia=inertia)
    return replace(linkage, masses=masses)


def _shaking(linkage: Linkage) -> tuple[float, float]:
    """The largest shaking force and moment of the masses alone, at the input's speed or 1 rad/s."""
    inputs = tuple(
        each if each.speed is not None or each.law is not None else replace(each, speed="1 rad/s")
        for each in linkage.inputs
    )
    alone = replace(
        linkage, loads=(), springs=(), gravity=None, friction=FrozenDict(), inputs=inputs
    )
    model = motion.model_of(alone)
    forces = forces_of_motion(model, motion.sweep(model, certify=False))
    x, y, moment = (np.asarray(forces[f"shaking.{part}"]) for part in ("x", "y", "moment"))
    return float(np.nanmax(np.hypot(x, y))), float(np.nanmax(np.abs(moment)))


def _four_bar(linkage: Linkage) -> tuple[list[tuple[str, str, str]], str]:
    """Both links on ground with their fixed and moving pins, and the coupler."""
    # loads and springs join no links
    parts = [part for part in linkage.parts if part.kind is not None or part.mobility]
    moving = [link for link in linkage.links if link != GROUND]
    sides = []
    for link in moving:
        others = [other for other in moving if other != link]
        fixed = [p for p in linkage.links[link] if p in linkage.links[GROUND]]
        joined = [p for p in linkage.links[link] if any(p in linkage.links[o] for o in others)]
        if len(fixed) == 1 and len(joined) == 1:
            sides.append((link, fixed[0], joined[0]))
    rest = [link for link in moving if link not in [side[0] for side in sides]]
    if parts or len(moving) != 3 or len(sides) != 2 or len(rest) != 1:
        raise InputError(
            f"{linkage.name} is no four-bar with pins only: the shaking force of other mechanisms "
            "cannot be removed by two counterweights"
        )
    if not linkage.masses:
        raise InputError(f"{linkage.name} has no masses to balance: add [masses]")
    return sides, rest[0]


def _local(linkage: Linkage, link: str, point: str) -> complex:
    """A point in the frame of its link."""
    return complex(linkage.shapes.local[link][point])


def _mass(linkage: Linkage, link: str) -> tuple[float, complex, float]:
    """The mass of a link, its centre in the link's frame, and its inertia about that."""
    stated, numbers = linkage.masses.get(link), linkage.numbers
    if stated is None:
        return 0.0, 0j, 0.0
    mass = numbers(stated.mass)
    if stated.shape is None:
        return mass, complex(*map(numbers, stated.center or (0.0, 0.0))), numbers(stated.inertia)
    first, second = linkage.links[link][:2]
    length = abs(_local(linkage, link, second) - _local(linkage, link, first))
    return mass, complex(length / 2.0), mass * length**2 / 12.0


def counterweights(mechanism: Mechanism, radius: float | Mapping[str, float]) -> Counterweights:
    """The counterweights that remove the shaking force of a four-bar.

    The masses alone shake, at the speed of the input or at 1 rad/s: loads, springs and gravity
    are left out.

    Parameters
    ----------
    radius : number or Mapping[str, number]
        Their distance from the pins on ground [length], by link or for both.

    Raises
    ------
    InputError
        If it is no four-bar with pins and masses, or a radius is not positive.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
    >>> [weight.link for weight in lw.design.counterweights(bar, radius=20).weights]
    ['crank', 'rocker']
    """
    linkage = _linkage(mechanism)
    weights = tuple(_weights(linkage, radius))
    (force, moment), (force_after, moment_after) = (
        _shaking(each) for each in (linkage, _balanced(linkage, weights))
    )
    mass, length, unit = linkage.mass, linkage.length, linkage.force
    return Counterweights(
        weights=weights,
        force=(force, force_after),
        moment=(moment, moment_after),
        units={
            "mass": mass, "product": f"{mass}·{length}", "force": unit,
            "moment": f"{unit}·{length}",
        },
    )  # fmt: skip


def balanced(mechanism: Mechanism, radius: float | Mapping[str, float]) -> Mechanism:
    """A copy whose masses contain the counterweights of :func:`counterweights`.

    Parameters
    ----------
    radius : number or Mapping[str, number]
        As there.

    Raises
    ------
    InputError
        As there.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
    >>> sorted(lw.design.balanced(bar, radius=20).description.masses)
    ['coupler', 'crank', 'rocker']
    """
    linkage = _linkage(mechanism)
    return Mechanism(_balanced(linkage, tuple(_weights(linkage, radius))))


def _linkage(mechanism: Mechanism) -> Linkage:
    if not isinstance(mechanism.description, Linkage):
        raise InputError("counterweights need a mechanism with points and links")
    return mechanism.description
