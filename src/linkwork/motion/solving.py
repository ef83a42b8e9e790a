"""One position at one input value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import NotConvergedError
from linkwork.foundation.status import Status
from linkwork.motion import failure as why
from linkwork.motion.model import Model
from linkwork.motion.positions import (
    Evidence,
    found_message,
    input_rate,
    position_of,
    target_values,
)
from linkwork.motion.proving import prove_rows
from linkwork.motion.reading import named_series
from linkwork.motion.start import Start, first_position
from linkwork.motion.tracking import leading_scale, track_to, turns_freely
from linkwork.motion.whole_turns import laps_to
from linkwork.numerics.newton import NewtonOptions
from linkwork.numerics.track import InputPath, Rows, Track, node_at, rows_on_track
from linkwork.results.failure import Failure
from linkwork.results.motion import Limit
from linkwork.results.position import Certificate, Position

__all__ = ["solve"]


def solve(
    model: Model,
    at: float | Mapping[str, float] | None = None,
    *,
    from_guess: bool = False,
    options: NewtonOptions | None = None,
    certify: bool = True,
    with_steps: bool = False,
    throw: bool = False,
) -> Position:
    """The position at one input value.

    Newton-Raphson finds the position at the guess's own input value; the branch is then followed
    to the value asked, and the other way around if a limit is met on the way.

    Parameters
    ----------
    at : number or Mapping[str, number], optional
        Input value(s) in everyday units; the guess's own if left out.
    from_guess : bool
        Start Newton-Raphson at the asked value directly, as the textbook's example does.
    certify : bool
        Prove the position, and that the motion to it stays on the guess's branch.
    with_steps : bool
        Keep the iterates.
    throw : bool
        Raise instead of returning a position that was not found.

    Raises
    ------
    UnknownNameError, InputError
        For input values that do not fit the mechanism.
    NotConvergedError
        Only with ``throw``.
    """
    options = options or NewtonOptions()
    target = target_values(model, at)
    inputs = target * model.input_scale
    start = first_position(model, inputs if from_guess else model.start_inputs, options, with_steps)
    if not start.status.ok:
        failure = start.failure
        if (
            failure is not None
            and not from_guess
            and not np.array_equal(inputs, model.start_inputs)
        ):
            failure = why.without_start(model, failure, inputs)
        position = _failed(model, target, start.status, failure, start)
    elif from_guess or np.array_equal(inputs, model.start_inputs):
        position = _arrived(model, target, start, certify)
    else:
        position = _followed(model, target, start, certify)
    if throw and not position.status.ok:
        raise NotConvergedError(position.message)
    return position


@dataclass(frozen=True, kw_only=True, eq=False)
class _Place:
    """Where on a track the position lies, as a batch of one row.

    ``asked`` (p,): the input values meant there, everyday units, whole turns aside. ``gain`` (N,):
    what whole turns that were left out add to the variables; ``joined``: whether they are proved.
    """

    path: InputPath
    track: Track
    rows: Rows
    asked: Array
    gain: Array | None = None
    joined: bool = True


def _arrived(model: Model, target: Array, start: Start, certify: bool) -> Position:
    """The start itself is the position asked for."""
    solver = model.compiled.solver
    own = start.v[solver.unknowns :]
    lead = int(np.argmax(input_rate(model) == 1.0)) if len(own) else 0
    t = float(own[lead]) if len(own) else 0.0
    path = InputPath(origin=own - input_rate(model) * t, rate=input_rate(model))
    node = node_at(solver, path, t, start.v)
    rows = Rows(
        t=np.array([t]),
        v=start.v[None, :],
        status=np.array([Status.CONVERGED.code], dtype=np.int8),
        iterations=np.array([start.iterations]),
        residual=np.array([start.residual]),
        rates=solver.rates(start.v[None, :], input_rate(model)),
    )
    track = Track(nodes=(node,), start=0)
    place = _Place(path=path, track=track, rows=rows, asked=target)
    return _from_row(model, target, place, start, certify, _other_root(model, start.v))


def _followed(model: Model, target: Array, start: Start, certify: bool) -> Position:
    """Along the straight line from the guess's inputs to the target."""
    solver = model.compiled.solver
    origin = model.start_inputs
    laps = laps_to(model, start.v, target)
    asked = target if laps is None else laps.inputs
    inputs = asked * model.input_scale
    span = inputs - origin
    lead = int(np.argmax(np.abs(span / _input_weights(model))))
    rate = span / span[lead]
    path = InputPath(
        origin=origin - rate * origin[lead], rate=rate, size=leading_scale(model, lead)
    )
    first = node_at(solver, path, float(origin[lead]), start.v)
    goal = float(inputs[lead])
    limits: tuple[Limit, ...] = ()
    for turns in _turns_away(model, goal - first.t):
        t = goal - turns * 2.0 * np.pi
        track = track_to(solver, path, first, [t])
        if not track.ends:
            break
        met = why.limits_met(model, path, track, lead)
        limits += tuple(limit for limit in met if limit.input not in [old.input for old in limits])
    else:
        reasons = {limit.status for limit in limits}
        status = reasons.pop() if len(reasons) == 1 else limits[0].status
        failure = why.beyond_reach(model, start.v, (path, lead, goal), status, limits)
        return _failed(model, target, status, failure, start)
    rows = rows_on_track(solver, path, track, np.array([t]))
    rows.iterations[0] += start.iterations + sum(node.iterations for node in track.nodes)
    place = _Place(
        path=path,
        track=track,
        rows=rows,
        asked=asked - (turns * model.units.angle.turn if turns else 0.0),
        gain=None if laps is None else laps.gain,
        joined=laps is None or laps.proved,
    )
    return _from_row(model, target, place, start, certify)


def _turns_away(model: Model, way: float) -> list[int]:
    """By how many whole turns to come short of a value this far away [rad], in order of trial."""
    if not turns_freely(model):
        return [0]
    whole = int(way / (2.0 * np.pi))
    return list(dict.fromkeys([0, whole, whole + int(np.copysign(1.0, way))]))


def _other_root(model: Model, found: Array) -> Failure | None:
    """What to say of a position (N,) on the other side of the guess: det J has another sign."""
    solver = model.compiled.solver
    here = found.copy()
    here[: solver.unknowns] = model.equations.start[: solver.unknowns]
    for block in solver.blocks:
        both = np.stack([here, found])[:, block.variables]
        slopes = block.system.jacobian(both)[:, :, : len(block.unknowns)]
        if np.prod(np.sign(np.linalg.det(slopes))) <= 0.0:
            return why.another_root(model, found)
        here[block.unknowns] = found[block.unknowns]
    return None


def _input_weights(model: Model) -> Array:
    return model.compiled.solver.variable_scale[model.compiled.solver.unknowns :]


def _failed(
    model: Model, target: Array, status: Status, failure: Failure | None, start: Start
) -> Position:
    nothing = np.full((1, model.compiled.solver.variables), np.nan)
    named = named_series(model, nothing, nothing, nothing, target[None, :], np.zeros(1, dtype=bool))
    evidence = Evidence(
        status=status,
        message=status.value if failure is None else failure.message,
        residual=start.residual,
        iterations=start.iterations,
        condition=np.inf,
        certificate=Certificate(certification=Certification.NO_POSITION),
        trails=start.trails,
        failure=failure,
    )
    return position_of(model, named, 0, evidence, nothing[0, : model.compiled.solver.unknowns])


def _from_row(
    model: Model,
    target: Array,
    place: _Place,
    start: Start,
    certify: bool,
    failure: Failure | None = None,
) -> Position:
    """The one row of a batch as a position, with its certificate."""
    solver, rows = model.compiled.solver, place.rows
    certificate = Certificate()
    if certify:
        asked = (place.asked * model.input_scale)[None, :]
        proofs = prove_rows(solver, place.path, place.track, rows, asked)
        proved = bool(np.isfinite(proofs.radius[0]))
        certification = Certification.of_code(int(proofs.code[0]))
        if certification is Certification.CERTIFIED and not place.joined:
            certification = Certification.MOTION_NOT_PROVED
        certificate = Certificate(
            certification=certification,
            radius=float(proofs.radius[0]) if proved else None,
            unique_within=float(proofs.unique[0]) if proved else None,
        )
    status = Status.of_code(int(rows.status[0]))
    rates = solver.rates(rows.v, input_rate(model))
    found = np.array([status.ok])
    v = rows.v if place.gain is None else rows.v + place.gain
    named = named_series(model, v, rates.first, rates.second, target[None, :], found)
    evidence = Evidence(
        status=status,
        message=found_message(status, float(rates.condition[0]), failure),
        residual=float(rows.residual[0]),
        iterations=int(rows.iterations[0]),
        condition=float(rates.condition[0]),
        certificate=certificate,
        trails=start.trails,
        failure=failure,
    )
    return position_of(model, named, 0, evidence, v[0, : solver.unknowns])
