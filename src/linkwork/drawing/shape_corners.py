"""The defining points of primitives."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from linkwork.drawing.scene import Arc, Disc, Hatch, Polygon, Polyline, Primitive, Text, xy
from linkwork.foundation.arrays import ComplexArray

__all__ = ["corners", "same_sizes", "with_corners"]


def corners(shape: Primitive) -> ComplexArray:
    """The defining points x + iy of a primitive, shape (m,)."""
    match shape:
        case Polyline() | Polygon():
            places = shape.points
        case Disc():
            places = (shape.centre,)
        case Arc():
            turned = shape.radius * np.exp(1j * shape.start)
            places = (shape.centre, xy(complex(*shape.centre) + turned))
        case Hatch():
            places = tuple(end for stroke in shape.strokes for end in stroke)
        case Text():
            places = (shape.anchor,)
        case _:
            raise TypeError(f"{type(shape).__name__} is not known to move")
    return np.array([complex(*place) for place in places])


def with_corners(shape: Primitive, places: ComplexArray) -> Primitive:
    """The primitive with new :func:`corners`."""
    found = tuple(map(xy, places))
    match shape:
        case Polyline() | Polygon():
            return replace(shape, points=found)
        case Disc():
            return replace(shape, centre=found[0])
        case Arc():
            start = float(np.angle(places[1] - places[0]))
            return replace(shape, centre=found[0], start=start)
        case Hatch():
            return replace(shape, strokes=tuple(zip(found[::2], found[1::2], strict=True)))
        case Text():
            return replace(shape, anchor=found[0])
        case _:
            raise TypeError(f"{type(shape).__name__} is not known to move")


def same_sizes(shapes: Iterable[Primitive], size: float) -> bool:
    """Whether radii, sweeps and heads are equal."""
    numbers = np.array([_sizes(shape) for shape in shapes])
    return bool(np.ptp(numbers, axis=0).max(initial=0.0) <= 1e-7 * size)


def _sizes(shape: Primitive) -> tuple[float, ...]:
    match shape:
        case Disc():
            return (shape.radius,)
        case Arc():
            return shape.radius, shape.sweep * shape.radius, shape.head
        case _:
            return ()
