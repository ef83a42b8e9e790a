"""The reachable input value of a circuit nearest to the requested one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from linkwork.circuits.assembling import positions_at, solve_block
from linkwork.circuits.branches import TracedCurve
from linkwork.circuits.failure.remedies import dyad_form
from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.statuses import CircuitEnd, Completeness, Status
from linkwork.core.foundation.units import within_half_a_turn
from linkwork.core.motion.following import turns_freely
from linkwork.core.motion.limits import kind_of_crossing
from linkwork.core.motion.model import Model
from linkwork.core.numerics.block_solver import Block, linearise_block
from linkwork.core.numerics.branch_tracking import BOLD, InputPath, TrackOptions, follow
from linkwork.core.numerics.curve_tracing import Curve, CurveOptions, Leg, trace
from linkwork.core.numerics.newton import NewtonOptions, nearest_miss, newton
from linkwork.core.numerics.path_proof import prove_curve
from linkwork.core.numerics.position_proof import prove_block
from linkwork.core.numerics.turning_point import turning_points
from linkwork.core.table.loop_table import LoopTable

MOST_UNKNOWNS = 200  # of a mechanism whose circuit is followed for an explanation
_CLOSED = 1e-9  # relative gap of a position that was found with the input free
_HELD = 0.1  # weight of the input relative to the unknowns: it moves as little as possible
_TRIES = 8  # input values around the circle from which an assembled position is looked for
_TURN = 2.0 * np.pi
_FAST = 6.0  # where a variable moves this many times faster than the input, a dead point is near
_ASIDE = 0.2  # weighted: how far from it a circuit is begun
_MOST_LEGS = 24  # a circuit that closes has up to ten; these take about a second
_MOST_PROVED = 300  # steps of one: proofs that need more would take seconds
_CARES = (replace(BOLD, most_steps=60), TrackOptions(most_steps=120))  # until one is proved
_MOST_AGAIN = 600  # nodes times variables of a curve that is followed again with more care


_T = TypeVar("_T", bound=TracedCurve | None)


@dataclass(frozen=True)
class _Edge:
    """A value of the path on a circuit, its kind of limit, and its bracket if it was located."""

    t: float
    kind: str = "as far as the circuit was followed"
    bracket: tuple[float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class ReachableRange:
    """The nearest input values that a circuit reaches.

    ``inputs`` (p,): file units. ``kind``: the limit that ends the circuit there; empty if
    the circuit reaches the value asked for. ``proved``: whether it was followed with proof.
    ``first_dead_point`` (p,): the first dead point on the way from the start.
    """

    inputs: Array
    kind: str
    proved: bool
    first_dead_point: Array | None


def assembled_near(model: Model, path: InputPath, lead: int, v: Array) -> Array | None:
    """An assembled position (N,) near v, the input moved as little as possible; or ``None``."""
    locked = ParametrizedTable(model.compiled.table, path, lead).table
    n = model.compiled.solver.unknowns
    scale = locked.variable_scale.copy()
    # small weights make a change of the input expensive
    scale[n:] *= _HELD
    free = replace(locked, unknowns=locked.variables, variable_scale=scale)
    tries = _TRIES if turns_freely(model) else 1
    for k in range(tries):
        start = v.copy()
        turn = (k + 1) // 2 * (1.0 if k % 2 else -1.0) * _TURN / tries
        start[n:] += path.rate * turn
        found, f = nearest_miss(free, start)
        if np.isfinite(f).all() and np.abs(f / locked.equation_scale).max() <= _CLOSED:
            return found
    return None


def reach_towards(
    model: Model, path: InputPath, lead: int, v: Array, asked: float
) -> ReachableRange | None:
    """How near the circuit through a position comes to the value ``asked`` of the path.

    A circuit is connected: it reaches all values between its smallest and its largest, which lie
    at turning points if it closes.

    Parameters
    ----------
    v : (N,)
        A position on the circuit.
    """
    if model.compiled.solver.unknowns > MOST_UNKNOWNS:
        return None
    compiled = model.compiled
    leads = ParametrizedTable(compiled.table, path, lead, compiled.leaders)
    period = _TURN if turns_freely(model) else None
    away = asked - float(v[leads.parameter])
    if period is not None:
        # the shorter way around
        away = math.remainder(away, period)
    walks = _circuit(leads, v, math.copysign(1.0, away))
    if not walks:
        return None
    edges = [edge for walk in walks for edge in _edges(leads, walk)]
    low, high = min(edges, key=lambda e: e.t), max(edges, key=lambda e: e.t)
    turns = [turn for walk in walks for turn in walk.turns]
    first = None
    if turns:
        edge = _Edge(turns[0].t, "dead point", turns[0].bracket)
        first = _in_file_units(model, path, lead, edge, 0)
    nearest = _nearest(low.t, high.t, asked, period)
    if nearest is None:
        inputs, kind = path.at(asked) / model.input_scale, ""
    else:
        end, whole = nearest
        edge = low if end == "low" else high
        inputs, kind = _in_file_units(model, path, lead, edge, whole), edge.kind
    proved = all(walk.certified for walk in walks)
    return ReachableRange(inputs=inputs, kind=kind, proved=proved, first_dead_point=first)


def _nearest(low: float, high: float, asked: float, period: float | None) -> tuple[str, int] | None:
    """Which end of an interval moved by some periods is nearest; ``None`` if it holds the value."""
    slack = 1e-12 * max(1.0, abs(asked))
    if period is None:
        shifts = [0]
    elif high - low >= period - slack:
        return None
    else:
        middle = round((asked - 0.5 * (low + high)) / period)
        shifts = [middle, middle - 1, middle + 1]
    found: list[tuple[float, str, int]] = []
    for k in shifts:
        moved = 0.0 if period is None else k * period
        if low + moved - slack <= asked <= high + moved + slack:
            return None
        found += [(low + moved - asked, "low", k), (high + moved - asked, "high", k)]
    # of two that are equally near, the one ahead
    _, end, k = min(found, key=lambda entry: (round(abs(entry[0]), 9), -entry[0]))
    return end, k


def _in_file_units(model: Model, path: InputPath, lead: int, edge: _Edge, turns: int) -> Array:
    """All inputs at a value of the path, the leading one as the short number in its bracket."""
    scale = float(model.input_scale[lead])
    inputs: Array = path.at(edge.t) / model.input_scale
    value = edge.t / scale
    if edge.bracket is not None:
        # a short number if it lies within the proved bracket
        short = round(value, 9)
        value = short if edge.bracket[0] / scale <= short <= edge.bracket[1] / scale else value
    inputs[lead] = value + (turns * model.units.angle.turn if turns else 0.0) + 0.0
    return inputs


def _circuit(leads: ParametrizedTable, v: Array, side: float) -> list[TracedCurve]:
    """The whole circuit through a position (N,): one curve if it closes, else one each way."""
    try:
        aside = _proved(lambda care: _off_dead_point(leads, v, care), _CARES)
        start = v if aside is None else aside.curve.legs[-1].v[-1]
        # all of it is proved or nothing is: after one part without proof more care is in vain
        cares = _CARES if aside is None or aside.certified else _CARES[:1]
        walks = [_proved(lambda care: _walk(leads, start, side, care), cares)]
        if not walks[0].curve.end.closed:
            cares = cares if walks[0].certified else _CARES[:1]
            walks.append(_proved(lambda care: _walk(leads, start, -side, care), cares))
    except (ValueError, np.linalg.LinAlgError):
        return []
    return [walk for walk in (*walks, aside) if walk is not None and walk.curve.legs]


def _proved(follow: Callable[[TrackOptions], _T], cares: Sequence[TrackOptions]) -> _T:
    """What is followed with the least care that proves it, or else with the most that is cheap."""
    for care in cares:
        found = follow(care)
        if found is None or found.certified:
            break
        if sum(leg.v.size for leg in found.curve.legs) > _MOST_AGAIN:
            break
    return found


def _walk(leads: ParametrizedTable, v: Array, side: float, care: TrackOptions) -> TracedCurve:
    """A curve with its proof and dead points, given up sooner than when it is asked for."""
    given_up = CurveOptions(most_legs=_MOST_LEGS, most_proved_legs=0, track=care)
    curve = trace(leads, v, side, given_up)
    if not curve.legs:
        return TracedCurve(curve=curve, proof=None, turns=())
    turns = tuple(turning_points(leads, curve))
    return TracedCurve(curve=curve, proof=prove_curve(leads, curve, _MOST_PROVED), turns=turns)


def _off_dead_point(leads: ParametrizedTable, v: Array, care: TrackOptions) -> TracedCurve | None:
    """A way from a position (N,) at which the parameter is slow to one where it can lead."""
    table = leads.table
    slope = table.jacobian(v[None, :])[0] * table.variable_scale / table.equation_scale[:, None]
    speed = np.abs(np.linalg.svd(slope)[2][-1])
    # the parameter is fast enough to lead from here
    if speed.max() <= _FAST * speed[leads.parameter]:
        return None
    lead = int(np.argmax(speed))
    led = leads.with_parameter(lead)
    if led is None:
        raise ValueError("the fastest variable must determine the position")
    node, weight = led.node(v), float(table.variable_scale[lead])
    for sign in (1.0, -1.0):
        goal = node.t + sign * _ASIDE * weight
        nodes, _ = follow(led.solver, led.path, node, goal, care)
        if nodes:
            leg = Leg(led=led, nodes=(node, *nodes))
            curve = Curve(legs=(leg,), end=CircuitEnd.SINGULAR, passes=())
            proof = prove_curve(leads, curve, _MOST_PROVED)
            return TracedCurve(curve=curve, proof=proof, turns=())
    return None


def _edges(leads: ParametrizedTable, walk: TracedCurve) -> list[_Edge]:
    """The values of the parameter on a curve, with the kind of limit where it may turn or end."""
    p = leads.parameter
    found = [_Edge(float(t)) for leg in walk.curve.legs for t in leg.v[:, p]]
    found += [_Edge(turn.t, "dead point", turn.bracket) for turn in walk.turns]
    crossing = walk.curve.crossing
    if crossing is not None:
        kind = kind_of_crossing(leads, crossing).word
        found.append(_Edge(crossing.t, kind))
    return found


# ----------------------------------------------------------------------
# The known positions at one input value.


_STARTS = 192  # per block that is no dyad
_MOST_BLOCKS = 8
_MOST_LOOPS = 4  # coupled, whose configurations are listed: more take seconds
_MOST = 64  # positions; a chain of dyads has 2^blocks
_SAME_POSITION = 1e-6  # weighted
_REACH = 2.0  # lengths are looked for within this many times the longest link around the guess


@dataclass(frozen=True, kw_only=True, eq=False)
class Elsewhere:
    """All variables of every position found, (K, N); ``complete``: whether there are no others;
    ``likely``: that only with probability one. ``names``: of the configurations, if they have any.
    """

    v: Array
    complete: bool
    likely: bool = False
    names: tuple[str, ...] = ()


def positions_elsewhere(model: Model, inputs: Array) -> Elsewhere | None:
    """The positions of a mechanism for the inputs (p,): its configurations where they can be
    listed, else those that Newton-Raphson finds from many starts, block by block.
    """
    solver = model.compiled.solver
    if len(solver.blocks) > _MOST_BLOCKS:
        return None
    if max((len(block.equations) for block in solver.blocks), default=0) <= _MOST_LOOPS:
        listed = positions_at(model, inputs)
        if listed.completeness is not Completeness.NOT_LISTED:
            grade = listed.completeness
            likely = grade is Completeness.WITH_PROBABILITY_ONE
            return Elsewhere(v=listed.v, complete=grade.complete, likely=likely, names=listed.names)
    return _search_block(model, inputs)


def _search_block(model: Model, inputs: Array) -> Elsewhere:
    solver = model.compiled.solver
    guess = model.equations.start.copy()
    guess[solver.unknowns :] = inputs
    found, complete = guess[None, :], True
    for block in solver.blocks:
        pieces = []
        for v in found:
            here, all_of_them = block_positions(block, v)
            complete &= all_of_them
            piece = np.repeat(v[None, :], len(here), axis=0)
            piece[:, block.unknowns] = here
            pieces.append(piece)
        found = np.concatenate(pieces) if pieces else found[:0]
        if len(found) > _MOST:
            found, complete = found[:_MOST], False
    return Elsewhere(v=found, complete=complete)


def block_positions(block: Block, v: Array) -> tuple[Array, bool]:
    """The positions (K, n) of one block for the known variables in v (N,), and whether all.

    ``v`` also holds the block's guess, around which lengths and plain numbers are looked for.
    """
    start = v[block.variables]
    n = len(block.unknowns)
    form = dyad_form(block)
    if form is not None:
        known = start[None, n:]
        (roots,) = solve_block(form, *form.closures(known, np.zeros_like(known)))
        starts = form.unknowns(roots.x, np.repeat(known, len(roots.x), axis=0), start[:n])
        polished, good = _solve_starts(block, v, starts)
        return polished, bool(good.all()) and roots.grade.complete
    table = block.system
    # relative angles alone have one position
    linear = isinstance(table, LoopTable) and not table.loops.rows and not table.functions
    found, _ = _solve_starts(block, v, start[None, :n] if linear else _starts(block, start[:n]))
    distinct: list[Array] = []
    for x in found:
        if all(distance(block, x, other) > _SAME_POSITION for other in distinct):
            distinct.append(x)
    return np.array(distinct).reshape(-1, n), linear and len(distinct) == 1


def _solve_starts(block: Block, v: Array, starts: Array) -> tuple[Array, BoolArray]:
    """Newton-Raphson from the starts (K, n); the positions found, and which starts led to one."""
    n = len(block.unknowns)
    if not len(starts):
        return np.zeros((0, n)), np.ones(0, dtype=bool)
    lanes = np.repeat(v[block.variables][None, :], len(starts), axis=0)
    lanes[:, :n] = starts
    done = newton(block.system, lanes, NewtonOptions(max_steps=40))
    # a small last step alone does not say that the equations hold
    good = (done.status == Status.CONVERGED.code) & (done.residual < 1e-10)
    if block.system.is_enclosed:  # nor does a small residual
        good[good] = roots_in_block(block, done.v[good])
    return done.v[good, :n], good


def roots_in_block(block: Block, v: Array) -> BoolArray:
    """Whether formulas are proved to have a root at positions v (B, N) of a block, (B,)."""
    n = len(block.unknowns)
    own = replace(block, unknowns=np.arange(n), variables=np.arange(v.shape[1]))
    return prove_block(own, linearise_block(own, v), v, np.zeros_like(v)).holds


def _starts(block: Block, guess: Array) -> Array:
    """Starts spread evenly by an additive recurrence: angles around, the rest around the guess."""
    n = len(guess)
    root = _recurrence_root(n)
    # the generalised golden ratio (Roberts): evenly spread whatever the number of starts
    steps = root ** -np.arange(1.0, n + 1.0)
    even = np.mod(0.5 + np.multiply.outer(np.arange(_STARTS), steps), 1.0)
    turns = block.system.is_angle[:n]
    size = block.system.variable_scale[:n]
    lengths = guess + _REACH * size * (2.0 * even - 1.0)
    # a plain number has no natural size: some starts near the guess, some far away
    wide = np.maximum(size, 1.0) * np.array([1.0, 30.0])[:, None]
    sizes = np.stack([size, *wide])[np.arange(_STARTS) % 3]
    numbers = guess + sizes * np.tan(np.pi * 0.99 * (even - 0.5))
    spread = numbers if block.system.is_enclosed else lengths
    starts: Array = np.where(turns, guess + 2.0 * np.pi * even, spread)
    return starts


def _recurrence_root(n: int) -> float:
    """The root of x^(n+1) = x + 1 above 1, whose powers are badly approximable."""
    x = 2.0
    for _ in range(30):
        x = (1.0 + x) ** (1.0 / (n + 1.0))
    return x


def distance(block: Block, a: Array, b: Array) -> float:
    """How far apart two positions (n,) of a block are, weighted, modulo whole turns."""
    n = len(block.unknowns)
    gap = within_half_a_turn(b - a, block.system.is_angle[:n])
    return float(np.abs(gap / block.system.variable_scale[:n]).max(initial=0.0))
