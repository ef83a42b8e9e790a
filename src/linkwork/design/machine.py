"""Counterweights that remove the shaking force of a four-bar.

The centre of mass of the moving links stays at rest if the vectors that turn with crank and rocker
vanish (R. S. Berkof, G. G. Lowen 1969, doi:10.1115/1.3591524).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from linkwork.core import motion
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.arrays import Array, FrozenDict
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices, key_text
from linkwork.core.foundation.names import GROUND, find_spelling
from linkwork.core.foundation.units import FULL_TURN, force_of_inertia
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import Motor, speed_per_second
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.machine import LoadedBodies, Mass
from linkwork.core.motion.branch_rows import between_rows
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Group, Solved
from linkwork.core.results.quantity import Kind
from linkwork.design.results import (
    Counterweight,
    Counterweights,
    Flywheel,
    Harmonics,
    InflectionCircle,
    MotorCheck,
)
from linkwork.forces.dynamics.collocation import Piecewise, piecewise
from linkwork.forces.reactions.drives import effort_kind, effort_name
from linkwork.forces.reactions.geometry import Geometry
from linkwork.forces.reactions.solving import forces_of_motion


def _weights(linkage: Linkage, radius: float | Mapping[str, float]) -> Iterator[Counterweight]:
    """The counterweights of crank and rocker at a distance from their pins on ground."""
    sides, coupler = _four_bar(linkage)
    # in the frames of their links
    first, second = (
        _local(linkage, link, moving) - _local(linkage, link, fixed)
        for link, fixed, moving in sides
    )
    start, end = (_local(linkage, coupler, moving) for _, _, moving in sides)
    mass, centre, _ = _mass(linkage, coupler)
    share = (centre - start) / (end - start)
    for (link, fixed, _), arm, part in zip(
        sides, (first, second), (1.0 - share, share), strict=True
    ):
        link_mass, place, _ = _mass(linkage, link)
        # eq. (80)
        needed = -(link_mass * (place - _local(linkage, link, fixed)) + mass * part * arm)
        size = abs(needed)
        distance = radius[link] if isinstance(radius, Mapping) else radius
        if not distance > 0.0:
            raise InputError(f'the radius on "{link}" must be positive, got {distance:g}')
        way = needed / size if size else 1.0 + 0j
        at = _local(linkage, link, fixed) + distance * way
        yield Counterweight(
            link=link,
            product=size,
            angle=math.degrees(math.atan2(way.imag, way.real)),
            mass=size / distance,
            place=(at.real, at.imag),
        )


def _balanced(linkage: Linkage, weights: tuple[Counterweight, ...]) -> Linkage:
    """The linkage with its counterweights."""
    masses = dict(linkage.masses)
    for weight in weights:
        link_mass, centre, inertia = _mass(linkage, weight.link)
        total = link_mass + weight.mass
        if not total:
            continue
        place = complex(*weight.place)
        both = (link_mass * centre + weight.mass * place) / total
        inertia += link_mass * abs(centre - both) ** 2 + weight.mass * abs(place - both) ** 2
        masses[weight.link] = Mass(mass=total, center=(both.real, both.imag), inertia=inertia)
    return replace(linkage, masses=masses)


def _shaking(linkage: Linkage) -> tuple[float, float]:
    """The largest shaking force and moment of the masses alone, at the input's speed or 1 rad/s."""
    inputs = tuple(
        each if each.speed is not None or each.law is not None else replace(each, speed="1 rad/s")
        for each in linkage.inputs
    )
    alone = replace(
        linkage, loads=(), springs=(), gravity=None, friction=FrozenDict(), inputs=inputs
    )
    model = motion.model_of(alone)
    forces = forces_of_motion(model, motion.sweep(model, certify=False))
    x, y, moment = (np.asarray(forces[f"shaking.{part}"]) for part in ("x", "y", "moment"))
    return float(np.nanmax(np.hypot(x, y))), float(np.nanmax(np.abs(moment)))


def _four_bar(linkage: Linkage) -> tuple[list[tuple[str, str, str]], str]:
    """Both links on ground with their fixed and moving pins, and the coupler."""
    # loads and springs join no links
    parts = [part for part in linkage.parts if part.kind is not None or part.mobility]
    moving = [link for link in linkage.links if link != GROUND]
    sides = []
    for link in moving:
        others = [other for other in moving if other != link]
        fixed = [p for p in linkage.links[link] if p in linkage.links[GROUND]]
        joined = [p for p in linkage.links[link] if any(p in linkage.links[o] for o in others)]
        if len(fixed) == 1 and len(joined) == 1:
            sides.append((link, fixed[0], joined[0]))
    rest = [link for link in moving if link not in [side[0] for side in sides]]
    if parts or len(moving) != 3 or len(sides) != 2 or len(rest) != 1:
        raise InputError(
            f"{linkage.name} is no four-bar with pins only: the shaking force of other mechanisms "
            "cannot be removed by two counterweights"
        )
    if not linkage.masses:
        raise InputError(f"{linkage.name} has no masses to balance: add [masses]")
    return sides, rest[0]


def _local(linkage: Linkage, link: str, point: str) -> complex:
    """A point in the frame of its link."""
    return complex(linkage.shapes.local[link][point])


def _mass(linkage: Linkage, link: str) -> tuple[float, complex, float]:
    """The mass of a link, its centre in the link's frame, and its inertia about that."""
    stated, numbers = linkage.masses.get(link), linkage.numbers
    if stated is None:
        return 0.0, 0j, 0.0
    mass = numbers(stated.mass)
    if stated.shape is None:
        return mass, complex(*map(numbers, stated.center or (0.0, 0.0))), numbers(stated.inertia)
    first, second = linkage.links[link][:2]
    length = abs(_local(linkage, link, second) - _local(linkage, link, first))
    return mass, complex(length / 2.0), mass * length**2 / 12.0


def counterweights(mechanism: Mechanism, radius: float | Mapping[str, float]) -> Counterweights:
    """The counterweights that remove the shaking force of a four-bar.

    The masses alone shake, at the speed of the input or at 1 rad/s: loads, springs and gravity
    are left out.

    Parameters
    ----------
    radius : number or Mapping[str, number]
        Their distance from the pins on ground [length], by link or for both.

    Raises
    ------
    InputError
        If it is no four-bar with pins and masses, or a radius is not positive.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
    >>> [weight.link for weight in lw.design.counterweights(bar, radius=20).weights]
    ['crank', 'rocker']
    """
    linkage = _linkage(mechanism)
    weights = tuple(_weights(linkage, radius))
    (force, moment), (force_after, moment_after) = (
        _shaking(each) for each in (linkage, _balanced(linkage, weights))
    )
    mass, length, unit = linkage.mass, linkage.length, linkage.force
    return Counterweights(
        weights=weights,
        force=(force, force_after),
        moment=(moment, moment_after),
        units={
            "mass": mass, "product": f"{mass}·{length}", "force": unit,
            "moment": f"{unit}·{length}",
        },
    )  # fmt: skip


def balanced(mechanism: Mechanism, radius: float | Mapping[str, float]) -> Mechanism:
    """A copy whose masses contain the counterweights of :func:`counterweights`.

    Parameters
    ----------
    radius : number or Mapping[str, number]
        As there.

    Raises
    ------
    InputError
        As there.

    Examples
    --------
    >>> import linkwork as lw
    >>> bar = lw.example("four-bar").changed(masses={"coupler": lw.Mass(mass=2, shape="rod")})
    >>> sorted(lw.design.balanced(bar, radius=20).description.masses)
    ['coupler', 'crank', 'rocker']
    """
    linkage = _linkage(mechanism)
    return Mechanism(_balanced(linkage, tuple(_weights(linkage, radius))))


def _linkage(mechanism: Mechanism) -> Linkage:
    if not isinstance(mechanism.description, Linkage):
        raise InputError("counterweights need a mechanism with points and links")
    return mechanism.description


# ----------------------------------------------------------------------
# Flywheels, motors, harmonics, inflection circles.


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
