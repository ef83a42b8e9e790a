"""Equations of a point on a curve: its two coordinates are cubic splines."""

from __future__ import annotations

import numpy as np

from linkwork.equations.frames import Place
from linkwork.equations.model import LawEquation
from linkwork.equations.outline import Outline
from linkwork.equations.part_rows import PartRows
from linkwork.foundation.names import canonical
from linkwork.kernels.piecewise import Piecewise
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.curve import Curve

__all__ = ["add_law", "on_outline", "write"]


def write(curve: Curve, key: Key, rows: PartRows) -> None:
    """X = x(u), Y = y(u) in the frame of the curve's body."""
    numbers = rows.frames.linkage.numbers
    points = [complex(numbers(x), numbers(y)) for x, y in curve.through]
    outline = Outline.through(points, closed=curve.closed)
    place = on_outline(
        rows, curve.name, (curve.on, curve.origin), curve.point, outline, curve.closed
    )
    rows.put(curve.on, curve.point, place, key)


def add_law(
    rows: PartRows, label: str, coordinate: str, law: Piecewise, shown: tuple[str, str, int]
) -> None:
    """coordinate - law(u) = 0; ``shown``: the curve, x or y, and the order of the derivative."""
    name, axis, primes = shown
    count, called = len(law.breaks) - 1, f"{axis}_{name}"
    spline = f"{called} is the curve's {axis}, a cubic spline of {count} pieces"
    slope = f"{called}' is the derivative of {called}"
    rows.laws.append(
        LawEquation(
            label=label,
            terms=((canonical(coordinate), 1.0),),
            constant=0.0,
            law=law,
            shown=f"{axis}_{canonical(name)}",
            inner=((canonical(name), 1.0),),
            offset=0.0,
            meaning=slope if primes else spline,
            primes=primes,
        )
    )


def on_outline(
    rows: PartRows, name: str, at: tuple[str, str], point: str, outline: Outline, closed: bool
) -> Place:
    """The position of a point on a body's curve: its centre, then X and Y in its frame."""
    body, origin = at
    frames = rows.frames
    u = outline.nearest(rows.sketched_in(body, origin, point))
    rows.unknown(name, "angle" if closed else "length", u)
    here = complex(outline.at(np.array([u]))[0])
    terms = []
    for axis, start, law, unit in (
        ("x", here.real, outline.x, 1.0 + 0j),
        ("y", here.imag, outline.y, 1j),
    ):
        coordinate = f"{name}_{axis}"
        rows.unknown(coordinate, "length", start)
        terms.append(frames.vector_term(unit, None, body, coordinate))
        add_law(rows, f"{name} {axis}", coordinate, law, (name, axis, 0))
    rows.outlines[name] = (body, origin, outline.at(outline.samples()))
    return Place(frames.places[body][origin].fixed, tuple(terms), base=origin)
