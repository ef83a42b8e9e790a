"""A motor against the effort that an input needs."""

from __future__ import annotations

import math

import numpy as np

from linkwork.design.whole_turn import whole_turn
from linkwork.forces.drives import effort_name
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.errors import InputError, key_text
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.motor import Motor
from linkwork.mechanism.speed import speed_per_second
from linkwork.motion.model import Model
from linkwork.results.machine_design import MotorCheck
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["motor_check"]

_ROUNDING = 1e-12  # of a speed at the end of a table


def motor_check(
    model: Model,
    motion: Motion,
    *,
    motor: Motor | None = None,
    stall: float | None = None,
    free_speed: Number | None = None,
    rated: float | None = None,
) -> MotorCheck:
    """The peak and the root mean square of the effort over a turn against a motor: the given one,
    or one with a stall torque and a free speed, or that of the file.

    Raises
    ------
    InputError
        Without a motor, a speed of the input or a whole turn; for a motor without torque or speed,
        or with a table that ends below the speed.
    """
    speed, lead = model.speed, model.motion_quantities.names.lead
    if not speed:
        raise InputError('a motor needs the speed of the input: speed = "300 rpm"')
    which = next(own for own in model.description.inputs if own.column == lead)
    if motor is None:
        motor = which.motor if stall is None else Motor(stall=stall, free_speed=free_speed)
    if motor is None:
        raise InputError("there is no motor: add motor to the input, or give stall and free_speed")
    torque = _available(model, motor, abs(speed))
    turn = whole_turn(model, motion, effort_name(lead))
    most = int(np.argmax(np.abs(turn.value)))
    return MotorCheck(
        peak=float(abs(turn.value[most])),
        peak_at=float(np.asarray(motion.inputs[lead])[most]),
        rms=math.sqrt(turn.mean_square),
        mean=turn.mean,
        available=torque,
        rated=rated,
        power=float(np.max(turn.value * speed)),
        units={
            "effort": model.units.of(Kind.MOMENT),
            "power": model.units.of(Kind.POWER),
            "input": model.units.of(Kind.ANGLE),
        },
    )


def _available(model: Model, motor: Motor, speed: float) -> float:
    """The torque that a motor gives at a speed [rad/s]."""
    own = model.description
    for key, message in motor.mistakes("link", own.numbers, own.length):
        raise InputError(f"{key_text(key)} {message}")
    known = [
        speed_per_second(given, "link", own.numbers, own.length) * own.angle.radians
        for given in (*motor.speeds, *([] if motor.free_speed is None else [motor.free_speed]))
    ]
    if not motor.speeds:
        stall = own.numbers(motor.stall or 0.0)
        for name, value in [("stall", stall), *(("free_speed", free) for free in known)]:
            if not value > 0.0:
                raise InputError(f"{name} must be positive, got {value:g}")
    elif not known[0] * (1.0 - _ROUNDING) <= speed <= known[-1] * (1.0 + _ROUNDING):
        ends = " to ".join(str(each) for each in (motor.speeds[0], motor.speeds[-1]))
        asked = f"{speed * 60.0 / FULL_TURN:.6g} rpm"
        raise InputError(f"the motor's table goes from {ends}, but the input turns at {asked}")
    curve = motor.curve("link", own.numbers, own.length)
    return float(curve(np.array([speed / own.angle.radians]))[0])
