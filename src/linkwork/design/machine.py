"""Flywheels, motors, harmonics, inflection circles."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices, key_text
from linkwork.core.foundation.names import GROUND, find_spelling
from linkwork.core.foundation.units import FULL_TURN, force_of_inertia
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import Motor, speed_per_second
from linkwork.core.mechanism.loaded import LoadedBodies
from linkwork.core.motion.model import Model
from linkwork.core.motion.rows_between import between_rows
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Group, Solved
from linkwork.core.results.quantity import Kind
from linkwork.design.results import Flywheel, Harmonics, InflectionCircle, MotorCheck
from linkwork.forces.dynamics.piecewise import Piecewise, piecewise
from linkwork.forces.reactions.drives import effort_kind, effort_name
from linkwork.forces.reactions.geometry import Geometry

# ----------------------------------------------------------------------
# One turn of the input, or the whole time of a law, for means, integrals and Fourier sums.


_EVEN = 1e-9  # of a turn: rounding of the table
_EQUAL = 1e-12  # of the size: extremes that differ less are equal


def whole_turn(model: Model, motion: Motion, name: str) -> Piecewise:
    """A quantity over one turn of the only input [rad], jumps and corners included.

    Raises
    ------
    UnknownNameError
        If the quantity does not exist.
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
    quantity = motion.quantity(name)
    if quantity.group is Group.EVIDENCE:
        raise InputError(f'"{name}" is evidence of rows, and has no values between them')
    return cycle(model, motion, lambda rows: quantity.values(rows, motion.speed), name)


def cycle(model: Model, motion: Motion, of: Callable[[Solved], Array], name: str) -> Piecewise:
    """A quantity over the table of a motion, whatever that is: by the input, or the time of a law.

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
    return curve


def first_extreme(places: Array, values: Array) -> tuple[float, float]:
    """The first of the places with the largest value, to rounding, and the value."""
    order = np.argsort(places, kind="stable")
    largest = values.max()
    k = order[np.argmax(values[order] >= largest - _EQUAL * np.abs(values).max())]
    return float(places[k]), float(largest)


# ----------------------------------------------------------------------
# Flywheel of an input whose effort fluctuates.


def flywheel(mechanism: Mechanism, fluctuation: float, *, motion: Motion | None = None) -> Flywheel:
    """The inertia at the input for a fluctuation of its speed; see
    :func:`linkwork.design.machine`.

    Parameters
    ----------
    fluctuation : float
        (ω_max - ω_min) / ω_mean.
    motion : Motion, optional
        A motion over a whole turn that is solved already, instead of the input's table.

    Raises
    ------
    InputError
        Without a speed or a whole turn.

    Examples
    --------
    >>> import linkwork as lw
    >>> round(lw.design.flywheel(lw.example("crank-press"), 0.05).inertia / 1e6, 1)  # kg m²
    43.0
    """
    model = mechanism.model
    motion = mechanism.sweep() if motion is None else motion
    description = model.description
    if not isinstance(description, LoadedBodies):
        raise InputError("a flywheel needs a mechanism with links and loads")
    if not fluctuation > 0.0:
        raise InputError(f"the fluctuation of the speed must be positive, got {fluctuation:g}")
    if description.timed:
        raise InputError("a law fixes the speed of the input: leave it out, and give speed")
    speed, lead = model.speed, model.motion_quantities.names.lead
    if not speed:
        raise InputError('a flywheel needs the speed of the input: speed = "300 rpm"')
    curve = whole_turn(model, motion, effort_name(lead))
    mean = curve.mean()
    # power in is positive along the motion, also of an input that turns backwards
    angle, energy = curve.missing(mean)
    (fastest, high), (slowest, low) = (first_extreme(angle, k * energy) for k in (1.0, -1.0))
    stored = high + low
    unit = force_of_inertia(description.mass, description.length, description.force)
    scale, units = model.units.scale(Kind.ANGLE), model.units
    return Flywheel(
        fluctuation=fluctuation,
        mean=mean,
        energy=stored,
        # eq. (78)
        inertia=stored / (fluctuation * (speed * speed)) / unit,
        slowest=slowest / scale,
        fastest=fastest / scale,
        units={
            "mean": units.of(Kind.MOMENT),
            "energy": units.of(Kind.ENERGY),
            "inertia": f"{description.mass}·{description.length}²",
            "input": units.of(Kind.ANGLE),
        },
    )


# ----------------------------------------------------------------------
# A motor against the effort that an input needs.


_ROUNDING = 1e-12  # of a speed at the end of a table


def motor_check(
    mechanism: Mechanism,
    *,
    motor: Motor | None = None,
    stall: float | None = None,
    free_speed: Number | None = None,
    rated: float | None = None,
    motion: Motion | None = None,
) -> MotorCheck:
    """Peak and root mean square of the effort against a motor, by default that of the input.

    Parameters
    ----------
    motor : Motor, optional
        A motor, which may be a table of torques over speeds.
    stall : float, optional
        Instead: torque at rest [force · length].
    free_speed : number or str, optional
        Speed without torque: ``"1500 rpm"``; the torque falls linearly to it.
    rated : float, optional
        Torque that the motor gives without end, for the root mean square.
    motion : Motion, optional
        A motion over a whole turn that is solved already, instead of the input's table.

    Raises
    ------
    InputError
        Without a motor, a speed or a whole turn, and beyond the motor's table.

    Examples
    --------
    >>> import linkwork as lw
    >>> press = lw.example("crank-press")
    >>> lw.design.motor_check(press, stall=9e5, free_speed="3000 rpm").fits
    False
    """
    model = mechanism.model
    motion = mechanism.sweep() if motion is None else motion
    inputs, timed = model.description.inputs, model.description.timed
    if len(inputs) != 1:
        raise InputError(f"a motor check needs one input, the mechanism has {len(inputs)}")
    column = inputs[0].column
    driven = model.untimed or model
    kind, scale = driven.motion_quantities.names.inputs[column], float(driven.input_scale[0])
    if not model.speed:
        raise InputError('a motor needs the speed of the input: speed = "300 rpm"')
    if motor is None and stall is not None:
        motor = Motor(stall=stall, free_speed=free_speed)
    motor = motor or inputs[0].motor
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
    places, values = turn.extremes()
    peak_at, peak = first_extreme(places, np.abs(values))
    left, spent = (piecewise(model, motion, of).extremes()[1] for of in (reserve, power))
    at_peak = between_rows(model, motion)(np.array([peak_at]))
    return MotorCheck(
        peak=peak,
        peak_at=peak_at / (1.0 if timed else scale),
        rms=math.sqrt(turn.mean(power=2)),
        mean=turn.mean(),
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
    file, drives = model.description, "link" if kind is Kind.ANGLE else "slider"
    for key, message in motor.mistakes(drives, file.numbers, file.length):
        raise InputError(f"{key_text(key)} {message}")
    stated = (*motor.speeds, *([] if motor.free_speed is None else [motor.free_speed]))
    known = [speed_per_second(each, drives, file.numbers, file.length) for each in stated]
    if not motor.speeds:
        stall = file.numbers(motor.stall or 0.0)
        for name, value in [("stall", stall), *(("free_speed", free) for free in known)]:
            if not value > 0.0:
                raise InputError(f"{name} must be positive, got {value:g}")
        return motor.curve(drives, file.numbers, file.length)
    for speed in (speeds.min(), speeds.max()):
        if not known[0] * (1.0 - _ROUNDING) <= speed <= known[-1] * (1.0 + _ROUNDING):
            ends = " to ".join(str(each) for each in (motor.speeds[0], motor.speeds[-1]))
            turning = speed * file.angle.radians * 60.0 / FULL_TURN
            at = f"{turning:.6g} rpm" if kind is Kind.ANGLE else f"{speed:.6g} {file.length}/s"
            word = "turns" if kind is Kind.ANGLE else "moves"
            raise InputError(f"the motor's table goes from {ends}, but the input {word} at {at}")
    return motor.curve(drives, file.numbers, file.length)


# ----------------------------------------------------------------------
# Harmonics of a quantity over a turn.


def harmonics(
    mechanism: Mechanism, of: str, count: int = 8, *, motion: Motion | None = None
) -> Harmonics:
    """The Fourier sum of a quantity over a turn of the input.

    Parameters
    ----------
    of : str
        A quantity: ``crank.effort``, ``shaking.x``, …
    count : int
        The number of harmonics.
    motion : Motion, optional
        A motion over a whole turn that is solved already, instead of the input's table.

    Raises
    ------
    UnknownNameError, InputError
        If the quantity does not exist, or the motion is no whole turn.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.design.harmonics(lw.example("crank-press"), "height", 3).amplitude.round(3)
    array([60.   ,  2.263,  0.   ])
    """
    model = mechanism.model
    motion = mechanism.sweep() if motion is None else motion
    turn = whole_turn(model, motion, of)
    value = np.asarray(motion[of])[:-1]
    lead = model.motion_quantities.names.lead
    angle = np.asarray(motion.inputs[lead])[:-1] * model.units.scale(Kind.ANGLE)
    rows = len(value)
    if not 1 <= count < rows / 2.0:
        raise InputError(f"{rows} rows of a turn give from 1 to {(rows - 1) // 2} harmonics")
    orders = np.arange(1, count + 1)
    # eq. (79)
    parts = 2.0 * np.array([turn.wave(order) for order in orders.tolist()])
    mean = turn.mean()
    waves = np.exp(1j * orders[:, None] * angle)
    total = mean + (parts[:, None] * waves).real.sum(axis=0)
    period = 360.0 / orders
    return Harmonics(
        of=of,
        unit=motion.table(of).units[of],
        mean=mean,
        amplitude=np.abs(parts),
        phase=np.mod(np.degrees(np.angle(parts.conj())) / orders, period),
        rest=float(np.max(np.abs(value - total))),
    )


# ----------------------------------------------------------------------
# Inflection circle of a link at a position.


_STILL = 1e-12  # rad per longest link: a link that does not turn


def inflection_circle(
    mechanism: Mechanism,
    link: str | None = None,
    at: float | Mapping[str, float] | None = None,
    *,
    configuration: str | None = None,
) -> InflectionCircle:
    """The points of a link whose paths are straight to the second order at a position.

    Parameters
    ----------
    link : str, optional
        By default the only link that ground does not carry.
    at : number or Mapping[str, number], optional
        Input value(s) in file units.
    configuration : str, optional
        As in :meth:`~linkwork.Mechanism.solve`.

    Raises
    ------
    UnknownNameError, InputError
        If the link does not exist, or it does not turn there.

    Examples
    --------
    >>> import linkwork as lw
    >>> circle = lw.design.inflection_circle(lw.example("rolling-wheel"), "wheel", at=-120)
    >>> round(circle.diameter, 9)
    40.0
    """
    model = mechanism.model
    position = mechanism.solve(at, configuration=configuration)
    description = model.description
    if not isinstance(description, LoadedBodies):
        raise InputError("an inflection circle needs a mechanism with links")
    moving = [name for name in description.carried if name != GROUND]
    if link is None:
        fixed = description.carried.get(GROUND, ())
        # the coupler, in four links
        free = [name for name in moving if not set(description.carried[name]) & set(fixed)]
        if len(free) != 1:
            raise InputError(f"name the link {choices('links', moving)}")
        link = free[0]
    link = find_spelling(link, moving)
    if link not in moving:
        raise UnknownNameError(f'there is no link "{link}" {choices("links", moving, link)}')
    if not position.status.ok:
        raise InputError(f"there is no position: {position.message}")
    geometry = Geometry(model, position)
    point = geometry.place(description.carried[link][0])
    turn = geometry.angle(link)
    first, second = float(turn.d1[0]), float(turn.d2[0])
    place, rate, bend = (complex(part.flat[0]) for part in (point.v, point.d1, point.d2))
    size = max(abs(rate) / geometry.length, float(geometry.fastest[0]))
    if not abs(first) > _STILL * size or not math.isfinite(first + second):
        raise InputError(
            f'"{link}" does not turn there: its points have no common inflection circle'
        )
    # derivatives by the angle of the link
    by_angle = rate / first
    bend_by_angle = (bend - by_angle * second) / first**2
    # eq. (81)
    pole, opposite = place + 1j * by_angle, place + bend_by_angle
    return InflectionCircle(
        link=link,
        pole=(pole.real, pole.imag),
        inflection_pole=(opposite.real, opposite.imag),
        unit=model.units.of(Kind.LENGTH),
    )
