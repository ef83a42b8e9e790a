"""The reachable input value of a circuit nearest to the requested one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from linkwork.equations.parametrized_table import ParametrizedTable
from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.motion.curve_branches import TracedCurve
from linkwork.motion.limits import kind_of_crossing
from linkwork.motion.model import Model
from linkwork.motion.tracking import turns_freely
from linkwork.numerics.continuation.branch_tracking import BOLD, InputPath, TrackOptions, follow
from linkwork.numerics.continuation.curve_proof import prove_curve
from linkwork.numerics.continuation.curve_tracing import Curve, CurveOptions, Leg, trace
from linkwork.numerics.continuation.turning_point import turning_points
from linkwork.numerics.least_squares import nearest_miss

__all__ = ["MOST_UNKNOWNS", "ReachableRange", "assembled_near", "reach_towards"]

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
        if found is None or found.certified or _size(found) > _MOST_AGAIN:
            break
    return found


def _size(walk: TracedCurve) -> int:
    return sum(leg.v.size for leg in walk.curve.legs)


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
