"""Read the speed of an input: ``"300 rpm"``, ``"25 rad/s"``, ``"50 mm/s"``."""

from __future__ import annotations

import math
from collections.abc import Sequence

from linkwork.equations.model import Variable
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import ExpressionError, MechanismError, Problem
from linkwork.mechanism.description import Description
from linkwork.mechanism.speed import speed_per_second
from linkwork.motion.leading_input import leading_input

__all__ = ["input_speed", "leading_speeds"]


def input_speed(description: Description, inputs: Sequence[Variable], rows: Array) -> float | None:
    """The rate of the leading input, [rad/s] or [length/s]; ``None`` if no speed is given.

    Raises
    ------
    MechanismError
        For a speed that cannot be read, or speeds that contradict the lock-step of the inputs.
    """
    rates = leading_speeds(description, inputs, rows)
    first = next(iter(rates.values()), None)
    for k, leading in rates.items():
        assert first is not None
        if not math.isclose(leading, first, rel_tol=1e-9):
            message = (
                "contradicts the first speed: speeds of inputs in lock-step have the ratio of "
                "their steps"
            )
            problem = Problem(key=(*description.input_key(k), "speed"), message=message)
            raise MechanismError([problem], f'mechanism "{description.name}"')
    return first


def leading_speeds(
    description: Description, inputs: Sequence[Variable], rows: Array
) -> dict[int, float]:
    """The leading input's rate according to the speed of every input that has one.

    Raises
    ------
    MechanismError
        For a speed that cannot be read.
    """
    _, rate = leading_input(rows)
    return {
        k: _speed(description, k, inputs[k].kind) / float(rate[k]) if rate[k] else math.nan
        for k, which in enumerate(description.inputs)
        if which.speed is not None
    }


def _speed(description: Description, k: int, kind: str) -> float:
    """The speed of the k-th input, internal units per second."""
    which = description.inputs[k]
    assert which.speed is not None
    driven = {"angle": "link", "length": "slider"}.get(kind, "variable")
    try:
        own = speed_per_second(which.speed, driven, description.numbers, description.length)
    except ExpressionError as error:
        problem = Problem(key=(*description.input_key(k), "speed"), message=error.message)
        raise MechanismError([problem], f'mechanism "{description.name}"') from None
    return own * (description.angle.radians if kind == "angle" else 1.0)
