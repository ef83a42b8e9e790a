"""Proof of a dead point: between two values of the leader the parameter's rate changes its sign.

With another variable λ in the lead a dead point is an ordinary position. Kantorovich's theorem
gives one solution x(λ) for every λ of a small interval, all of them in one box. The rates x'(λ)
solve J x' = -F_λ; multiplied by A ≈ J⁻¹, with d the computed direction and e its error,

    |e| ≤ |I - A J| |e| + |A J d| + |A J_k| |e_k|

where J is taken anywhere in the box: it differs from J at the computed position by at most the
bound of the second derivatives times the size of the box. If the parameter's rate has proved and
opposite signs at both ends of the interval, the parameter turns back in between, and the dead point
lies in the box.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    PROOF_SLACK,
    UNIT_ROUNDOFF,
    Array,
    matrix_vector,
)
from linkwork.core.foundation.statuses import CircuitEnd
from linkwork.core.numerics.block_solver import Block, BlockSolver, Linearised
from linkwork.core.numerics.branch_tracking import (
    BOLD,
    InputPath,
    Node,
    Parametrization,
    Parametrizations,
    TrackOptions,
    Watch,
    fastest_leader,
    follow,
    follow_with_proof,
    node_at,
    predict,
)
from linkwork.core.numerics.curve_tracing import (
    Curve,
    CurveOptions,
    Leg,
    divide_step,
    sign_change,
    trace,
)
from linkwork.core.numerics.kantorovich import Enclosed, Expansion
from linkwork.core.numerics.path_proof import legs_are_proved, prove_curve
from linkwork.core.numerics.position_proof import expansions, prove, reach

_ROOM = 4.0  # times the error of the rate: how far apart the ends of the interval are taken
_LEAST = 16.0  # units of rounding of the leader
_WIDENINGS = 12  # tries, each with an interval this many times as wide
_WIDER = 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class FoldProof:
    """``error_bound`` (N,): how far the dead point may be from the position it was proved from, in
    the solver's order, the leader's own last; ``isolation_radius`` (n,): within this no other
    position has the same leader's value. ``radius``, ``uniqueness_radius``: both weighted.
    """

    error_bound: Array
    isolation_radius: Array
    radius: float
    uniqueness_radius: float


def prove_dead_point(led: Parametrization, v: Array, place: int) -> FoldProof | None:
    """Prove that the parameter turns back next to a position.

    Parameters
    ----------
    v : (N,)
        The position, in the solver's order, at which the parameter's rate is zero to rounding.
    place : int
        The index of the parameter in the solver's order.

    Returns
    -------
    FoldProof or None
        ``None`` where nothing is proved.
    """
    if not led.provable:
        return None
    solver, path = led.solver, led.path
    with np.errstate(all="ignore"):
        rates = solver.rates(v[None, :], path.rate)
        bend = abs(float(rates.second[0, place]))
        own = _rate_errors(solver, v[None, :], rates.first)
    if own is None or not bend > 0.0:
        return None
    off = abs(float(rates.first[0, place])) + float(own.rates[0, place])
    # at both ends t' has to exceed its own error: t' grows by about bend times the width
    width = max(_ROOM * off / bend, _LEAST * UNIT_ROUNDOFF * max(1.0, abs(float(v[-1]))))
    for _ in range(_WIDENINGS):
        found = _turns_within(led, v, place, width)
        if found is not None:
            return found
        width *= _WIDER
    return None


def _turns_within(led: Parametrization, v: Array, place: int, width: float) -> FoldProof | None:
    """The proof with an interval of the leader of that half width, or ``None``."""
    solver = led.solver
    # the ends are rounded themselves
    whole = width + 2.0 * UNIT_ROUNDOFF * (abs(float(v[-1])) + width)
    at_v = expansions(solver, v[None, :], exact=True)
    box = reach(solver, v[None, :], np.full((1, 1), whole), at_v)
    if not box.holds[0]:
        return None
    # first-order guesses of both ends, then solved
    ends = solver.rates(v[None, :], led.path.rate).first * np.array([[-width], [width]]) + v
    # exactly there: the product above has rounded them
    ends[:, -1] = v[-1] + np.array([-width, width])
    found = solver.solve(ends).v
    rates = solver.rates(found, led.path.rate).first
    errors = _rate_errors(solver, found, rates)
    if errors is None:
        return None
    off = np.abs(found - v)[:, :-1] + errors.error_bound[:, :-1]
    slow, error = rates[:, place], errors.rates[:, place]
    turned = slow[0] * slow[1] < 0.0 and (np.abs(slow) > error).all()  # eq. (40)
    if not (turned and (off < box.isolation_radius).all()):
        return None
    weights = solver.variable_scale
    error_bound = box.error_bound[0]
    return FoldProof(
        error_bound=error_bound,
        isolation_radius=box.isolation_radius[0],
        radius=float((error_bound / weights).max()),
        uniqueness_radius=float((box.isolation_radius[0] / weights[:-1]).min()),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Errors:
    """How far true positions may be from computed ones, and their rates, (B, N) each."""

    error_bound: Array
    rates: Array


def _rate_errors(solver: BlockSolver, v: Array, rates: Array) -> _Errors | None:
    """Bounds for positions v (B, N) at exactly their inputs; ``None`` where nothing is proved."""
    linear = solver.linearise(v)
    places = expansions(solver, v, linear, exact=True)
    position = prove(solver, v, np.zeros((len(v), solver.variables - solver.unknowns)), places)
    if not position.holds.all():
        return None
    errors = np.zeros_like(rates)
    for block, part, at in zip(solver.blocks, linear, places, strict=True):
        box, d, known = (x[:, block.variables] for x in (position.error_bound, rates, errors))
        known[:, : len(block.unknowns)] = 0.0
        if isinstance(at, Enclosed):
            y, z = _terms_over_box(at, box, d, known)
        else:
            assert isinstance(at, Expansion)  # the position is proved, with arrays
            y, z = _terms(block, part, at, box, d, known)
        found = _block_errors(block, y, z)
        if found is None:
            return None
        errors[:, block.unknowns] = found
    return _Errors(error_bound=position.error_bound, rates=errors)


def _terms_over_box(at: Enclosed, box: Array, d: Array, known: Array) -> tuple[Array, Array]:
    """As :func:`_terms`, from slopes enclosed over boxes (B, N)."""
    n = at.matrix.shape[1]
    centre, spread = at.slopes(box)
    size = np.abs(centre) + spread
    rounding = (d.shape[1] + 4) * UNIT_ROUNDOFF * matrix_vector(size, np.abs(d))
    # eq. (39): |A J d| and |A J_k| |e_k|
    y = np.abs(matrix_vector(centre, d)) + matrix_vector(spread, np.abs(d)) + rounding
    own = np.abs(np.eye(n) - centre[:, :, :n]) + spread[:, :, :n]
    w = np.broadcast_to(at.system.variable_scale[:n], y.shape)
    return (y + matrix_vector(size, known)) * PROOF_SLACK, matrix_vector(own, w) * PROOF_SLACK


def _terms(
    block: Block,
    part: Linearised,
    at: Expansion,
    box: Array,
    d: Array,
    known: Array,
) -> tuple[Array, Array]:
    """y and Z times the weights, (B, n) each, with e ≤ y + Z e for the errors e of a block's rates.

    ``box``, ``d`` (B, N): how far its variables may be off, and their rates;
    ``known``: the errors of the rates of its known variables, 0 for its own.
    """
    n = len(block.unknowns)
    # |A J d|: as computed, the rounding of J, and that of the products
    size, along = np.abs(part.inverse), np.abs(d)
    slip = matrix_vector(at.bend.jacobian_rounding, along)
    slip += (d.shape[1] + n + 4) * UNIT_ROUNDOFF * matrix_vector(np.abs(part.jacobian), along)
    # eq. (39): |A J d|
    y = np.abs(matrix_vector(part.inverse, matrix_vector(part.jacobian, d))) + matrix_vector(
        size, slip
    )
    y += at.slopes_change(box, along)
    # eq. (39): |A J_k| |e_k|
    y = (y + matrix_vector(at.slope, known[:, n:]) + at.slopes_change(box, known)) * PROOF_SLACK
    w = block.system.variable_scale[:n]
    unit = np.zeros_like(d)
    unit[:, :n] = w
    z = (
        matrix_vector(at.defect, np.broadcast_to(w, y.shape)) + at.slopes_change(box, unit)
    ) * PROOF_SLACK
    return y, z


def _block_errors(block: Block, y: Array, z: Array) -> Array | None:
    """The errors of one block's rates, (B, n), from e ≤ y + Z e in its weights."""
    w = block.system.variable_scale[: len(block.unknowns)]
    room = 1.0 - (z / w).max(axis=1)
    if not (room > 0.0).all():
        return None
    # eq. (39) solved for the norm of e, then row by row
    norm = (y / w).max(axis=1) / room * PROOF_SLACK
    found: Array = (y + z * norm[:, None]) * PROOF_SLACK
    return found if np.isfinite(found).all() else None


# ----------------------------------------------------------------------
# Dead points: where the parameter of a curve of positions turns back, to machine precision.
#
# With a fast unknown in the lead the dead point is an ordinary position at which the parameter's
# rate is zero, so Newton-Raphson on that rate finds it, and the branch through it can be proved.


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
    here = sign_change(led, low, high, lambda node: float(node.first[place]), to_rounding=True)
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
