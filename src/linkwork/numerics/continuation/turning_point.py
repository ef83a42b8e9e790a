"""Dead points: where the parameter of a curve of positions turns back, to machine precision.

With a fast unknown in the lead the dead point is an ordinary position at which the parameter's rate
is zero, so Newton-Raphson on that rate finds it, and the branch through it can be proved.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.status import CONVERGED
from linkwork.numerics.block_solver import BlockSolver
from linkwork.numerics.continuation.branch_tracking import (
    BOLD,
    InputPath,
    Node,
    TrackOptions,
    Watch,
    follow,
    node_at,
    predict,
)
from linkwork.numerics.continuation.curve_proof import legs_are_proved, prove_curve
from linkwork.numerics.continuation.curve_tracing import Curve, CurveOptions, Leg, trace
from linkwork.numerics.continuation.dead_point_proof import FoldProof, prove_dead_point
from linkwork.numerics.continuation.local_parametrization import (
    Parametrization,
    Parametrizations,
    fastest_leader,
)
from linkwork.numerics.continuation.proved_tracking import follow_with_proof
from linkwork.numerics.continuation.step_division import divide_step, node_between
from linkwork.numerics.newton import sharp

__all__ = ["TurnAhead", "TurningPoint", "turn_beyond", "turning_points"]

_MOST_LEGS = 24  # to a dead point ahead, each with another leader
_MOST_STEPS = 400  # to a dead point ahead: it is near, unless it is none
_SHARPENINGS = 4  # Newton steps on the rate with sharpened positions,
_SHORT = 1e-6  # each at most that long
_RESTING = 1e-7  # weighted rate below which the parameter may not move at all,
_LEVEL = 100.0  # nor does it if the derivative of that rate is at most this many times that


@dataclass(frozen=True, kw_only=True, eq=False)
class TurningPoint:
    """Where the parameter turns back on a curve: a dead point.

    ``v`` (N,) the position; ``bracket`` of the parameter around it; ``direction`` (N,) how the
    variables move through it (weighted norm 1). ``proof``: that the parameter turns back there;
    without it the place is not located. ``leg``, ``after``: the node of the curve before it.
    ``node``: the position as the leg's leader sees it.
    """

    t: float
    bracket: tuple[float, float]
    v: Array
    direction: Array
    proof: FoldProof | None
    leg: int
    after: int
    node: Node

    @property
    def located(self) -> bool:
        """Whether the parameter is proved to turn back within the bracket."""
        return self.proof is not None


def turning_points(
    leads: Parametrizations, curve: Curve, *, prove: bool = True
) -> list[TurningPoint]:
    """The dead points on a curve, in its order, with their proofs if asked for.

    Where the parameter's rate by the leader changes sign, Newton-Raphson on that rate, kept inside
    the sign change, finds the place. Steps in which the rate may change sign twice are divided.
    Where a place is not proved to lie between both ends at once, proved steps lead to it.
    """
    steps = list(_turning_steps(leads, curve))
    turns = [_refine_turn(leads, *step, prove=prove) for step in steps]
    if not prove:
        return turns
    legs = {
        k: Leg(led=led, nodes=_distinct(low, turns[k].node, high))
        for k, (led, low, high, _) in enumerate(steps)
        if led.provable and turns[k].located
    }
    # together: a proof takes about as long for one leg as for several
    proofs = dict(zip(legs, legs_are_proved([*legs.values()]), strict=True))
    return [
        turn
        if proofs.get(k, False) or not step[0].provable
        else _by_proved_steps(leads, *step, turn)
        for k, (step, turn) in enumerate(zip(steps, turns, strict=True))
    ]


#: The leader, both ends, the numbers of the leg and of the node before it.
_Step = tuple[Parametrization, Node, Node, tuple[int, int]]


def _turning_steps(leads: Parametrizations, curve: Curve) -> Iterator[_Step]:
    """The steps, or parts of steps, in which the parameter turns back."""
    for number, leg in enumerate(curve.legs):
        if leg.led.lead == leads.parameter:
            continue
        place = leg.led.place(leads.parameter)
        # where t and its second derivative rest, the arc keeps one input: no dead point
        still = _RESTING * leads.scale[leads.parameter] / leads.scale[leg.led.lead]
        level = _LEVEL * still / leads.scale[leg.led.lead]
        for k, (a, b) in enumerate(itertools.pairwise(leg.nodes)):
            if all(
                abs(node.first[place]) < still and abs(node.second[place]) < level
                for node in (a, b)
            ):
                continue
            chain = divide_step(leg.led, place, a, b)
            for low, high in itertools.pairwise(chain):
                if _rises(low, place) is not _rises(high, place):
                    # one sign change per piece: divide_step has separated them
                    yield leg.led, low, high, (number, k)


def _by_proved_steps(
    leads: Parametrizations,
    led: Parametrization,
    low: Node,
    high: Node,
    where: tuple[int, int],
    turn: TurningPoint,
) -> TurningPoint:
    """The dead point between two nodes, to which proved steps lead; not located without them."""
    ahead = _first_turn(leads, led, low, math.copysign(1.0, high.t - low.t), follow_with_proof)
    if ahead is None or not ahead.located:
        place = led.place(leads.parameter)
        edges = sorted((float(low.v[place]), float(high.v[place]), turn.t))
        return replace(turn, proof=None, bracket=(edges[0], edges[-1]))
    return replace(ahead.turn, leg=where[0], after=where[1])


def _distinct(*nodes: Node) -> tuple[Node, ...]:
    """Nodes without those at which the leader has the value of the node before."""
    first = nodes[:1]
    return (*first, *(b for a, b in itertools.pairwise(nodes) if a.t != b.t))


def _rises(node: Node, place: int) -> bool:
    """Whether the parameter grows with the leader; a rate of exactly zero counts as growing."""
    return bool(node.first[place] >= 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class TurnAhead:
    """A dead point and the way to it: ``legs`` from a position, with the dead point as their last
    node; ``proved``: whether every step of them is.
    """

    legs: tuple[Leg, ...]
    turn: TurningPoint
    proved: bool

    @property
    def located(self) -> bool:
        """Whether the branch is proved to end there."""
        return self.proved and self.turn.located


def turn_beyond(leads: Parametrizations, v: Array, rates: Array, side: float) -> TurnAhead | None:
    """The dead point ahead of a position at which a branch could not be followed further.

    Parameters
    ----------
    v, rates : (N,)
        The position and its derivatives by the parameter.
    side : float
        +1 if the parameter was growing, -1 if it was falling.

    Returns
    -------
    TurnAhead or None
        The way from the position to the dead point; ``None`` if the parameter does not turn back
        there.

    Notes
    -----
    The way is followed boldly first. Where that cannot be proved, a step may have come onto another
    branch: it is followed again with care, and then with every step proved before the next. The
    fastest variable leads; where it turns back itself, other ones lead in turn.
    """
    leader = fastest_leader(leads, v, np.abs(rates / leads.scale), avoid=leads.parameter)
    if leader is None:
        return None
    led, node = leader
    sign = math.copysign(1.0, side * rates[led.lead])
    ways = (_follow_to_turn(BOLD), _follow_to_turn(TrackOptions()), follow_with_proof)
    best: TurnAhead | None = None
    for follow_leg in ways if led.provable else ways[1:2]:
        found = _first_turn(leads, led, node, sign, follow_leg)
        if found is not None and (best is None or found.located):
            best = found
        if best is not None and best.located:
            return best
    traced = _turn_on_curve(leads, v, side) if led.provable else None
    return traced if traced is not None and (best is None or traced.located) else best


def _turn_on_curve(leads: Parametrizations, v: Array, side: float) -> TurnAhead | None:
    """The first dead point ahead on the curve through a position, whatever variables lead to it."""
    curve = trace(
        leads, v, side, CurveOptions(track=TrackOptions(sharp=True), most_legs=_MOST_LEGS)
    )
    turn = next(iter(turning_points(leads, curve)), None)
    if turn is None:
        return None
    last = curve.legs[turn.leg]
    nodes = _distinct(*last.nodes[: turn.after + 1], turn.node)
    legs = (*curve.legs[: turn.leg], replace(last, nodes=nodes))
    way = replace(curve, legs=legs, end=CircuitEnd.SINGULAR)
    return TurnAhead(legs=legs, turn=turn, proved=prove_curve(leads, way).whole)


#: Follows the branch of a node towards a goal until a watch has seen enough.
_Following = Callable[[BlockSolver, InputPath, Node, float, Watch], list[Node]]


def _follow_to_turn(options: TrackOptions) -> _Following:
    def follow_leg(
        solver: BlockSolver, path: InputPath, node: Node, goal: float, watch: Watch
    ) -> list[Node]:
        limited = replace(options, most_steps=_MOST_STEPS, sharp=True)
        return follow(solver, path, node, goal, limited, watch)[0]

    return follow_leg


def _first_turn(
    leads: Parametrizations, led: Parametrization, node: Node, sign: float, follow_leg: _Following
) -> TurnAhead | None:
    """The first dead point ahead, with the leader moving in a direction."""
    place = led.place(leads.parameter)
    turned: list[tuple[Node, Node]] = []

    def has_turned(before: Node, after: Node) -> bool:
        chain = itertools.pairwise(divide_step(led, place, before, after))
        turned.extend(pair for pair in chain if _rises(pair[0], place) != _rises(pair[1], place))
        return bool(turned)

    goal = node.t + sign * float(leads.scale[led.lead])
    nodes = follow_leg(led.solver, led.path, node, goal, has_turned)
    if not turned:
        return None
    turn = _refine_turn(leads, led, *turned[0], (0, len(nodes) - 1))
    leg = Leg(led=led, nodes=_distinct(node, *nodes[:-1], turn.node))
    return TurnAhead(legs=(leg,), turn=turn, proved=led.provable and legs_are_proved([leg])[0])


def _refine_turn(
    leads: Parametrizations,
    led: Parametrization,
    low: Node,
    high: Node,
    where: tuple[int, int],
    *,
    prove: bool = True,
) -> TurningPoint:
    """The place between two nodes at which the parameter's rate is zero, with its proof if asked
    for.
    """
    place, p = led.place(leads.parameter), leads.parameter
    edges = sorted((float(low.v[place]), float(high.v[place])))
    here = _level(led, place, low, high)
    here = _sharpen(led, place, here) if prove else here
    proof = prove_dead_point(led, here.v, place) if prove else None
    v, direction = led.whole(here.v), led.whole(here.first)
    t = float(v[p])
    if proof is None:
        bracket = (min(edges[0], t), max(edges[1], t))
    else:
        off = float(proof.error_bound[place])
        # outwards, so that the rounding of t ± off cannot shut out the dead point
        bracket = (math.nextafter(t - off, -math.inf), math.nextafter(t + off, math.inf))
    return TurningPoint(
        t=t,
        bracket=bracket,
        v=v,
        direction=direction / np.abs(direction / leads.scale).max(),
        proof=proof,
        leg=where[0],
        after=where[1],
        node=here,
    )


def _level(led: Parametrization, place: int, low: Node, high: Node) -> Node:
    """The node between two at which a variable's rate is nearest to zero.

    Newton-Raphson on the rate, kept inside the sign change and on the side of the branch on which
    det J has the sign of both nodes; halving where a step comes onto another branch.
    """
    best = here = low if abs(low.first[place]) < abs(high.first[place]) else high
    options = sharp(led.solver.options)
    for _ in range(60):
        step = _to_level(here, place)
        if abs(step) <= 4.0 * EPSILON * max(1.0, abs(here.t)):
            break
        edges = sorted((low.t, high.t))
        found = None
        if edges[0] < here.t + step < edges[1]:
            guess = predict(here, here.t + step)  # eq. (17)
            guess[-1] = here.t + step
            done = led.solver.solve(guess[None, :], options)
            if done.status[0] == CONVERGED:
                found = node_at(led.solver, led.path, float(guess[-1]), done.v[0])
        if found is None or not np.array_equal(found.orientation, low.orientation):
            # Newton has left the sign change or the branch: halve the interval
            found = node_between(led, low, high, 0.5, to_rounding=True)
            if found is None or not np.array_equal(found.orientation, low.orientation):
                break
            step = found.t - here.t
        here = found
        if here.first[place] * low.first[place] > 0.0:
            low = here
        else:
            high = here
        if abs(here.first[place]) < abs(best.first[place]):
            best = here
        elif abs(step) < 1e-9:
            break  # to rounding
    return best


def _to_level(here: Node, place: int) -> float:
    """The step of Newton-Raphson to where a variable's rate is zero."""
    # eq. (36)
    return float(-here.first[place] / here.second[place]) if here.second[place] else math.inf


def _sharpen(led: Parametrization, place: int, here: Node) -> Node:
    """A level place once more, from positions whose residuals are rounded once."""
    best = node_at(led.solver, led.path, here.t, led.solver.sharpen(here.v[None, :])[0])
    for _ in range(_SHARPENINGS):
        step = _to_level(best, place)
        if not 4.0 * EPSILON * max(1.0, abs(best.t)) < abs(step) < _SHORT:
            break
        guess = predict(best, best.t + step)
        guess[-1] = best.t + step
        after = led.solver.sharpen(led.solver.sharpen(guess[None, :]))[0]
        found = node_at(led.solver, led.path, float(guess[-1]), after)
        if not abs(found.first[place]) < abs(best.first[place]):
            break
        best = found
    return best
