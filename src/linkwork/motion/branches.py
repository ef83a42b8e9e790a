"""The branches of a traced curve: its pieces between dead points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.numerics.curve import Curve, CurveOptions, Leads, Led, trace
from linkwork.numerics.proven_curve import ProvenCurve, prove_curve, same_solution
from linkwork.numerics.track import TrackOptions
from linkwork.numerics.turning_point import TurningPoint, turning_points

__all__ = ["CurveBranch", "Traced", "branches_of", "traced"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Traced:
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


def traced(leads: Leads, start: Array, side: float, certify: bool) -> Traced:
    """Trace a curve boldly; with care where the bold one cannot be proved."""
    best: Traced | None = None
    for care in (CurveOptions(), CurveOptions(track=TrackOptions())):
        curve = trace(leads, start, side, care)
        if not curve.legs:
            return Traced(curve=curve, proof=None, turns=())
        proof = prove_curve(leads, curve) if certify else None
        found = Traced(curve=curve, proof=proof, turns=tuple(turning_points(leads, curve)))
        if best is None or found.certified:
            best = found
        if not certify or best.certified:
            break
    assert best is not None
    return best


@dataclass(frozen=True, kw_only=True, eq=False)
class CurveBranch:
    """A piece of a curve along which the parameter goes one way.

    ``side``: +1 if it grows in the direction of travel. ``v`` (K, N): positions along it, the dead
    points at its ends among them. ``anchor`` (N,): where the parameter leads best, and ``leader``
    of the curve there. ``begin``, ``end``: the dead points. ``proved``: the way to it from the
    curve's start.
    """

    side: float
    v: Array
    anchor: Array
    leader: Led
    begin: TurningPoint | None
    end: TurningPoint | None
    proved: bool

    def range(self, parameter: int) -> tuple[float, float]:
        """Smallest and largest value of the parameter."""
        values = self.v[:, parameter]
        return float(values.min()), float(values.max())

    def is_joined(self, leads: Leads) -> bool:
        """Whether the anchor is proved to be the same position when the parameter leads."""
        own = leads.by(leads.parameter)
        return self.proved and own is not None and same_solution(self.leader, own, self.anchor)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Sample:
    v: Array
    ratio: float  # of the parameter's speed to the fastest
    leader: Led


def branches_of(leads: Leads, found: Traced) -> list[CurveBranch]:
    """The branches in the order of travel; of a closed curve the first one is whole."""
    p = leads.parameter
    pieces: list[list[_Sample]] = [[]]
    ends: list[TurningPoint] = []
    proved = [True]
    waiting = list(found.turns)
    fine = found.certified
    for number, leg in enumerate(found.curve.legs):
        speed = np.abs(leg.first) / leads.scale
        ratio = speed[:, p] / speed.max(axis=1)
        for k, v in enumerate(leg.v):
            pieces[-1].append(_Sample(v=v, ratio=float(ratio[k]), leader=leg.led))
            while waiting and (waiting[0].leg, waiting[0].after) == (number, k):
                turn = waiting.pop(0)
                at = _Sample(v=turn.v, ratio=0.0, leader=leg.led)
                pieces[-1].append(at)
                ends.append(turn)
                pieces.append([at])
                proved.append(fine)
    begins: list[TurningPoint | None] = [None, *ends]
    finishes: list[TurningPoint | None] = [*ends, None]
    branches = [
        _branch(p, samples, begin, end, sound)
        for samples, begin, end, sound in zip(pieces, begins, finishes, proved, strict=True)
    ]
    if found.curve.end is CircuitEnd.CLOSED and len(branches) > 1:
        first, last = branches[0], branches.pop()
        shift = first.v[0] - last.v[-1]  # whole turns
        branches[0] = replace(
            first, v=np.concatenate([last.v[:-1] + shift, first.v]), begin=last.begin
        )
    return branches


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
        anchor=best.v,
        leader=best.leader,
        begin=begin,
        end=end,
        proved=proved,
    )
