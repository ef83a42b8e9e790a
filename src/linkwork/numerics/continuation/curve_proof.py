"""Proof that a traced curve is one curve: every leg, every change of leader, the closure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.rounding import REGULAR_CONDITION, UNIT_ROUNDOFF
from linkwork.numerics.continuation.curve_tracing import Curve, Leg
from linkwork.numerics.continuation.local_parametrization import (
    Parametrization,
    Parametrizations,
    apart,
    whole_turns,
)
from linkwork.numerics.continuation.path_proof import ProvenPath, prove_path
from linkwork.numerics.proof.position_proof import expansions, prove, reach
from linkwork.numerics.rows import SolvedRows

__all__ = ["ProvenCurve", "leg_is_proved", "prove_curve", "same_solution"]

_MOST_STEPS = 20_000  # of a proof: a length on its way to infinity takes steps without end
_MOST_EXACT = 400  # of those with residuals that are rounded once, which take far longer


@dataclass(frozen=True, kw_only=True, eq=False)
class ProvenCurve:
    """``legs`` (L,): every step of the leg. ``junctions`` (L-1,): from a leg to the next.
    ``closed``: that the last position is the first one again. ``steps``: how many were proved.
    ``broken``: the leg, and the node behind it, of the first step that is not proved.
    """

    legs: BoolArray
    junctions: BoolArray
    closed: bool
    steps: int
    broken: tuple[int, int] | None = None

    @property
    def whole(self) -> bool:
        """Whether the curve is proved from its first to its last position."""
        return bool(self.legs.all() and self.junctions.all())


def prove_curve(leads: Parametrizations, curve: Curve, most: int = _MOST_STEPS) -> ProvenCurve:
    """Prove every step of a curve; of very many steps only the ``most`` first ones."""
    legs = np.zeros(len(curve.legs), dtype=bool)
    junctions = np.zeros(max(len(curve.legs) - 1, 0), dtype=bool)
    steps, broken = 0, None
    if all(leg.led.provable for leg in curve.legs):
        for k, leg in enumerate(curve.legs):
            proof = _proof_of(leg, max(most - steps, 0))
            # from its first position, which the previous leg has proved
            joined = proof.connected_to(0)
            legs[k] = joined.all()
            if broken is None and not legs[k]:
                broken = (k, int(np.argmin(joined)) - 1)
            steps += int(proof.pieces.sum())
            if steps > most or proof.given_up.any():
                break
        for k, (leg, following) in enumerate(zip(curve.legs, curve.legs[1:], strict=False)):
            last = leg.v[-1]
            junctions[k] = same_solution(leg.led, following.led, last)
            junctions[k] &= np.array_equal(last, following.v[0]) and _goes_on(leads, leg, following)
    own = leads.with_parameter(leads.parameter)
    closed = False
    if curve.end.closed and own is not None and own.provable:
        last = curve.legs[-1]
        first = curve.legs[0]
        closed = same_solution(own, first.led, first.v[0])
        closed = closed and same_solution(last.led, own, last.v[-1])
        closed = closed and _meets(leads, own, first.v[0], last.v[-1])
    return ProvenCurve(legs=legs, junctions=junctions, closed=closed, steps=steps, broken=broken)


def _goes_on(leads: Parametrizations, leg: Leg, following: Leg) -> bool:
    """Whether the next leg leaves in the direction in which a leg arrives."""
    arrival, departure = (
        np.sign(part.nodes[-1].t - part.nodes[0].t) * part.first[place] / leads.scale
        for part, place in ((leg, -1), (following, 0))
    )
    # a leg that turned around would prove the way back, not the way on
    return bool(arrival @ departure > 0.0)


def leg_is_proved(leg: Leg) -> bool:
    """Whether every position and every step of a leg is proved."""
    return bool(_proof_of(leg, _MOST_STEPS).connected_to(0).all())


def _proof_of(leg: Leg, most: int) -> ProvenPath:
    """Every position and step of a leg, from its first node; with exact residuals where branches
    nearly cross.
    """
    proof = _proof(leg, most, exact=False)
    nearly = any(node.nearness > REGULAR_CONDITION for node in leg.nodes)
    if nearly and not proof.connected_to(0).all():
        return _proof(leg, min(most, _MOST_EXACT), exact=True)
    return proof


def _proof(leg: Leg, most: int, exact: bool) -> ProvenPath:
    nodes = leg.nodes
    # a leg may be traced downwards; proofs take rising values, so t and odd derivatives change sign
    sign = np.sign(nodes[-1].t - nodes[0].t) or 1.0
    points = SolvedRows(
        t=sign * np.array([node.t for node in nodes]),
        v=np.stack([node.v for node in nodes]),
        first=sign * np.stack([node.first for node in nodes]),
        second=np.stack([node.second for node in nodes]),
        input_radius=np.zeros((len(nodes), 1)),
    )
    path = leg.led.path
    backwards = type(path)(origin=path.origin, rate=sign * path.rate)
    return prove_path(leg.led.solver, backwards, points, anchor=0, most=most, exact=exact)


def same_solution(one: Parametrization, other: Parametrization, v: Array) -> bool:
    """Whether two leaders prove the same position near v (N,).

    The first position may differ from v in the other's leader by at most its proved error; the
    second is proved for all those values, and is the only one in its box. Where residuals as
    computed do not suffice, those that are rounded once may.
    """
    if one.lead == other.lead:
        return True
    return any(_same_solution(one, other, v, exact) for exact in (False, True))


def _same_solution(one: Parametrization, other: Parametrization, v: Array, exact: bool) -> bool:
    mine, theirs = v[one.order][None, :], v[other.order][None, :]
    place = expansions(one.solver, mine, exact=exact)
    first = prove(one.solver, mine, np.zeros((1, 1)), place)
    if not first.holds[0]:
        return False
    off = one.whole(first.error_bound[0])[other.order]
    place = expansions(other.solver, theirs, exact=exact)
    second = reach(other.solver, theirs, off[None, -1:], place)
    return bool(second.holds[0] and (off[:-1] < second.isolation_radius[0]).all())


def _meets(leads: Parametrizations, own: Parametrization, start: Array, end: Array) -> bool:
    """Whether two proved positions at one value of the parameter are one, modulo whole turns."""
    if not leads.repeats_after(whole_turns(leads, start, end)):
        return False
    gap = apart(leads, start, end)
    # whole turns are no floats: the gap includes their rounding
    left = np.abs(gap) + 8.0 * UNIT_ROUNDOFF * np.maximum(np.abs(end), np.abs(start))
    left = left[own.order]
    first = reach(own.solver, start[own.order][None, :], left[None, -1:])
    last = prove(own.solver, end[own.order][None, :], left[None, -1:])
    if not (first.holds[0] and last.holds[0]):
        return False
    return bool((left[:-1] + last.error_bound[0, :-1] < first.isolation_radius[0]).all())
