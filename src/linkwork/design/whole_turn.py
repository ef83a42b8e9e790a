"""One turn of the input, or the whole time of a law, for means, integrals and Fourier sums."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from linkwork.dynamics.piecewise import Piecewise, piecewise
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.quantities.asked import Group
from linkwork.results.quantities.definition import Solved
from linkwork.results.quantity import Kind

__all__ = ["Cycle", "column_of", "cycle", "first_extreme", "whole_turn"]

_EVEN = 1e-9  # of a turn: rounding of the table
_EQUAL = 1e-12  # of the size: extremes that differ less are equal


@dataclass(frozen=True, kw_only=True, eq=False)
class Cycle:
    """A quantity over a cycle: in the M + 1 rows of the table, and between them.

    Parameters
    ----------
    place : (M + 1,)
        The input, or the time of a law [rad], [length] or [s].
    value : (M + 1,)
        The quantity [file unit].
    curve : Piecewise
        The quantity between the rows, jumps and corners included.
    """

    place: Array
    value: Array
    curve: Piecewise


def column_of(model: Model, what: str) -> str:
    """The only input of a mechanism; ``what`` needs it.

    Raises
    ------
    InputError
        For several inputs, or none.
    """
    inputs = model.description.inputs
    if len(inputs) != 1:
        raise InputError(f"{what} needs one input, the mechanism has {len(inputs)}")
    return inputs[0].column


def whole_turn(model: Model, motion: Motion, name: str) -> Cycle:
    """A quantity over one turn of the only input.

    Raises
    ------
    UnknownNameError
        If there is no such quantity.
    InputError
        If the table is no whole turn of a rotating input in equal steps, or a row has no value.
    """
    names = model.motion_quantities.names
    if model.description.timed:
        raise InputError("needs a turn of the input at constant speed: leave out its law")
    if len(names.inputs) != 1 or names.inputs[names.lead] is not Kind.ANGLE:
        raise InputError("a whole turn needs one input, which rotates")
    angle = np.asarray(motion.inputs[names.lead]) * model.units.scale(Kind.ANGLE)
    steps = np.diff(angle)
    turn = float(angle[-1] - angle[0]) if len(angle) > 1 else 0.0
    even = len(steps) > 2 and bool(np.ptp(steps) <= _EVEN * math.tau)
    if not even or abs(abs(turn) - math.tau) > _EVEN * math.tau:
        first, last = (float(motion.inputs[names.lead][k]) for k in (0, -1))
        unit = motion.input_units[names.lead]
        raise InputError(
            f"needs a whole turn in equal steps, the table goes from {first:g} to {last:g} {unit}: "
            "change from, to and step of the input"
        )
    asked = motion.quantity(name)
    if asked.group is Group.EVIDENCE:
        raise InputError(f'"{name}" is evidence of rows, and has no values between them')
    return cycle(model, motion, lambda rows: asked.values(rows, motion.speed), name)


def cycle(model: Model, motion: Motion, of: Callable[[Solved], Array], name: str) -> Cycle:
    """A quantity over the table of a motion, whatever that is.

    Raises
    ------
    InputError
        If a row has no value, or a place between two rows.
    """
    value = np.asarray(of(motion), dtype=float)
    missing = int(np.sum(~np.isfinite(value)))
    if missing:
        raise InputError(f'"{name}" has no value in {missing} of {len(value)} rows')
    curve = piecewise(model, motion, of)
    if not np.isfinite(curve.panels.coefficients).all():
        raise InputError(f'"{name}" has no value at some places between the rows')
    lead = model.motion_quantities.names.lead
    scale = float(model.input_scale[list(motion.inputs).index(lead)])
    return Cycle(place=np.asarray(motion.inputs[lead]) * scale, value=value, curve=curve)


def first_extreme(places: Array, values: Array) -> tuple[float, float]:
    """The first of the places with the largest value, to rounding, and the value."""
    order = np.argsort(places, kind="stable")
    largest = values.max()
    k = order[np.argmax(values[order] >= largest - _EQUAL * np.abs(values).max())]
    return float(places[k]), float(largest)
