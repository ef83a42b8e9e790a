"""Proof that a traced curve is one curve: every leg, every change of leader, the closure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.rounding import REGULAR_CONDITION, UNIT_ROUNDOFF
from linkwork.core.numerics.branch_tracking import rows_of_nodes
from linkwork.core.numerics.curve_tracing import Curve, Leg
from linkwork.core.numerics.local_parametrization import (
    Parametrization,
    Parametrizations,
    apart,
    whole_turns,
)
from linkwork.core.numerics.path_proof import ProvenPath, prove_path, prove_paths
from linkwork.core.numerics.position_proof import expansions, prove, reach

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
    """Prove every step of a curve; of very many steps only about ``most``."""
    return prove_curves(leads, [curve], most)[0]


def prove_curves(
    leads: Parametrizations,
    curves: Sequence[Curve],
    most: int = _MOST_STEPS,
    halvings: int | None = None,
) -> list[ProvenCurve]:
    """Prove curves together: few large arrays take far less time than many small ones.

    ``halvings`` of one step, at most; the usual number by default.
    """
    provable = [all(leg.led.provable for leg in curve.legs) for curve in curves]
    legs = [leg for curve, good in zip(curves, provable, strict=True) if good for leg in curve.legs]
    proofs = dict(zip(map(id, legs), _prove_legs(legs, most * len(curves), halvings), strict=True))
    return [
        _prove(leads, curve, [proofs[id(leg)] for leg in curve.legs] if good else [])
        for curve, good in zip(curves, provable, strict=True)
    ]


def _prove(leads: Parametrizations, curve: Curve, proofs: Sequence[ProvenPath]) -> ProvenCurve:
    """A curve with the proofs of its legs, if these can be proved: junctions and the closure."""
    legs = np.zeros(len(curve.legs), dtype=bool)
    junctions = np.zeros(max(len(curve.legs) - 1, 0), dtype=bool)
    steps, broken = 0, None
    for k, proof in enumerate(proofs):
        # from its first position, which the previous leg has proved
        joined = _joined(curve.legs[k], proof)
        legs[k] = joined.all()
        if broken is None and not legs[k]:
            broken = (k, int(np.argmin(joined)) - 1)
        steps += int(proof.pieces.sum())
    for k in range(len(proofs) - 1):
        leg, following = curve.legs[k : k + 2]
        last = leg.v[-1]
        junctions[k] = np.array_equal(last, following.v[0]) and _goes_on(leads, leg, following)
        junctions[k] &= same_solution(leg.led, following.led, last)
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


def legs_are_proved(legs: Sequence[Leg]) -> list[bool]:
    """Whether every position and every step of legs is proved."""
    proofs = _prove_legs(legs, _MOST_STEPS)
    return [bool(_joined(leg, proof).all()) for leg, proof in zip(legs, proofs, strict=True)]


def _joined(leg: Leg, proof: ProvenPath) -> BoolArray:
    """Which nodes of a leg are joined to its first one, in its order, (K,)."""
    falls = leg.nodes[-1].t < leg.nodes[0].t
    return proof.connected_to(len(leg.nodes) - 1)[::-1] if falls else proof.connected_to(0)


def _prove_legs(legs: Sequence[Leg], most: int, halvings: int | None = None) -> list[ProvenPath]:
    """Every position and step of legs, joined to their first nodes, in the order of rising t; with
    exact residuals where branches nearly cross.
    """
    found: list[ProvenPath | None] = [None] * len(legs)
    groups: dict[int, list[int]] = {}
    for k, leg in enumerate(legs):
        groups.setdefault(id(leg.led), []).append(k)
    for members in groups.values():
        led = legs[members[0]].led
        rows, anchors = [], []
        for k in members:
            nodes = legs[k].nodes
            # a leg may be traced downwards; proofs take rising values
            falls = nodes[-1].t < nodes[0].t
            points = rows_of_nodes(nodes[::-1] if falls else nodes)
            rows.append(points.with_columns(input_radius=np.zeros((len(nodes), 1))))
            anchors.append(len(nodes) - 1 if falls else 0)
        proofs = prove_paths(
            led.solver, led.path, rows, anchors=anchors, most=most, halvings=halvings
        )
        for k, points, anchor, proof in zip(members, rows, anchors, proofs, strict=True):
            nearly = any(node.nearness > REGULAR_CONDITION for node in legs[k].nodes)
            if nearly and not proof.connected_to(anchor).all():
                few = min(most, _MOST_EXACT)
                proof = prove_path(
                    led.solver, led.path, points, anchor=anchor, most=few, exact=True
                )
            found[k] = proof
    return [proof for proof in found if proof is not None]


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
