"""Derivatives of whole computations by central differences, extrapolated twice (Romberg)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

import linkwork as lw
from linkwork.api import Mechanism
from linkwork.foundation.arrays import Array
from linkwork.mechanism.varied_number import number_named, with_numbers
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model, model_of
from linkwork.motion.named_quantities import RowValues

__all__ = ["changed_by", "extrapolated", "own_position", "values_of"]


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


def values_of(
    mechanism: lw.Mechanism, name: str, v: Array, wanted: list[str], to: float
) -> dict[str, float]:
    """Quantities of a design with one other number, at the position next to a given one."""
    number = number_named(mechanism.description, name)
    model = model_of(with_numbers(mechanism.description, {number: to}))
    here = own_position(model, v)
    first, second = np.zeros_like(here), np.zeros_like(here)
    if model.equations.inputs:
        rates = model.compiled.solver.rates(here, leading_input(model.rows)[1])
        first, second = rates.first, rates.second
    rows = RowValues(model, here, first, second, np.ones(1, dtype=bool))
    asked = {name: model.quantities.find(name) for name in wanted}
    return {name: float(np.ravel(a.values(rows, model.speed))[0]) for name, a in asked.items()}
