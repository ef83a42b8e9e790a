"""Reading the speed of an input: ``"300 rpm"``, ``"25 rad/s"``, ``"50 mm/s"``."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from linkwork.equations.model import Variable
from linkwork.foundation.errors import ExpressionError, MechanismError, Problem
from linkwork.mechanism.description import Description

__all__ = ["input_speed", "leading"]

_ANGULAR = {"rpm": math.pi / 30.0, "rad/s": 1.0, "deg/s": math.pi / 180.0}


def leading(rows: npt.NDArray[np.float64]) -> int:
    """The input that parametrises the table: the first one that changes."""
    for k in range(rows.shape[1]):
        if len(rows) > 1 and rows[1, k] != rows[0, k]:
            return k
    return 0


def input_speed(
    description: Description, inputs: Sequence[Variable], rows: npt.NDArray[np.float64]
) -> float | None:
    """The rate of the leading input, [rad/s] or [length/s]; ``None`` if no speed is given.

    Raises
    ------
    MechanismError
        For a speed that cannot be read, or speeds that contradict the lock-step of the inputs.
    """
    given = [
        (k, _speed(description, k, inputs[k].kind))
        for k, which in enumerate(description.inputs)
        if which.speed is not None
    ]
    if not given:
        return None
    lead = leading(rows)
    step = rows[1] - rows[0] if len(rows) > 1 else np.ones(rows.shape[1])
    rates = [speed * step[lead] / step[k] if step[k] else math.nan for k, speed in given]
    for (k, _), rate in zip(given, rates, strict=True):
        if not math.isclose(rate, rates[0], rel_tol=1e-9):
            message = "contradicts the first speed: in lock-step, speeds are as the steps"
            problem = Problem(key=(*description.input_key(k), "speed"), message=message)
            raise MechanismError([problem], f'mechanism "{description.name}"')
    return rates[0]


def _speed(description: Description, k: int, kind: str) -> float:
    speed = description.inputs[k].speed
    key = (*description.input_key(k), "speed")
    units = (
        {f"{description.length}/s": 1.0}
        if kind == "length"
        else _ANGULAR
        if kind == "angle"
        else {"1/s": 1.0}
    )
    own = description.angle.radians if kind == "angle" else 1.0
    where = f'mechanism "{description.name}"'
    text = str(speed).strip()
    amount, _, unit = text.rpartition(" ")
    if unit in units:
        text, factor = amount, units[unit]
    else:
        factor = own
    try:
        number = description.numbers(text)
    except ExpressionError:
        message = f'"{speed}" is no speed: write a number and one of {", ".join(units)}'
        raise MechanismError([Problem(key=key, message=message)], where) from None
    return number * factor
