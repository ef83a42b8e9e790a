"""The start of a motion at round input values, for pictures."""

from __future__ import annotations

import math

import numpy as np

from linkwork.motion.model import Model
from linkwork.motion.solving import solve
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["solve_round_start"]

_STEPS = 50  # a round value is at most about this fraction of the range away


def solve_round_start(model: Model, cycle: Motion, start: Position | None = None) -> Position:
    """The position at the round input values nearest to the start; the start if it is not found.

    Parameters
    ----------
    cycle : Motion
        A motion of the mechanism, for the ranges of its inputs.
    start : Position, optional
        The start; by default the position at the input values of the guess.
    """
    start = solve(model) if start is None else start
    if not start.status.ok:
        return start
    values = {
        name: _round(value, float(np.ptp(cycle.inputs[name])))
        for name, value in start.input.items()
        if name in cycle.inputs
    }
    if values == dict(start.input):
        return start
    near = solve(model, values)
    return near if near.status.ok else start


def _round(value: float, span: float) -> float:
    """The value to a power of ten up to a fiftieth of a range; as it is without a range."""
    if not span:
        return value
    return round(value, -math.floor(math.log10(span / _STEPS)))
