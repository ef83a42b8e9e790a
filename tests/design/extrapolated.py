"""Derivatives of whole computations by central differences, extrapolated twice (Romberg)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import linkwork as lw
from linkwork import Mechanism
from linkwork.core.foundation.arrays import Array
from linkwork.core.mechanism.varied_numbers import number_named, with_numbers
from linkwork.core.motion.model import Model

__all__ = ["changed_by", "extrapolated", "own_position"]


def extrapolated(
    of: Callable[[float], Mapping[str, float]], at: float, step: float
) -> dict[str, float]:
    """The derivatives of several numbers of x; their error is of the order step^6."""
    slopes = []
    for k in range(3):
        h = step / 2**k
        high, low = of(at + h), of(at - h)
        slopes.append({name: (high[name] - low[name]) / (2.0 * h) for name in high})
    found = {}
    for name in slopes[0]:
        a, b, c = (slope[name] for slope in slopes)
        first, second = (4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0
        found[name] = (16.0 * second - first) / 15.0
    return found


def changed_by(mechanism: lw.Mechanism, name: str, to: float) -> lw.Mechanism:
    """The mechanism with another value of one number."""
    number = number_named(mechanism.description, name)
    return Mechanism(with_numbers(mechanism.description, {number: to}))


def own_position(model: Model, v: Array) -> Array:
    """A position (1, N) near another one, solved until nothing changes."""
    found = model.compiled.solver.solve(v).v
    if not model.compiled.table.functions:
        for _ in range(2):
            found = model.compiled.solver.sharpen(found)
    return found
