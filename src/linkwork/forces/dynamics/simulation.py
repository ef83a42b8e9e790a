"""Simulation: the motion in time of a mechanism from its start under its loads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, KeyWords, key_text
from linkwork.core.foundation.statuses import ChangePointPolicy
from linkwork.core.foundation.values import as_told, check_flags, finite_number
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.motion.higher_rates import model_in_time
from linkwork.core.motion.model import Model
from linkwork.core.motion.rows_between import motion_of_rows
from linkwork.core.motion.solving import solve
from linkwork.core.numerics.system import SolvedRows
from linkwork.core.results.motion import Motion
from linkwork.forces.dynamics.contacts import SimulatedRows, finished_motion, with_contacts
from linkwork.forces.dynamics.curve import PositionCurve, curve_of
from linkwork.forces.dynamics.events import Sample
from linkwork.forces.dynamics.reduction import Reduction
from linkwork.forces.dynamics.several_inputs import simulate_inputs
from linkwork.forces.dynamics.simulated import (
    bounds_of,
    check_loaded,
    start_speeds,
    straight_or_stop,
)
from linkwork.forces.dynamics.travel import Travel

_ROWS = 400
_MOST_ROWS = 10_000_000
_LEAST = 1e-100  # seconds: the square of a short step does not vanish
_WEIGHTLESS = 1e-14  # of the largest inertia on a leg: none, to the rounding of its polynomials
Start = tuple[Reduction, PositionCurve]


def simulate(
    model: Model,
    *,
    until: float,
    step: float | None = None,
    at: float | Mapping[str, float] | None = None,
    start_speed: Number | Mapping[str, Number] = 0,
    change_points: str | ChangePointPolicy = ChangePointPolicy.STOP,
    certify: bool = True,
    place: KeyWords = key_text,
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
    start_speed : str, number or Mapping[str, str or number]
        Of the input: ``"60 rad/s"``; a number is in file units per second. Of several by name;
        those that are not named begin at rest.
    change_points : str
        ``stop`` at change points, or go ``straight`` on.
    certify : bool
        Prove the positions of all rows.
    place : callable
        Words the key of a load that has no value.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Raises
    ------
    InputError
        If nothing has mass, the mechanism has no input, laws drive all inputs, or it has several
        inputs and friction.
    """
    check_flags(progress, certify=certify)
    times = _times(until, step)
    policy = straight_or_stop(change_points)
    check_loaded(model)
    if len(model.description.inputs) > 1:
        several = simulate_inputs(
            model.untimed or model, times=times, at=at, start_speed=start_speed, policy=policy,
            certify=certify, place=place, progress=progress,
        )  # fmt: skip
        return with_contacts(model, several)
    speed = float(start_speeds(model, start_speed)[0])
    reduction, curve = start_of(model, at, policy, certify, place)
    travel = Travel(
        curve=curve,
        reduction=reduction,
        bounds=bounds_of(reduction.named),
        times=times,
        progress=progress,
    )
    _check_inside(travel)
    _check_inertia(travel)
    travel.begin(speed)
    travel.run()
    return with_contacts(model, _motion(travel, certify), *_states(travel))


def start_of(
    model: Model,
    at: float | Mapping[str, float] | None,
    policy: ChangePointPolicy,
    certify: bool,
    place: KeyWords = key_text,
) -> Start:
    """The loads, and the curve of positions through the start."""
    check_loaded(model)
    position = solve(model, at, certify=False, throw=True)
    there = model.from_position(position)
    start = there.equations.start.copy()
    reduction = Reduction(model, model_in_time(model), place)
    return reduction, curve_of(model, start, policy, certify)


def _times(until: float, step: float | None) -> Array:
    until = finite_number("until", until)
    if until <= 0.0:
        raise InputError(f"until must be a positive time, got {as_told(until)}")
    if until < _LEAST:
        raise InputError(f"until must be at least {_LEAST:g} s, got {as_told(until)}")
    if step is None:
        return np.linspace(0.0, until, _ROWS + 1)[1:]
    step = finite_number("step", step)
    count = int(np.floor(min(until / step, _MOST_ROWS + 1) + 1e-9)) if step > 0.0 else 0
    if not 1 <= count <= _MOST_ROWS:
        raise InputError(
            f"step must be a part of until, {until:g} s, that makes 1 to {_MOST_ROWS} rows, "
            f"got {as_told(step)}"
        )
    times = step * np.arange(1.0, count + 1)
    return times if abs(times[-1] - until) < 1e-9 * step else np.append(times, until)


def _check_inside(travel: Travel) -> None:
    here, still = np.array([travel.s]), np.zeros(1)
    for bound in travel.bounds:
        if bound.is_beyond(travel.leg, travel.s, 0.0, travel.gain):
            margin = float(bound.margin(travel.leg, here, still, still, travel.gain)[0])
            raise bound.passed_at_start(margin, travel.reduction.place)


def _check_inertia(travel: Travel) -> None:
    here, largest = (
        float(travel.leg.numbers(s)[:, 0].max())
        for s in (np.array([travel.s]), travel.leg.table.edges)
    )
    if here <= _WEIGHTLESS * largest:
        raise InputError(
            "no body with mass moves at the start, as at a dead point of a massless crank: start "
            "at another input, or give the crank a mass"
        )


def _motion(travel: Travel, certify: bool) -> Motion:
    if travel.ended:
        travel.record_end()
    samples, missing = travel.samples, travel.times[travel.taken :]
    told = f"simulated to t = {travel.t:.10g} s"
    if travel.held is not None:
        held = f"held by {travel.holder}" if travel.holder else "in equilibrium"
        told += f"; at rest since t = {travel.held:.10g} s, {held}"
    if travel.ended:
        told = f"the motion ends at t = {travel.t:.10g} s: {travel.ended}"
    pushes, impulses = np.zeros((2, len(samples), len(travel.bounds)))
    for k, sample in enumerate(samples):
        if sample.stop >= 0:
            pushes[k, sample.stop], impulses[k, sample.stop] = sample.push, sample.impulse
    motion = finished_motion(
        travel.reduction,
        SimulatedRows(
            rows=_rows(travel, samples, certify),
            added=[bool(sample.event) for sample in samples],
            pushes=pushes,
            impulses=impulses,
        ),
        travel.bounds,
        missing,
        told,
    )
    if not travel.reduction.rubs:
        return motion
    lost = np.array([*(sample.lost for sample in samples), *([np.nan] * len(missing))])
    return replace(motion, friction_work=lost)


def _states(travel: Travel) -> tuple[Array, Callable[[Array], Motion]]:
    """Times while the motion moves, at all nodes of its steps, and the motion at such times."""
    nodes = [step.nodes[step.nodes <= end] for _, _, step, end in travel.steps]
    ends = np.array([end for _, _, _, end in travel.steps])

    def at(times: Array) -> Motion:
        samples = []
        for t in times:
            number, lap, step, _ = travel.steps[min(int(ends.searchsorted(t)), len(ends) - 1)]
            s, speed, bend = (float(x[0]) for x in step.at(np.array([t])))
            samples.append(
                Sample(t=float(t), leg=number, lap=lap, s=s, speed=speed, acceleration=bend)
            )
        rows = _rows(travel, samples, False)
        return motion_of_rows(travel.reduction.named, rows, "", np.ones(len(times), dtype=bool))

    return np.concatenate([*nodes, np.zeros(0)]), at


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
    return SolvedRows.concatenate(parts).take(np.argsort(order, kind="stable"))
