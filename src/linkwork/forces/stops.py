"""Stops that push: as acts on the bodies, in the rows of a simulated motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from linkwork.forces.free_bodies import Act, FreeBodies
from linkwork.forces.geometry import Geometry
from linkwork.forces.part.guide import line_of
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.names import GROUND
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.results.quantity import Kind

__all__ = ["stop_acts", "stop_efforts", "stop_values", "undetermined_stops"]


def pushes_of(geometry: Geometry) -> Mapping[str, Array]:
    """What stops give in the direction of their quantities, by name, (B,) each."""
    found: Mapping[str, Array] = getattr(geometry.solved, "stop_forces", {})
    return found


def stop_values(geometry: Geometry) -> Iterator[tuple[str, Kind, str, Array]]:
    """Force, or moment, and impulse of every stop where loads move the mechanism: name, kind,
    about, (B,).
    """
    description, named = geometry.model.description, geometry.model.motion_quantities
    free = any(which.law is None for which in description.inputs)
    if geometry.model.untimed is None or not free or not isinstance(description, LoadedBodies):
        return
    shocks: Mapping[str, Array] = getattr(geometry.solved, "stop_impulses", {})
    none = np.zeros(geometry.shape)
    bounded = (named.find(stop.of) for stop in description.stops)
    for asked in {each.name: each for each in bounded}.values():
        angle = asked.own.kind is Kind.ANGLE
        push, shock = (Kind.MOMENT, Kind.TURN) if angle else (Kind.FORCE, Kind.IMPULSE)
        name, about = f"{asked.name}.stop", f"of its stop on {asked.name}"
        yield name, push, f"{push.value} {about}", pushes_of(geometry).get(asked.name, none)
        yield f"{name}.impulse", shock, f"impulse {about}", shocks.get(asked.name, none)


def _unit_acts(bodies: FreeBodies, name: str) -> list[Act] | None:
    """The acts of a unit in the direction of a quantity; ``None`` if it is of several bodies."""
    linkage, geometry = bodies.linkage, bodies.geometry
    none, one = np.zeros(1, dtype=complex), np.ones(1, dtype=complex)
    if name in linkage.links:
        return [Act(bodies.link(name), none, none, 1.0)]
    for slider in linkage.sliders:
        if slider.name == name:
            place, along = geometry.place(slider.points[0]).v, line_of(slider.line, geometry)
            pair = bodies.link(slider.link), bodies.link(slider.on)
            return [Act(pair[0], place, along), Act(pair[1], place, -along)]
    for cylinder in linkage.cylinders:
        if cylinder.name == name:
            along = line_of(cylinder.between, geometry)
            return [
                Act(bodies.at(point), geometry.place(point).v, side * along)
                for point, side in zip(cylinder.between, (-1.0, 1.0), strict=True)
            ]
    point, _, axis = name.rpartition(".")
    if point in linkage.points and axis in ("x", "y"):
        return [Act(bodies.at(point), geometry.place(point).v, one if axis == "x" else 1j * one)]
    return None


def stop_acts(bodies: FreeBodies) -> list[Act]:
    """The acts of all stops that push."""
    return [
        act.times(push)
        for name, push in pushes_of(bodies.geometry).items()
        for act in _unit_acts(bodies, name) or ()
    ]


def stop_efforts(bodies: FreeBodies) -> Array:
    """The efforts of the inputs less what stops give, (p, B)."""
    geometry = bodies.geometry
    total = np.zeros((len(geometry.driven.equations.inputs), geometry.rows))
    for act in stop_acts(bodies):
        body = act.on.body
        if body == GROUND:
            continue
        first = geometry.links[body][0] if body in geometry.links else body
        turning = geometry.turning(body) if body in geometry.links else 0.0
        moved = geometry.partial(first) + 1j * turning * (act.place - geometry.place(first).v)
        total -= (np.conj(act.force) * moved).real + act.moment * turning
    return total


def undetermined_stops(geometry: Geometry, bodies: FreeBodies | None) -> BoolArray:
    """Rows in which a stop pushes whose forces on the bodies are not determined, (B,)."""
    lost = np.zeros(geometry.rows, dtype=bool)
    for name, push in pushes_of(geometry).items():
        if bodies is None or _unit_acts(bodies, name) is None:
            lost |= push != 0.0
        else:
            lost |= np.isnan(push)
    return lost
