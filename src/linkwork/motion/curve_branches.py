"""The branches of a traced curve: its pieces between dead points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.status import Status
from linkwork.numerics.continuation.branch_tracking import Track, TrackOptions, rows_on_track
from linkwork.numerics.continuation.crossed_step import cut_at_crossing
from linkwork.numerics.continuation.curve_proof import ProvenCurve, prove_curve, same_solution
from linkwork.numerics.continuation.curve_tracing import (
    Curve,
    CurveOptions,
    Leg,
    trace,
)
from linkwork.numerics.continuation.local_parametrization import Parametrization, Parametrizations
from linkwork.numerics.continuation.turning_point import TurningPoint, turning_points
from linkwork.results.motion import LimitKind

__all__ = ["CurveBranch", "TracedCurve", "branches_of", "trace_with_proof"]


@dataclass(frozen=True, kw_only=True, eq=False)
class TracedCurve:
    """A curve, its proof (``None`` if not asked for) and its dead points."""

    curve: Curve
    proof: ProvenCurve | None
    turns: tuple[TurningPoint, ...]

    @property
    def certified(self) -> bool:
        """Whether the whole curve is proved, and that it closes if it does."""
        if self.proof is None:
            return False
        return self.proof.whole and (self.proof.closed or not self.curve.end.closed)


def trace_with_proof(
    leads: Parametrizations, start: Array, heading: float | Array, certify: bool
) -> TracedCurve:
    """Trace a curve with bold steps; with careful ones if these are not proved or not to be."""
    best: TracedCurve | None = None
    own = leads.with_parameter(leads.parameter)
    proves = certify and own is not None and own.provable
    careful = CurveOptions(track=TrackOptions())
    for care in (CurveOptions(), careful) if proves else (careful,):
        curve = trace(leads, start, heading, care)
        if not curve.legs:
            return TracedCurve(curve=curve, proof=None, turns=())
        proof = prove_curve(leads, curve) if certify else None
        found = TracedCurve(curve=curve, proof=proof, turns=())
        if best is None or found.certified:
            best = found
        if best.certified:
            break
        if proof is not None and proof.broken is not None and care is careful:
            # a step across a change point cannot be proved; the way up to that can
            cut = cut_at_crossing(leads, curve, *proof.broken)
            if cut is not None:
                found = TracedCurve(curve=cut, proof=prove_curve(leads, cut), turns=())
                best = found if found.certified else best
    assert best is not None
    return replace(best, turns=tuple(turning_points(leads, best.curve)))


@dataclass(frozen=True, kw_only=True, eq=False)
class CurveBranch:
    """A piece of a curve along which the parameter is monotonic.

    ``limits`` (K,): ``dead point``, ``change point`` or "" for each position.

    ``side``: +1 if it grows in the direction of travel. ``v`` (K, N): positions along it, the dead
    points at its ends among them. ``anchor`` (N,): where the parameter leads best, ``leader`` of
    the curve there, ``ratio`` of the parameter's speed to the fastest there. ``begin``, ``end``:
    the dead points. ``proved``: the way to it from the curve's start.
    """

    side: float
    v: Array
    limits: tuple[str, ...]
    anchor: Array
    leader: Parametrization
    ratio: float
    begin: TurningPoint | None
    end: TurningPoint | None
    proved: bool

    def range(self, parameter: int) -> tuple[float, float]:
        """Smallest and largest value of the parameter."""
        values = self.v[:, parameter]
        edges = [float(values.min()), float(values.max())]
        turns = (self.begin, self.end) if self.side > 0 else (self.end, self.begin)
        for k, turn in enumerate(turns):
            if turn is not None and turn.located:
                # rounding may carry a position next to a dead point beyond it; turns of a closed
                # curve may lie a lap away
                edges[k] += math.remainder(turn.t - edges[k], FULL_TURN)
        return edges[0], edges[1]

    def is_joined(self, leads: Parametrizations) -> bool:
        """Whether the anchor is proved to be the same position when the parameter leads."""
        own = leads.with_parameter(leads.parameter)
        return self.proved and own is not None and same_solution(self.leader, own, self.anchor)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sample:
    v: Array
    ratio: float  # of the parameter's speed to the fastest
    leader: Parametrization
    limit: str = ""


def branches_of(leads: Parametrizations, found: TracedCurve, fine: int = 1) -> list[CurveBranch]:
    """The branches in the order of travel; of a closed curve the first one is whole.

    Parameters
    ----------
    fine : int
        Positions per step of the curve.
    """
    pieces: list[list[_Sample]] = [[]]
    ends: list[TurningPoint] = []
    proved = [True]
    waiting = list(found.turns)
    for number, leg in enumerate(found.curve.legs):
        t, v, ratio = _samples(leads, leg, fine)
        sign = 1.0 if t[-1] >= t[0] else -1.0
        for k in range(len(t) + 1):  # behind the last position, too
            here = sign * t[k] if k < len(t) else np.inf
            while waiting and waiting[0].leg == number and sign * waiting[0].node.t < here:
                turn = waiting.pop(0)
                at = _Sample(v=turn.v, ratio=0.0, leader=leg.led, limit=LimitKind.DEAD_POINT.word)
                pieces[-1].append(at)
                ends.append(turn)
                pieces.append([at])
                proved.append(found.certified)
            if k < len(t):
                pieces[-1].append(_Sample(v=v[k], ratio=float(ratio[k]), leader=leg.led))
    crossing = found.curve.crossing
    if crossing is not None and found.curve.legs:
        led = found.curve.legs[-1].led
        word = LimitKind.CHANGE_POINT.word
        pieces[-1].append(_Sample(v=led.whole(crossing.v), ratio=0.0, leader=led, limit=word))
    begins: list[TurningPoint | None] = [None, *ends]
    finishes: list[TurningPoint | None] = [*ends, None]
    branches = [
        _branch(leads.parameter, samples, begin, end, sound)
        for samples, begin, end, sound in zip(pieces, begins, finishes, proved, strict=True)
    ]
    if found.curve.end is CircuitEnd.CLOSED and len(branches) > 1:
        first, last = branches[0], branches.pop()
        shift = first.v[0] - last.v[-1]  # whole turns
        branches[0] = replace(
            first,
            v=np.concatenate([last.v[:-1] + shift, first.v]),
            limits=(*last.limits[:-1], *first.limits),
            begin=last.begin,
        )
    return branches


def _samples(leads: Parametrizations, leg: Leg, fine: int) -> tuple[Array, Array, Array]:
    """Positions along a leg: the leader's values, (K, N), the parameter's speed to the fastest."""
    nodes = leg.nodes
    t = np.array([node.t for node in nodes])
    if fine > 1 and len(t) > 1:
        steps = np.linspace(0.0, 1.0, fine + 1)[:-1]
        t = np.append((t[:-1, None] + np.diff(t)[:, None] * steps).ravel(), t[-1])
    sign = 1.0 if t[-1] >= t[0] else -1.0
    ordered = nodes if sign > 0 else nodes[::-1]
    track = Track(nodes=tuple(ordered), start=0)
    led = leg.led
    if fine > 1 and len(t) > 1:
        rows = rows_on_track(led.solver, led.path, track, t)
        good = rows.status == Status.CONVERGED.code
        t, v, first = t[good], led.whole(rows.v[good]), led.whole(rows.first[good])
    else:
        v, first = leg.v, leg.first
    speed = np.abs(first) / leads.scale
    return t, v, speed[:, leads.parameter] / speed.max(axis=1)


def _branch(
    parameter: int,
    samples: Sequence[_Sample],
    begin: TurningPoint | None,
    end: TurningPoint | None,
    proved: bool,
) -> CurveBranch:
    best = max(samples, key=lambda sample: sample.ratio)
    v = np.stack([sample.v for sample in samples])
    return CurveBranch(
        side=float(np.sign(v[-1, parameter] - v[0, parameter])) or 1.0,
        v=v,
        limits=tuple(sample.limit for sample in samples),
        anchor=best.v,
        leader=best.leader,
        ratio=best.ratio,
        begin=begin,
        end=end,
        proved=proved,
    )
