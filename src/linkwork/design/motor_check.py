"""A motor against the effort that an input needs."""

from __future__ import annotations

import math

import numpy as np

from linkwork.design.whole_turn import whole_turn
from linkwork.forces.drives import effort_name
from linkwork.foundation.errors import ExpressionError, InputError
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.speed import speed_per_second
from linkwork.motion.model import Model
from linkwork.results.machine_design import MotorCheck
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["motor_check"]


def motor_check(
    model: Model, motion: Motion, *, stall: float, free_speed: Number, rated: float | None = None
) -> MotorCheck:
    """The peak and the root mean square of the effort over a turn against a motor's line.

    Raises
    ------
    InputError
        Without a speed of the input or a whole turn, or for a motor without torque or speed.
    """
    speed, lead = model.speed, model.motion_quantities.names.lead
    if not speed:
        raise InputError('a motor needs the speed of the input: speed = "300 rpm"')
    description = model.description
    try:
        free = speed_per_second(free_speed, "link", description.numbers, description.length)
    except ExpressionError as error:
        raise InputError(f"free_speed {error.message}") from None
    free *= description.angle.radians
    for name, value in (("stall", stall), ("free_speed", free)):
        if not value > 0.0:
            raise InputError(f"{name} must be positive, got {value:g}")
    turn = whole_turn(model, motion, effort_name(lead))
    most = int(np.argmax(np.abs(turn.value)))
    return MotorCheck(
        peak=float(abs(turn.value[most])),
        peak_at=float(np.asarray(motion.inputs[lead])[most]),
        rms=math.sqrt(turn.mean_square),
        mean=turn.mean,
        available=stall * (1.0 - abs(speed) / free),
        rated=rated,
        power=float(np.max(turn.value * speed)),
        units={
            "effort": model.units.of(Kind.MOMENT),
            "power": model.units.of(Kind.POWER),
            "input": model.units.of(Kind.ANGLE),
        },
    )
