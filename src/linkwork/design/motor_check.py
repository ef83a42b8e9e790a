"""A motor against the effort that an input needs."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from linkwork.design.whole_turn import column_of, cycle, first_extreme, whole_turn
from linkwork.dynamics.piecewise import piecewise
from linkwork.forces.drives import effort_kind, effort_name
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError, key_text
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.motor import Motor
from linkwork.mechanism.speed import speed_per_second
from linkwork.motion.between_rows import between_rows
from linkwork.motion.model import Model
from linkwork.results.machine_design import MotorCheck
from linkwork.results.motion import Motion
from linkwork.results.quantities.definition import Solved
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
    """The peak and the root mean square of the effort over a turn, or over the whole time of a law,
    against a motor: the given one, or one with a stall torque and a free speed, or that of the
    file.

    Raises
    ------
    InputError
        Without a motor, a speed of the input, a law or a whole turn; for several inputs, a motor
        without torque or speed, or with a table that ends below a speed.
    """
    column, timed = column_of(model, "a motor check"), model.description.timed
    driven = model.untimed or model
    kind, scale = driven.motion_quantities.names.inputs[column], float(driven.input_scale[0])
    if not model.speed:
        raise InputError('a motor needs the speed of the input: speed = "300 rpm"')
    if motor is None and stall is not None:
        motor = Motor(stall=stall, free_speed=free_speed)
    motor = motor or model.description.inputs[0].motor
    if motor is None:
        raise InputError("there is no motor: add motor to the input, or give stall and free_speed")
    effort = motion.quantity(effort_name(column))
    rate = motion.quantity(f"{column}.velocity")

    def needed(rows: Solved) -> Array:
        return np.asarray(effort.values(rows, motion.speed), dtype=float)

    def speeds(rows: Solved) -> Array:
        return np.asarray(rate.values(rows, motion.speed), dtype=float) / scale

    curve = _curve(model, motor, kind, np.abs(speeds(motion)))

    def reserve(rows: Solved) -> Array:
        return curve(np.abs(speeds(rows))) - np.abs(needed(rows))

    def power(rows: Solved) -> Array:
        return needed(rows) * speeds(rows) * scale

    turn = (
        cycle(model, motion, needed, effort.name)
        if timed
        else whole_turn(model, motion, effort.name)
    )
    places, values = turn.curve.extremes()
    peak_at, peak = first_extreme(places, np.abs(values))
    left, spent = (piecewise(model, motion, of).extremes()[1] for of in (reserve, power))
    at_peak = between_rows(model, motion)(np.array([peak_at]))
    return MotorCheck(
        peak=peak,
        peak_at=peak_at / (1.0 if timed else scale),
        rms=math.sqrt(turn.curve.mean(power=2)),
        mean=turn.curve.mean(),
        available=float(curve(np.abs(speeds(at_peak)))[0]),
        reserve=float(left.min()),
        rated=rated,
        power=float(spent.max()),
        units={
            "effort": model.units.of(effort_kind(kind)),
            "power": model.units.of(Kind.POWER),
            "input": next(iter(motion.input_units.values())),
        },
    )


def _curve(model: Model, motor: Motor, kind: Kind, speeds: Array) -> Callable[[Array], Array]:
    """The torque or force of a motor over speeds, which it must reach (B,) [file unit/s]."""
    own, drives = model.description, "link" if kind is Kind.ANGLE else "slider"
    for key, message in motor.mistakes(drives, own.numbers, own.length):
        raise InputError(f"{key_text(key)} {message}")
    given = (*motor.speeds, *([] if motor.free_speed is None else [motor.free_speed]))
    known = [speed_per_second(each, drives, own.numbers, own.length) for each in given]
    if not motor.speeds:
        stall = own.numbers(motor.stall or 0.0)
        for name, value in [("stall", stall), *(("free_speed", free) for free in known)]:
            if not value > 0.0:
                raise InputError(f"{name} must be positive, got {value:g}")
        return motor.curve(drives, own.numbers, own.length)
    for speed in (speeds.min(), speeds.max()):
        if not known[0] * (1.0 - _ROUNDING) <= speed <= known[-1] * (1.0 + _ROUNDING):
            ends = " to ".join(str(each) for each in (motor.speeds[0], motor.speeds[-1]))
            turning = speed * own.angle.radians * 60.0 / FULL_TURN
            at = f"{turning:.6g} rpm" if kind is Kind.ANGLE else f"{speed:.6g} {own.length}/s"
            word = "turns" if kind is Kind.ANGLE else "moves"
            raise InputError(f"the motor's table goes from {ends}, but the input {word} at {at}")
    return motor.curve(drives, own.numbers, own.length)
