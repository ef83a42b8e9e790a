"""The curve of positions that a mechanism with one input can take, in legs with a leader each.

On a leg one variable, its leader, determines all others; at dead points of the input another one
leads (see :mod:`linkwork.numerics.continuation.curve_tracing`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from linkwork.dynamics.straight_turn import turn_of
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.certification import Certification
from linkwork.foundation.errors import InputError
from linkwork.foundation.policy import ChangePointPolicy
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.status import Status
from linkwork.motion.curve_branches import TracedCurve, trace_with_proof
from linkwork.motion.drive import Drive
from linkwork.motion.model import Model
from linkwork.numerics.continuation.branch_tracking import Track, rows_on_track
from linkwork.numerics.continuation.curve_tracing import Leg as TracedLeg
from linkwork.numerics.continuation.local_parametrization import whole_turns
from linkwork.numerics.proof.position_proof import prove
from linkwork.numerics.rows import SolvedRows

__all__ = ["Leg", "PositionCurve", "curve_of"]

_GAIN = 1e-9  # of the scale: a length that grew by more in a lap has really grown
_DOUBLINGS = 24  # of the longest link: how far an input length without unknowns may move


@dataclass(frozen=True, kw_only=True, eq=False)
class Leg:
    """A piece of the curve from the leader's value ``begin`` to ``end``.

    ``rows`` solves positions at values of the leader (B,): all variables in the mechanism's order,
    with derivatives by the leader; with proofs if asked.
    """

    lead: int
    begin: float
    end: float
    rows: Callable[[Array, bool], SolvedRows]


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionCurve:
    """Legs one after the other; ``home`` is the leg on which the start lies, ``value`` its place.

    ``gain`` (N,): what the variables of a closed curve gain in a lap. ``ends``: why an open curve
    ends before its first and behind its last leg.
    """

    legs: tuple[Leg, ...]
    home: int
    value: float
    closed: bool
    gain: Array
    ends: tuple[str, str] = ("", "")


def curve_of(model: Model, start: Array, policy: ChangePointPolicy, certify: bool) -> PositionCurve:
    """The curve through a position (N,) that the input leads to well."""
    drive = Drive.through(model, start[model.compiled.solver.unknowns :], np.ones(1), 0)
    if not model.equations.unknowns:
        return _without_unknowns(model, drive, start)
    if policy is ChangePointPolicy.STRAIGHT and drive.free:
        turn = turn_of(drive.leads, drive.solver, start)
        if turn is not None:
            leg = Leg(lead=len(start) - 1, begin=turn.begin, end=turn.end, rows=turn.rows)
            return PositionCurve(
                legs=(leg,), home=0, value=turn.begin, closed=True, gain=turn.gain(drive.leads)
            )
    ways = [trace_with_proof(drive.leads, start, 1.0, certify)]
    if not ways[0].curve.end.closed:
        ways.append(trace_with_proof(drive.leads, start, -1.0, certify))
    forward = [_leg(way_leg, ways[0]) for way_leg in ways[0].curve.legs]
    if ways[0].curve.end.closed:
        last = ways[0].curve.legs[-1]
        arrived = last.led.whole(last.nodes[-1].v)
        gain = FULL_TURN * whole_turns(drive.leads, start, arrived)
        grown = arrived - start
        lengths = ~drive.leads.is_angle & (np.abs(grown) > _GAIN * drive.leads.scale)
        gain = np.where(lengths, grown, gain)
        return PositionCurve(
            legs=tuple(forward), home=0, value=forward[0].begin, closed=True, gain=gain
        )
    backward = [_leg(way_leg, ways[1]) for way_leg in ways[1].curve.legs]
    turned = [
        Leg(lead=leg.lead, begin=leg.end, end=leg.begin, rows=leg.rows)
        for leg in reversed(backward)
    ]
    if not (forward or turned):
        raise InputError(
            "a simulation cannot start at a change point, where branches meet: start a little "
            "before or after it"
        )
    value = forward[0].begin if forward else turned[-1].end
    return PositionCurve(
        legs=(*turned, *forward),
        home=len(turned) if forward else len(turned) - 1,
        value=value,
        closed=False,
        gain=np.zeros(len(start)),
        ends=(ways[1].curve.end.value, ways[0].curve.end.value),
    )


def _leg(leg: TracedLeg, way: TracedCurve) -> Leg:
    led, nodes = leg.led, leg.nodes
    ordered = nodes if nodes[-1].t >= nodes[0].t else nodes[::-1]
    track = Track(nodes=tuple(ordered), start=0)

    def rows(values: Array, certify: bool) -> SolvedRows:
        found = rows_on_track(led.solver, led.path, track, values)
        columns = {name: led.whole(getattr(found, name)) for name in ("v", "first", "second")}
        if certify and led.provable:
            proof = prove(led.solver, found.v, 4.0 * EPSILON * np.abs(found.v[:, -1:]))
            standing = Certification.CERTIFIED if way.certified else Certification.MOTION_NOT_PROVED
            code = np.where(
                proof.holds, standing.code, Certification.POSITION_NOT_PROVED.code
            ).astype(np.int8)
            radius = np.where(proof.holds, proof.radius, np.nan)
            unique = np.where(proof.holds, proof.least_uniqueness_radius, np.nan)
        else:
            why = Certification.NO_BOUND if certify else Certification.NOT_ASKED
            code = np.full(len(values), why.code, dtype=np.int8)
            radius = unique = np.full(len(values), np.nan)
        return found.with_columns(
            **columns, certification=code, radius=radius, uniqueness_radius=unique
        )

    return Leg(lead=led.lead, begin=nodes[0].t, end=nodes[-1].t, rows=rows)


def _without_unknowns(model: Model, drive: Drive, start: Array) -> PositionCurve:
    """A driven link or slider alone: the input is the position."""
    value = float(start[0])
    angle = bool(model.compiled.table.is_angle[0])
    reach = 0.5 * FULL_TURN if angle else model.equations.length_scale

    def rows(values: Array, certify: bool) -> SolvedRows:
        v = np.asarray(values, dtype=float)[:, None]
        count, proved = len(v), Certification.CERTIFIED if certify else Certification.NOT_ASKED
        return SolvedRows(
            v=v.copy(),
            first=np.ones_like(v),
            second=np.zeros_like(v),
            status=np.full(count, Status.CONVERGED.code, dtype=np.int8),
            residual=np.zeros(count),
            iterations=np.zeros(count, dtype=np.int64),
            condition=np.ones(count),
            certification=np.full(count, proved.code, dtype=np.int8),
            radius=np.zeros(count),
            uniqueness_radius=np.full(count, np.inf),
        )

    if angle:
        leg = Leg(lead=0, begin=value - reach, end=value + reach, rows=rows)
        gain = np.full(1, FULL_TURN)
        return PositionCurve(legs=(leg,), home=0, value=value, closed=True, gain=gain)
    # every leg is twice as far as the one before, so that its tables resolve what is near
    edges = value + reach * np.concatenate(
        [-(2.0 ** np.arange(_DOUBLINGS))[::-1], 2.0 ** np.arange(_DOUBLINGS)]
    )
    legs = [Leg(lead=0, begin=a, end=b, rows=rows) for a, b in pairwise(edges.tolist())]
    why = f"the input is {edges[-1] - value:.2g} {model.description.length} from its start"
    home = _DOUBLINGS - 1
    return PositionCurve(
        legs=tuple(legs), home=home, value=value, closed=False, gain=np.zeros(1), ends=(why, why)
    )
