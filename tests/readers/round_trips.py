"""Mechanisms written for another program and read back: their motions, compared point by point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import LENGTHS
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.results.motion import Motion
from linkwork.readers.importing import read_foreign, write_foreign
from linkwork.writers.robot.files import robot_of

__all__ = ["RoundTrip", "robot_round_trip", "round_trip"]

_STEP = 12  # degrees


@dataclass(frozen=True)
class RoundTrip:
    """The largest distance of a point from itself [of the size], and the rows compared."""

    difference: float
    rows: int
    points: int


def round_trip(name: str, form: str) -> RoundTrip | str:
    """Compare a library mechanism with what comes back; a text says why there is no comparison."""
    linkage = lw.example(name).description
    if not isinstance(linkage, Linkage):
        return "given by equations"
    mechanism = lw.Mechanism(_short(linkage))
    places = start_places(mechanism)
    try:
        made = write_foreign(linkage, places, form)
    except InputError as error:
        return f"refused: {error}"
    if form == "pmks":
        # the link has thousandths: this is what it describes
        mechanism, places = _rounded(linkage, places)
    back = read_foreign(made.text.encode(), f"{name}.txt").description
    return compared(mechanism, places, back)


def robot_round_trip(name: str) -> RoundTrip | str:
    """The same for MJCF, whose lengths are metres."""
    linkage = lw.example(name).description
    if not isinstance(linkage, Linkage):
        return "given by equations"
    mechanism = lw.Mechanism(_short(linkage))
    try:
        text = robot_of(mechanism.model, mechanism.solve(), None, Path("x.mjcf"))
    except InputError as error:
        return f"refused: {error}"
    reading = read_foreign(text.encode(), "x.mjcf")
    if any("coupling of joints" in left.what for left in reading.left_out):
        return "not compared: couplings are left out"
    metre = float(LENGTHS[linkage.length])
    return compared(mechanism, start_places(mechanism), reading.description, metre)


def start_places(mechanism: lw.Mechanism) -> dict[str, complex]:
    """The points in the start position."""
    found = mechanism.solve(throw=True).points
    return {name: complex(*place) for name, place in found.items()}


def _short(linkage: Linkage) -> Linkage:
    """The linkage with few rows."""
    if len(linkage.inputs) != 1 or linkage.inputs[0].law is not None:
        return linkage
    rows = lw.Mechanism(linkage).description.rows(linkage.inputs[0])
    start, stop = float(rows[0]), float(rows[-1])
    return linkage.with_range(start, stop, (stop - start) / 30.0 or None)


def _rounded(
    linkage: Linkage, places: Mapping[str, complex]
) -> tuple[lw.Mechanism, dict[str, complex]]:
    own = {n: complex(round(p.real, 3), round(p.imag, 3)) for n, p in places.items()}
    points = {name: (place.real, place.imag) for name, place in own.items()}
    measured = replace(_short(linkage), points=points, lengths={}, angles={})
    return lw.Mechanism(measured), own


def compared(
    mechanism: lw.Mechanism, places: Mapping[str, complex], back: Linkage, scale: float = 1.0
) -> RoundTrip | str:
    """The motions of a mechanism and of what was read, with the inputs of the first.

    ``scale``: units of the second per unit of the first.
    """
    linkage = mechanism.description
    assert isinstance(linkage, Linkage)
    other = _drive(back, linkage, places)
    if isinstance(other, str):
        return other
    same = _same_points(places, start_places(other), scale)
    one, two = mechanism.sweep(), other.sweep()
    if len(one.found) != len(two.found) or (one.found != two.found).any():
        return f"WRONG: {int(one.found.sum())} rows are {int(two.found.sum())}"
    size = max(abs(a - b) for a in places.values() for b in places.values())
    away = [_distance(one, p, two, q, scale) / size for p, q in same.items()]
    return RoundTrip(max(away), int(one.found.sum()), len(same))


def _distance(one: Motion, p: str, two: Motion, q: str, scale: float) -> float:
    gaps = np.abs(one.place(p).v - two.place(q).v / scale)[one.found]
    return float(gaps.max(initial=0.0))


def _same_points(
    places: Mapping[str, complex], back: Mapping[str, complex], scale: float
) -> dict[str, str]:
    """Points by name, otherwise by their place at the start."""
    found = {}
    for name, place in places.items():
        near = [q for q in back if abs(back[q] / scale - place) <= 1e-6 * (1.0 + abs(place))]
        if name in near or len(near) == 1:
            found[name] = name if name in near else near[0]
    return found


def _drive(back: Linkage, linkage: Linkage, places: Mapping[str, complex]) -> lw.Mechanism | str:
    """The second mechanism with the inputs of the first, whose angles may count from elsewhere."""
    inputs = []
    for which in linkage.inputs:
        kind, name = which.drives
        if kind != "link" or name not in back.links or which.law is not None:
            return f"not compared: driven by {kind} {name}"
        offset = _direction(back, name, None) - _direction(linkage, name, places)
        if which.relative_to not in (None, GROUND):
            if which.relative_to not in back.links:
                return f"not compared: {which.relative_to} is another link there"
            offset -= _direction(back, str(which.relative_to), None)
            offset += _direction(linkage, str(which.relative_to), places)
        rows = linkage.rows(which)
        shift = (
            np.rad2deg(offset) / (linkage.angle.turn / 360.0)
            if linkage.angle.value == "deg"
            else offset
        )
        start, stop = float(rows[0]) + shift, float(rows[-1]) + shift
        step = (stop - start) / max(len(rows) - 1, 1) or None
        factor = 1.0 if linkage.angle.value == "deg" else 180.0 / np.pi
        inputs.append(
            Input(
                link=name,
                relative_to=which.relative_to,
                from_=start * factor,
                to=stop * factor,
                step=None if step is None else step * factor,
            )
        )
    return lw.Mechanism(replace(back, inputs=tuple(inputs)))


def _direction(linkage: Linkage, link: str, places: Mapping[str, complex] | None) -> float:
    at = places or {n: complex(*map(linkage.numbers, p)) for n, p in linkage.points.items()}
    a, b = (at[point] for point in linkage.links[link][:2])
    return float(np.angle(b - a))
