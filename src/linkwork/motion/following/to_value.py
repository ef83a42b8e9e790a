"""Follow the branch of a position to another input value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.status import Status
from linkwork.motion import failure as why
from linkwork.motion.drive import Drive
from linkwork.motion.following.whole_turns import Laps, laps_to
from linkwork.motion.limits import BranchEnd, ends_of
from linkwork.motion.model import Model
from linkwork.motion.positions import SolvedPosition
from linkwork.motion.proving import prove_rows
from linkwork.motion.tracking import leading_scale, track_to, turns_freely
from linkwork.numerics.continuation.branch_tracking import (
    InputPath,
    Track,
    node_at,
    rows_on_track,
)
from linkwork.numerics.rows import SolvedRows
from linkwork.results.failure import Failure
from linkwork.results.motion import Limit
from linkwork.results.position import Certificate

__all__ = ["OutOfReach", "follow_to_value"]


@dataclass(frozen=True, kw_only=True)
class OutOfReach:
    """The branch ends before the value asked; ``failure`` explains it."""

    status: Status
    failure: Failure | None


@dataclass(frozen=True, kw_only=True, eq=False)
class _PlaceOnTrack:
    """Where on a track the position lies; ``asked`` (p,): the input values meant there, file
    units, whole turns aside.
    """

    path: InputPath
    track: Track
    asked: Array


def follow_to_value(
    model: Model, v: Array, target: Array, certify: bool
) -> SolvedPosition | OutOfReach:
    """The position at another input value, along the straight line from the guess's inputs.

    Parameters
    ----------
    v : (N,)
        The position at the guess's own input value.
    target : (p,)
        The value asked, in file units.
    """
    solver = model.compiled.solver
    origin = model.start_inputs
    laps = laps_to(model, v, target)
    asked = target if laps is None else laps.inputs
    inputs = asked * model.input_scale
    span = inputs - origin
    weights = solver.variable_scale[solver.unknowns :]
    lead = int(np.argmax(np.abs(span / weights)))
    # the input that moves most in its weight leads, so that no rate is infinite
    rate = span / span[lead]
    path = InputPath(
        origin=origin - rate * origin[lead], rate=rate, size=leading_scale(model, lead)
    )
    first = node_at(solver, path, float(origin[lead]), v)
    goal = float(inputs[lead])
    limits: tuple[Limit, ...] = ()
    drive = Drive(model=model, path=path, lead=lead)
    for turns in _turns_away(model, goal - first.t):
        t = goal - turns * 2.0 * np.pi
        track = track_to(solver, path, first, [t])
        place = _PlaceOnTrack(
            path=path,
            track=track,
            asked=asked - (turns * model.units.angle.turn if turns else 0.0),
        )
        if not track.ends:
            break
        ends = ends_of(drive, track, certify)
        for end in ends:
            if end.is_at(t, 4.0 * EPSILON * max(abs(goal), abs(t))):
                return _at_end(model, end, place, laps, certify)
        met = [end.limit for end in ends]
        limits += tuple(limit for limit in met if limit.input not in [old.input for old in limits])
    else:
        reasons = {limit.status for limit in limits}
        status = reasons.pop() if len(reasons) == 1 else limits[0].status
        failure = why.beyond_reach(model, v, (path, lead, goal), status, limits)
        return OutOfReach(status=status, failure=failure)
    rows = rows_on_track(solver, path, track, np.array([t]))
    return SolvedPosition(
        v=rows.v[0] if laps is None else rows.v[0] + laps.gain,
        status=Status.of_code(int(rows.status[0])),
        residual=float(rows.residual[0]),
        iterations=int(rows.iterations[0]) + sum(node.iterations for node in track.nodes),
        certificate=_certificate(model, place, rows, laps) if certify else Certificate(),
    )


def _at_end(
    model: Model, end: BranchEnd, place: _PlaceOnTrack, laps: Laps | None, certify: bool
) -> SolvedPosition:
    """The position at the end of the branch, which is where the value asked lies."""
    solver, track, v = model.compiled.solver, place.track, end.v
    assert v is not None
    if certify and end.certification is Certification.CERTIFIED:
        last = track.nodes[-1] if end.side > 0 else track.nodes[0]
        rows = rows_on_track(solver, place.path, track, np.array([last.t]))
        _, to_ends = prove_rows(solver, place.path, track, rows, place.path.at(rows.t))
        proved = to_ends and (laps is None or laps.proved)
        end = end if proved else end.demote(Certification.MOTION_NOT_PROVED)
    return SolvedPosition(
        v=v if laps is None else v + laps.gain,
        status=Status.CONVERGED,
        residual=float(solver.residual(v[None, :])[0]),
        iterations=sum(node.iterations for node in track.nodes),
        certificate=Certificate(
            certification=end.certification,
            radius=_known(end.radius),
            unique_within=_known(end.uniqueness_radius),
        ),
        first=end.first,
    )


def _known(number: float) -> float | None:
    return float(number) if np.isfinite(number) else None


def _turns_away(model: Model, way: float) -> list[int]:
    """By how many whole turns to come short of a value this far away [rad], in order of trial."""
    if not turns_freely(model):
        return [0]
    whole = int(way / (2.0 * np.pi))
    # the straight way first, then short of it by whole turns, then the other way around
    return list(dict.fromkeys([0, whole, whole + int(np.copysign(1.0, way))]))


def _certificate(
    model: Model, place: _PlaceOnTrack, rows: SolvedRows, laps: Laps | None
) -> Certificate:
    """Of the position and of the way to it."""
    asked = (place.asked * model.input_scale)[None, :]
    rows, _ = prove_rows(model.compiled.solver, place.path, place.track, rows, asked)
    proved = bool(np.isfinite(rows.radius[0]))
    certification = Certification.of_code(int(rows.certification[0]))
    if certification is Certification.CERTIFIED and laps is not None and not laps.proved:
        certification = Certification.MOTION_NOT_PROVED
    return Certificate(
        certification=certification,
        radius=float(rows.radius[0]) if proved else None,
        unique_within=float(rows.uniqueness_radius[0]) if proved else None,
    )
