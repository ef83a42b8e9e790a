"""One turn of the input in equal steps, for means and Fourier sums."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["WholeTurn", "whole_turn"]

_EVEN = 1e-9  # of a turn: rounding of the table


@dataclass(frozen=True, kw_only=True, eq=False)
class WholeTurn:
    """A quantity at M + 1 input values of one turn, the last one a turn after the first.

    Parameters
    ----------
    angle : (M + 1,)
        The input [rad], from its first value up or down.
    value : (M + 1,)
        The quantity [file unit].
    """

    angle: Array
    value: Array

    @property
    def mean(self) -> float:
        """The mean over the turn, of straight lines between the rows."""
        return float(np.mean((self.value[1:] + self.value[:-1]) / 2.0))

    @property
    def mean_square(self) -> float:
        """The mean of the squares, of straight lines between the rows."""
        a, b = self.value[:-1], self.value[1:]
        return float(np.mean((a * a + a * b + b * b) / 3.0))


def whole_turn(model: Model, motion: Motion, name: str) -> WholeTurn:
    """A quantity over one turn of the only input.

    Raises
    ------
    UnknownNameError
        If there is no such quantity.
    InputError
        If the table is no whole turn of a rotating input in equal steps, or a row has no value.
    """
    names = model.motion_quantities.names
    if len(names.inputs) != 1 or names.inputs[names.lead] is not Kind.ANGLE:
        raise InputError("a whole turn needs one input, which rotates")
    scale = model.units.scale(Kind.ANGLE)
    angle = np.asarray(motion.inputs[names.lead]) * scale
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
    value = np.asarray(motion[name], dtype=float)
    missing = int(np.sum(~np.isfinite(value)))
    if missing:
        raise InputError(f'"{name}" has no value in {missing} of {len(value)} rows of the turn')
    return WholeTurn(angle=angle, value=value)
