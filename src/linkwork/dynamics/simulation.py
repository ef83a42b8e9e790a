"""Simulation: the motion in time of a mechanism with one input, from its start under its loads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkwork.dynamics.curve import PositionCurve, curve_of
from linkwork.dynamics.events import Bound
from linkwork.dynamics.reduction import Forcing, Reduction
from linkwork.dynamics.sample import Sample
from linkwork.dynamics.travel import Travel
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import ExpressionError, InputError, MechanismError, Problem
from linkwork.foundation.plain_numbers import as_told, finite_number
from linkwork.foundation.policy import ChangePointPolicy
from linkwork.foundation.status import Status
from linkwork.foundation.value_types import check_flags
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.mechanism.speed import speed_per_second
from linkwork.motion.in_time import model_in_time
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.motion.solving import solve
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Motion

__all__ = ["Start", "simulate", "start_of"]

_ROWS = 400
_MOST_ROWS = 10_000_000
Start = tuple[Reduction, PositionCurve]


def simulate(
    model: Model,
    *,
    until: float,
    step: float | None = None,
    at: float | Mapping[str, float] | None = None,
    start_speed: Number = 0,
    change_points: str | ChangePointPolicy = ChangePointPolicy.STOP,
    certify: bool = True,
    forcing: Sequence[Forcing] = (),
    progress: Callable[[float], None] | None = None,
) -> Motion:
    """The motion in time under masses, loads, springs and a motor.

    Parameters
    ----------
    until : float
        The last time [s].
    step : float, optional
        Between rows [s]; by default 400 rows.
    at : number, optional
        The input value at the start, in file units; by default that of the guess.
    start_speed : str or number
        Of the input: ``"60 rad/s"``; a number is in file units per second.
    change_points : str
        ``stop`` at change points, or go ``straight`` on.
    certify : bool
        Prove the positions of all rows.
    forcing : sequence of Forcing
        Further generalised forces.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Raises
    ------
    InputError
        If nothing has mass, the mechanism has not one input, or a law drives it.
    """
    check_flags(progress, certify=certify)
    times = _times(until, step)
    policy = ChangePointPolicy.of(change_points)
    if policy is ChangePointPolicy.TURN:
        raise InputError('a simulation goes straight on or stops: change_points "stop", "straight"')
    speed = _start_speed(model, start_speed)
    reduction, curve = start_of(model, at, policy, certify, forcing)
    travel = Travel(
        curve=curve,
        reduction=reduction,
        bounds=_bounds(reduction.named),
        times=times,
        progress=progress,
    )
    _check_inside(travel)
    travel.begin(speed)
    travel.run()
    return _motion(travel, certify)


def start_of(
    model: Model,
    at: float | Mapping[str, float] | None,
    policy: ChangePointPolicy,
    certify: bool,
    forcing: Sequence[Forcing] = (),
) -> Start:
    """The loads, and the curve of positions through the start."""
    _check(model)
    position = solve(model, at, certify=False, throw=True)
    there = model.from_position(position)
    start = there.equations.start.copy()
    return Reduction(model, model_in_time(model), forcing), curve_of(model, start, policy, certify)


def _check(model: Model) -> None:
    description = model.description
    name = f"“{description.name}”".replace("“", '"').replace("”", '"')
    if not isinstance(description, LoadedBodies):
        raise InputError(f"{name} has plain equations: only links have masses")
    if description.timed:
        raise InputError(f"a law drives {name}: leave it out to simulate")
    if len(description.inputs) != 1:
        raise InputError(
            f"{name} has {len(description.inputs)} inputs: a simulation needs one degree of freedom"
        )
    if not description.masses and description.inputs[0].inertia is None:
        raise InputError(f"nothing in {name} has mass: add [masses], or inertia to the input")


def _times(until: float, step: float | None) -> Array:
    until = finite_number("until", until)
    if until <= 0.0:
        raise InputError(f"until must be a positive time, got {as_told(until)}")
    if step is None:
        return np.linspace(0.0, until, _ROWS + 1)[1:]
    step = finite_number("step", step)
    if step <= 0.0 or until / step > _MOST_ROWS:
        raise InputError(f"step must be a positive part of until, got {as_told(step)}")
    count = int(np.floor(until / step + 1e-9))
    times = step * np.arange(1.0, count + 1)
    return times if abs(times[-1] - until) < 1e-9 * step else np.append(times, until)


def _start_speed(model: Model, given: Number) -> float:
    description = model.description
    if not description.inputs:
        return 0.0
    kind = description.inputs[0].drives[0]
    try:
        own = speed_per_second(given, kind, description.numbers, description.length)
    except ExpressionError as error:
        raise InputError(f"start speed: {error.message}") from None
    return own * float(model.input_scale[0])


def _bounds(named: Model) -> list[Bound]:
    description = named.description
    assert isinstance(description, LoadedBodies)
    found, problems = [], []
    numbers = description.numbers
    for k, stop in enumerate(description.stops):
        own = named.motion_quantities
        try:
            asked = own.find(stop.of)
        except InputError as error:
            problems.append(Problem(key=("stops", k, "of"), message=str(error)))
            continue
        for value, side in ((stop.start, 1.0), (stop.stop, -1.0)):
            if value is not None:
                found.append(
                    Bound(
                        stop=stop,
                        asked=asked,
                        value=numbers(value),
                        side=side,
                        restitution=numbers(stop.restitution),
                    )
                )
    if problems:
        raise MechanismError(problems, f'mechanism "{description.name}"')
    return found


def _check_inside(travel: Travel) -> None:
    here, still = np.array([travel.s]), np.zeros(1)
    for bound in travel.bounds:
        margin = float(bound.margin(travel.leg, here, still, still, travel.gain)[0])
        if margin < 0.0:
            value = bound.value + bound.side * margin
            raise InputError(
                f"{bound.asked.name} begins at {value:.6g}, beyond its stop at {bound.value:g}"
            )


def _motion(travel: Travel, certify: bool) -> Motion:
    named = travel.reduction.named
    samples = [*travel.samples]
    if travel.ended:
        now = travel.t, travel.s, travel.speed
        last = Sample(
            t=now[0], leg=travel.number, lap=travel.lap, s=now[1], speed=now[2],
            acceleration=np.nan, event="end", lost=travel.lost,
        )  # fmt: skip
        samples.append(last)
    rows = _rows(travel, samples, certify)
    missing = travel.times[travel.taken :]
    if len(missing):
        blank = SolvedRows.blank(missing[:, None], rows.v.shape[1], Status.OUT_OF_REACH)
        rows = SolvedRows.concatenate([rows, blank.with_columns(v=blank.v)])
    added = np.array([*(bool(sample.event) for sample in samples), *([False] * len(missing))])
    told = f"simulated to t = {travel.t:.10g} s"
    if travel.held is not None:
        told += f"; at rest since t = {travel.held:.10g} s, held by {travel.holder}"
    if travel.ended:
        told = f"the motion ends at t = {travel.t:.10g} s: {travel.ended}"
    motion = motion_of_rows(named, rows, told, added)
    if not travel.reduction.rubs:
        return motion
    lost = np.array([*(sample.lost for sample in samples), *([np.nan] * len(missing))])
    return replace(motion, friction_work=lost)


def _rows(travel: Travel, samples: Sequence[Sample], certify: bool) -> SolvedRows:
    """The positions of samples, solved again, with their rates in time."""
    parts, order = [], []
    for number in sorted({sample.leg for sample in samples}):
        mine = [k for k, sample in enumerate(samples) if sample.leg == number]
        order += mine
        own = [samples[k] for k in mine]
        s = np.array([sample.s for sample in own])
        rows = travel.curve.legs[number].rows(s, certify)
        speed, bend, t, lap = (
            np.array([getattr(sample, name) for sample in own])[:, None]
            for name in ("speed", "acceleration", "t", "lap")
        )
        one = np.ones_like(t)
        parts.append(
            rows.with_columns(
                v=np.hstack([rows.v + lap * travel.curve.gain, t]),
                first=np.hstack([rows.first * speed, one]),
                second=np.hstack([rows.second * speed**2 + rows.first * bend, 0.0 * one]),
                inputs=t.copy(),
                branch=np.full(len(own), travel.reduction.model.circuit, dtype=object),
                limit=np.array([sample.event for sample in own], dtype=object),
            )
        )
    names = set.intersection(*(set(part.columns) for part in parts))
    wanted = {
        "inputs", "v", "first", "second", "status", "iterations", "residual", "condition",
        "certification", "radius", "uniqueness_radius", "branch", "limit",
    }  # fmt: skip
    kept = [SolvedRows(**{name: part.columns[name] for name in names & wanted}) for part in parts]
    return SolvedRows.concatenate(kept).take(np.argsort(order, kind="stable"))
