"""Simulation of a mechanism with several inputs, free or driven by laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from linkwork.dynamics.energy import watch_energy
from linkwork.dynamics.input_dynamics import InputDynamics
from linkwork.dynamics.input_travel import InputTravel
from linkwork.dynamics.reduction import Reduction
from linkwork.dynamics.simulated import (
    bounds_of,
    check_masses_move,
    model_name,
    start_speeds,
    with_stops,
)
from linkwork.equations.input_motion import law_motions
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError, KeyWords
from linkwork.foundation.names import canonical
from linkwork.foundation.policy import ChangePointPolicy
from linkwork.foundation.status import Status
from linkwork.mechanism.dimensions import Number
from linkwork.motion.in_time import model_in_time
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.motion.solving import solve
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Motion

__all__ = ["simulate_inputs"]


def simulate_inputs(
    model: Model,
    *,
    times: Array,
    at: float | Mapping[str, float] | None,
    start_speed: Number | Mapping[str, Number],
    policy: ChangePointPolicy,
    certify: bool,
    forced: bool,
    place: KeyWords,
    progress: Callable[[float], None] | None,
) -> Motion:
    """The motion of several inputs at times (B,): some may have laws, the others are free.

    Raises
    ------
    InputError
        For friction, further forces, motions straight across change points, and a start at which
        an input moves no mass.
    """
    name = f"{model_name(model)} has {len(model.description.inputs)} inputs"
    if policy is not ChangePointPolicy.STOP:
        raise InputError(f"{name}: their simulation stops at change points, leave out {policy}")
    if forced:
        raise InputError(f"{name}: further forces are added to one input only")
    speeds = start_speeds(model, start_speed)
    start = _start(model, at)
    reduction = Reduction(model, model_in_time(model), place=place)
    if reduction.rubs:
        raise InputError(f"{name}: friction is simulated with one input only, leave out [friction]")
    dynamics = InputDynamics(reduction, start.equations.start.copy())
    inputs = dynamics.inputs
    inputs.check(model, float(times[-1]))
    check_masses_move(model, dynamics.masses())
    travel = InputTravel(
        dynamics=dynamics,
        bounds=bounds_of(reduction.named),
        times=times,
        speed=(speeds / dynamics.size)[inputs.free],
        certify=certify,
        progress=progress,
    )
    beyond = travel.check_inside()
    if beyond is not None:
        bound, value = beyond
        raise InputError(
            f"{bound.asked.name} begins at {value:.6g}, beyond its stop at {bound.value:g}: "
            f"{place(bound.key)}"
        )
    travel.run()
    return _motion(travel)


def _start(model: Model, at: float | Mapping[str, float] | None) -> Model:
    """The mechanism at its start: driven inputs where their laws begin."""
    if not model.description.timed:
        return model.from_position(solve(model, at, certify=False, throw=True))
    names = [variable.name for variable in model.equations.inputs]
    laws = law_motions(model.equations, model.description)
    if at is not None and not isinstance(at, Mapping):
        raise InputError(f"name the input that begins at {at:g}, for example {names[0]}={at:g}")
    known = {canonical(name): value for name, value in (at or {}).items()}
    values = {}
    for name, own, law, scale in zip(
        names, model.start_inputs, laws, model.input_scale, strict=True
    ):
        if law is not None and canonical(name) in known:
            raise InputError(f"a law drives {name}, which begins where the law does: leave it out")
        here = own if law is None else law[0] + float(law[1].jet(np.zeros(1))[0][0])
        values[name] = known.pop(canonical(name), here / scale)
    # names of no input are refused with the others
    return model.from_position(solve(model, {**values, **known}, certify=False, throw=True))


def _motion(travel: InputTravel) -> Motion:
    rows, added = SolvedRows.concatenate(travel.rows), list(travel.added)
    missing = travel.times[travel.taken :]
    if len(missing):
        blank = SolvedRows.blank(missing[:, None], rows.v.shape[1], Status.OUT_OF_REACH)
        rows = SolvedRows.concatenate([rows, blank.with_columns(v=blank.v)])
        added += [False] * len(missing)
    told = f"simulated to t = {travel.t:.10g} s"
    if travel.ended:
        model = travel.dynamics.reduction.model
        q = travel.dynamics.inputs.complete(travel.q[None], np.array([travel.t]), 0)[0]
        values = q * travel.dynamics.size / model.input_scale
        inputs = model.equations.inputs
        place = ", ".join(
            f"{variable.name} = {value:.6g} {model.input_units[variable.name]}".rstrip()
            for variable, value in zip(inputs, values, strict=True)
        )
        told = f"the motion ends at t = {travel.t:.10g} s, {place}: {travel.ended}"
    motion = motion_of_rows(travel.dynamics.reduction.named, rows, told, np.array(added))
    pushes, impulses = (np.concatenate(parts) for parts in (travel.pushes, travel.impulses))
    motion = with_stops(motion, travel.bounds, pushes, impulses)
    return watch_energy(motion, travel.dynamics.reduction)
