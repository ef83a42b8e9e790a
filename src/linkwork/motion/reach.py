"""The input value nearest to the one asked that a mechanism reaches on one circuit."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from linkwork.equations.leading import LeadTable
from linkwork.foundation.arrays import Array
from linkwork.motion.branches import Traced, traced
from linkwork.motion.model import Model
from linkwork.motion.tracking import turns_freely
from linkwork.numerics.least_squares import nearest_miss
from linkwork.numerics.track import InputPath

__all__ = ["MOST_UNKNOWNS", "Reach", "assembled_near", "reach_towards"]

MOST_UNKNOWNS = 200  # of a mechanism whose circuit is followed for an explanation
_CLOSED = 1e-9  # relative gap of a position that was found with the input free
_HELD = 0.1  # weight of the input beside the unknowns: it moves as little as need be
_TRIES = 8  # input values around the circle from which an assembled position is looked for
_TURN = 2.0 * np.pi


@dataclass(frozen=True)
class _Edge:
    """A value of the path on a circuit, what is there, and its bracket if it was located."""

    t: float
    kind: str = "as far as the circuit was followed"
    bracket: tuple[float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class Reach:
    """The nearest input values that a circuit reaches.

    ``inputs`` (p,): everyday units. ``kind``: what ends the circuit there; empty if the circuit
    reaches what was asked. ``proved``: whether it was followed with proof. ``first_dead_point``
    (p,): the first one met on the way from the start.
    """

    inputs: Array
    kind: str
    proved: bool
    first_dead_point: Array | None


def assembled_near(model: Model, path: InputPath, lead: int, v: Array) -> Array | None:
    """An assembled position (N,) near v, the input moved as little as need be; ``None`` if none."""
    locked = LeadTable(model.compiled.table, path, lead).table
    n = model.compiled.solver.unknowns
    scale = locked.variable_scale.copy()
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


def reach_towards(model: Model, path: InputPath, lead: int, v: Array, asked: float) -> Reach | None:
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
    leads = LeadTable(model.compiled.table, path, lead)
    period = _TURN if turns_freely(model) else None
    away = asked - float(v[leads.parameter])
    if period is not None:
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
        first = _everyday(model, path, lead, edge, 0)
    nearest = _nearest(low.t, high.t, asked, period)
    if nearest is None:
        inputs, kind = path.at(asked) / model.input_scale, ""
    else:
        end, whole = nearest
        edge = low if end == "low" else high
        inputs, kind = _everyday(model, path, lead, edge, whole), edge.kind
    proved = all(walk.certified for walk in walks)
    return Reach(inputs=inputs, kind=kind, proved=proved, first_dead_point=first)


def _nearest(low: float, high: float, asked: float, period: float | None) -> tuple[str, int] | None:
    """Which end of an interval, so many periods on, is nearest; ``None`` if it holds the value."""
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


def _everyday(model: Model, path: InputPath, lead: int, edge: _Edge, turns: int) -> Array:
    """All inputs at a value of the path, the leading one as the short number in its bracket."""
    scale = float(model.input_scale[lead])
    inputs: Array = path.at(edge.t) / model.input_scale
    value = edge.t / scale
    if edge.bracket is not None:
        short = round(value, 9)
        value = short if edge.bracket[0] / scale <= short <= edge.bracket[1] / scale else value
    inputs[lead] = value + (turns * model.units.angle.turn if turns else 0.0) + 0.0
    return inputs


def _circuit(leads: LeadTable, v: Array, side: float) -> list[Traced]:
    """The whole circuit through a position (N,): one curve if it closes, else one each way."""
    try:
        walks = [traced(leads, v, side, True)]
        if not walks[0].curve.end.closed:
            walks.append(traced(leads, v, -side, True))
    except (ValueError, np.linalg.LinAlgError):
        return []
    return [walk for walk in walks if walk.curve.legs]


def _edges(leads: LeadTable, walk: Traced) -> list[_Edge]:
    """The values of the parameter on a curve, with what is at those where it may turn or end."""
    p = leads.parameter
    found = [_Edge(float(t)) for leg in walk.curve.legs for t in leg.v[:, p]]
    found += [_Edge(turn.t, "dead point", turn.bracket) for turn in walk.turns]
    crossing = walk.curve.crossing
    if crossing is not None:
        led, _ = walk.curve.last
        found.append(_Edge(float(led.whole(crossing.v)[p]), "change point"))
    return found
