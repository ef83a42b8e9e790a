"""The line of a guide: its direction, and forces along it and across."""

from __future__ import annotations

import numpy as np

from linkwork.forces.free_bodies import FreeBodies, Holder
from linkwork.forces.geometry import Geometry
from linkwork.forces.part.contact import sliding
from linkwork.forces.size import Size
from linkwork.foundation.arrays import ComplexArray

__all__ = ["across_line", "along_line", "line_of", "rub_on_line"]


def line_of(line: tuple[str, str], geometry: Geometry) -> ComplexArray:
    """The unit vector from the first to the second point of a line, (B,)."""
    span = geometry.place(line[1]).v - geometry.place(line[0]).v
    unit: ComplexArray = span / np.abs(span)
    return unit


def along_line(bodies: FreeBodies, point: str, on: str, line: tuple[str, str]) -> int:
    """A force on a point along a line of another body."""
    geometry = bodies.geometry
    way, place = line_of(line, geometry), geometry.place(point).v
    return bodies.pair(bodies.at(point), bodies.link(on), place, way)


def across_line(bodies: FreeBodies, point: str, on: str, line: tuple[str, str]) -> int:
    """A force on a point to the left of a line of another body."""
    geometry = bodies.geometry
    way, place = line_of(line, geometry), geometry.place(point).v
    return bodies.pair(bodies.at(point), bodies.link(on), place, 1j * way)


def rub_on_line(
    name: str, bodies: FreeBodies, size: Size, pair: tuple[Holder, Holder], point: str,
    line: tuple[str, str],
) -> None:  # fmt: skip
    """Friction of a point of one body along a line of another."""
    geometry = bodies.geometry
    rates = sliding(geometry, point, pair[1].body, line[0])
    bodies.rub_force(name, size, pair, geometry.place(point).v, line_of(line, geometry), rates)
