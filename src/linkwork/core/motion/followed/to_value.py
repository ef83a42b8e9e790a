"""Follow the branch of a position to another input value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork import wings
from linkwork.core.foundation.arrays import EPSILON, Array
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.following import Drive, Lap, lap_of, leading_scale, track_to, turns_freely
from linkwork.core.motion.limits import BranchEnd, ends_of
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import SolvedPosition, prove_rows, unproved
from linkwork.core.numerics.branch_tracking import InputPath, Node, Track, node_at, rows_on_track
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.results.failure import Failure, Limit
from linkwork.core.results.position import Certificate


@dataclass(frozen=True, kw_only=True)
class OutOfReach:
    """The branch ends before the value asked; ``failure`` explains it."""

    status: Status
    failure: Failure | None


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
    inputs = target * model.input_scale
    span = inputs - origin
    weights = solver.variable_scale[solver.unknowns :]
    lead = int(np.argmax(np.abs(span / weights)))
    # the input that moves most in its weight leads, so that no rate is infinite
    rate = span / span[lead]
    path = InputPath(
        origin=origin - rate * origin[lead], rate=rate, size=leading_scale(model, lead)
    )
    first = node_at(solver, path, float(origin[lead]), v)
    drive = Drive(model=model, path=path, lead=lead)
    lap = lap_of(drive, first, inputs[lead : lead + 1])
    once = None if lap is None else _on_lap(lap, target, certify)
    return once or _on_branch(drive, first, target, certify)


def _on_lap(lap: Lap, target: Array, certify: bool) -> SolvedPosition | None:
    """The position at a value (1,) laps away; ``None`` if the branch ends on the lap after all."""
    solver, path = lap.drive.solver, lap.drive.path
    number = np.append(lap.number_of(target), 0.0)
    nearer = lap.nearer(target, number[:1])
    t = np.append(nearer * lap.drive.unit, lap.end.t)  # the second row closes the lap
    track = track_to(solver, path, lap.begin, t.tolist())
    if track.ends:
        return None
    rows = rows_on_track(solver, path, track, t)
    asked = np.append(lap.intended(nearer), lap.end.t)[:, None]
    rows = _with_proofs(lap.drive, track, rows, asked, certify)
    rows = lap.after(rows, number, lap.leads_back(rows.take(slice(1, 2))))
    return _solved(rows, track)


def _on_branch(
    drive: Drive, first: Node, target: Array, certify: bool
) -> SolvedPosition | OutOfReach:
    """The position at a value (p,), whole turns nearer or the other way around if need be."""
    model, solver, path = drive.model, drive.solver, drive.path
    goal = float(target[drive.lead] * drive.unit)
    limits: tuple[Limit, ...] = ()
    for turns in _turns_away(model, goal - first.t):
        t = goal - turns * FULL_TURN
        track = track_to(solver, path, first, [t])
        asked = target - (turns * model.units.angle.turn if turns else 0.0)
        if not track.ends:
            break
        ends = ends_of(drive, track, certify)
        for end in ends:
            if end.is_at(t, 4.0 * EPSILON * max(abs(goal), abs(t))):
                return _at_end(drive, end, track, certify)
        met = [end.limit for end in ends]
        limits += tuple(limit for limit in met if limit.input not in [old.input for old in limits])
    else:
        reasons = {limit.status for limit in limits}
        status = reasons.pop() if len(reasons) == 1 else limits[0].status
        way = (path, drive.lead, goal)
        failure = wings.use("circuits.failure.failing").beyond_reach(
            model, first.v, way, status, limits
        )
        return OutOfReach(status=status, failure=failure)
    rows = rows_on_track(solver, path, track, np.array([t]))
    asked = (asked * model.input_scale)[None, :]
    return _solved(_with_proofs(drive, track, rows, asked, certify), track)


def _with_proofs(
    drive: Drive, track: Track, rows: SolvedRows, asked: Array, certify: bool
) -> SolvedRows:
    """Rows on a track with their evidence, ``asked`` (B, p) in internal units."""
    if not certify:
        return unproved(rows, Certification.NOT_ASKED)
    return prove_rows(drive.solver, drive.path, track, rows, asked)[0]


def _solved(rows: SolvedRows, track: Track) -> SolvedPosition:
    """The first of some rows."""
    return SolvedPosition(
        v=rows.v[0],
        status=Status.of_code(int(rows.status[0])),
        residual=float(rows.residual[0]),
        iterations=int(rows.iterations[0]) + sum(node.iterations for node in track.nodes),
        certificate=_certificate(
            Certification.of_code(int(rows.certification[0])),
            rows.radius[0],
            rows.uniqueness_radius[0],
        ),
    )


def _at_end(drive: Drive, end: BranchEnd, track: Track, certify: bool) -> SolvedPosition:
    """The position at the end of the branch, which is where the value asked lies."""
    solver, v = drive.solver, end.v
    assert v is not None
    if certify and end.certification is Certification.CERTIFIED:
        last = track.nodes[-1] if end.side > 0 else track.nodes[0]
        rows = rows_on_track(solver, drive.path, track, np.array([last.t]))
        _, to_ends = prove_rows(solver, drive.path, track, rows, drive.path.at(rows.t))
        end = end if to_ends else end.demote(Certification.MOTION_NOT_PROVED)
    return SolvedPosition(
        v=v,
        status=Status.CONVERGED,
        residual=float(solver.residual(v[None, :])[0]),
        iterations=sum(node.iterations for node in track.nodes),
        certificate=_certificate(end.certification, end.radius, end.uniqueness_radius),
        first=end.first,
    )


def _certificate(certification: Certification, radius: float, room: float) -> Certificate:
    return Certificate(
        certification=certification, radius=_known(radius), unique_within=_known(room)
    )


def _known(number: float) -> float | None:
    return float(number) if np.isfinite(number) else None


def _turns_away(model: Model, way: float) -> list[int]:
    """By how many whole turns to come short of a value this far away [rad], in order of trial."""
    if not turns_freely(model):
        return [0]
    whole = int(way / (FULL_TURN))
    # the straight way first, then short of it by whole turns, then the other way around
    return list(dict.fromkeys([0, whole, whole + int(np.copysign(1.0, way))]))
