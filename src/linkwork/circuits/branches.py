"""The branches of a traced curve: its pieces between dead points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.circuits.dead_inputs import cut_at_crossing
from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.statuses import CircuitEnd, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.numerics.branch_tracking import (
    Node,
    Parametrization,
    Parametrizations,
    Track,
    TrackOptions,
    coincide,
    fastest_leader,
    interpolate,
    rows_of_nodes,
    rows_on_track,
)
from linkwork.core.numerics.curve_tracing import Curve, CurveOptions, Leg, sign_change, trace
from linkwork.core.numerics.path_proof import ProvenCurve, prove_curve, same_solution
from linkwork.core.numerics.turning_point import TurningPoint, turning_points
from linkwork.core.results.failure import LimitKind

_CAREFUL = CurveOptions(track=TrackOptions())


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
    leads: Parametrizations,
    start: Array,
    heading: float | Array,
    certify: bool,
    *,
    prove_turns: bool = True,
) -> TracedCurve:
    """Trace a curve with bold steps; with careful ones if these are not proved or not to be.

    ``prove_turns``: whether to prove where its dead points are.
    """
    own = leads.with_parameter(leads.parameter)
    bold = certify and own is not None and own.provable
    curve = trace(leads, start, heading, CurveOptions() if bold else _CAREFUL)
    turns = turning_points(leads, curve, prove=prove_turns)
    found = TracedCurve(curve=curve, proof=None, turns=tuple(turns))
    if not certify or not curve.legs:
        return found
    best = careful = replace(found, proof=prove_curve(leads, curve))
    if best.certified:
        return best
    if bold:
        curve = trace(leads, start, heading, _CAREFUL)
        careful = TracedCurve(curve=curve, proof=None, turns=())
        if not curve.legs:
            return careful
        careful = replace(careful, proof=prove_curve(leads, curve))
        best = careful if careful.certified else best
    if careful.proof is not None and careful.proof.broken is not None and not careful.certified:
        # a step across a change point cannot be proved; the way up to that can
        cut = cut_at_crossing(leads, careful.curve, *careful.proof.broken)
        if cut is not None:
            shorter = TracedCurve(curve=cut, proof=prove_curve(leads, cut), turns=())
            best = shorter if shorter.certified else best
    if best.curve is found.curve:
        return best
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
class _Samples:
    """Positions (K, N) with one leader, the parameter's speed there to the fastest, (K,), and the
    kind of limit that they are, if any.
    """

    v: Array
    ratio: Array
    leader: Parametrization
    limit: str = ""


def branches_of(
    leads: Parametrizations, found: TracedCurve, fine: int = 1, *, solved: bool = True
) -> list[CurveBranch]:
    """The branches in the order of travel; of a closed curve the first one is whole.

    Parameters
    ----------
    fine : int
        Positions per step of the curve.
    solved : bool
        Whether those between nodes are solved, too, or interpolated.
    """
    pieces: list[list[_Samples]] = [[]]
    ends: list[TurningPoint] = []
    proved = [True]
    for number, leg in enumerate(found.curve.legs):
        t, here = _samples(leads, leg, fine, solved)
        sign, begin = 1.0 if t[-1] >= t[0] else -1.0, 0
        for turn in found.turns:
            if turn.leg != number:
                continue
            stop = int(np.searchsorted(sign * t, sign * turn.node.t, side="right"))
            at = _limit(turn.v, leg.led, LimitKind.DEAD_POINT)
            pieces[-1] += [_slice(here, begin, stop), at]
            begin = stop
            ends.append(turn)
            pieces.append([at])
            proved.append(found.certified)
        pieces[-1].append(_slice(here, begin, len(t)))
    crossing = found.curve.crossing
    if crossing is not None and found.curve.legs:
        led = found.curve.legs[-1].led
        pieces[-1].append(_limit(crossing.v, led, LimitKind.CHANGE_POINT))
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


def _limit(v: Array, led: Parametrization, kind: LimitKind) -> _Samples:
    return _Samples(v=v[None, :], ratio=np.zeros(1), leader=led, limit=kind.word)


def _slice(samples: _Samples, begin: int, end: int) -> _Samples:
    return replace(samples, v=samples.v[begin:end], ratio=samples.ratio[begin:end])


def _samples(leads: Parametrizations, leg: Leg, fine: int, solved: bool) -> tuple[Array, _Samples]:
    """Positions along a leg and the leader's values there, (K,)."""
    nodes, led = leg.nodes, leg.led
    t = np.array([node.t for node in nodes])
    if fine == 1 or len(t) == 1:
        return t, _Samples(v=leg.v, ratio=_ratio(leads, leg.first), leader=led)
    steps = np.linspace(0.0, 1.0, fine + 1)[:-1]
    t = np.append((t[:-1, None] + np.diff(t)[:, None] * steps).ravel(), t[-1])
    track = Track(nodes=nodes if t[-1] >= t[0] else nodes[::-1], start=0)
    if solved:
        rows = rows_on_track(led.solver, led.path, track, t)
        good = rows.status == Status.CONVERGED.code
        v, ratio = led.whole(rows.v[good]), _ratio(leads, led.whole(rows.first[good]))
        return t[good], _Samples(v=v, ratio=ratio, leader=led)
    v, ratio = led.whole(interpolate(rows_of_nodes(track.nodes), t)[0]), np.zeros(len(t))
    v[::fine], ratio[::fine] = leg.v, _ratio(leads, leg.first)
    return t, _Samples(v=v, ratio=ratio, leader=led)


def _ratio(leads: Parametrizations, first: Array) -> Array:
    """The parameter's speed to the fastest, (K,), from rates (K, N)."""
    speed = np.abs(first) / leads.scale
    ratio: Array = speed[:, leads.parameter] / speed.max(axis=1)
    return ratio


def _branch(
    parameter: int,
    samples: Sequence[_Samples],
    begin: TurningPoint | None,
    end: TurningPoint | None,
    proved: bool,
) -> CurveBranch:
    v = np.concatenate([part.v for part in samples])
    best = max(samples, key=lambda part: part.ratio.max(initial=-1.0))
    at = int(best.ratio.argmax())
    return CurveBranch(
        side=float(np.sign(v[-1, parameter] - v[0, parameter])) or 1.0,
        v=v,
        limits=tuple(part.limit for part in samples for _ in part.v),
        anchor=best.v[at],
        leader=best.leader,
        ratio=float(best.ratio[at]),
        begin=begin,
        end=end,
        proved=proved,
    )


# ----------------------------------------------------------------------
# The position of a circuit at which its Jacobian is closest to being singular.


def weakest_place(leads: ParametrizedTable, branches: Sequence[CurveBranch]) -> tuple[float, Array]:
    """The smallest singular value σ along branches without limits, and the position (N,) there.

    σ = uᵀ J w of the scaled Jacobian by all variables but the parameter. Along a curve it changes
    by dσ/dt = uᵀ (dJ/dt) w; between the samples on both sides of each smallest one the zero of that
    rate is found to rounding.

    Notes
    -----
    A smallest sample is left alone if it lies higher above the smallest value found than its
    neighbours lie above it.
    """
    found: list[tuple[float, Array]] = []
    valleys: list[tuple[float, float, Array]] = []
    for branch in branches:
        v = _close_curve(leads, branch.v)
        values = smallest_singular_values(leads, v)
        if np.isinf(values[0]):  # there are no equations
            return np.inf, v[0]
        k = int(np.argmin(values))
        # the ends of an open branch may be weakest without being a valley
        found.append((float(values[k]), v[k]))
        inner = np.arange(1, len(v) - 1)
        low = inner[(values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:])]
        for k in low:
            rise = float(values[[k - 1, k + 1]].max() - values[k])
            valleys.append((float(values[k]), rise, v[k - 1 : k + 2]))
    best = min(found, key=lambda pair: pair[0])
    for value, rise, three in sorted(valleys, key=lambda valley: valley[0]):
        # the true minimum can lie below the sample by about as much as its neighbours lie above it
        if value - rise < best[0]:
            bottom = _bottom(leads, three)
            if bottom is not None and bottom[0] < best[0]:
                best = bottom
    return best


def smallest_singular_values(leads: ParametrizedTable, v: Array) -> Array:
    """Of the scaled Jacobian by all variables but the parameter, at positions (B, N): (B,)."""
    values = np.linalg.svd(leads.jacobian(v), compute_uv=False)
    return np.asarray(values.min(axis=1, initial=np.inf), dtype=float)


def _close_curve(leads: ParametrizedTable, v: Array) -> Array:
    """Positions (K, N) along a curve; of a closed one with the second position again at the end."""
    if len(v) > 2 and coincide(leads, v[0], v[-1]):
        return np.concatenate([v, v[1:2] + (v[-1] - v[0])])
    return v


def _bottom(leads: ParametrizedTable, v: Array) -> tuple[float, Array] | None:
    """The smallest value between three neighbouring positions (3, N), and where it is."""
    direction = np.abs(v[2] - v[0]) / leads.scale
    leader = fastest_leader(leads, v[1], direction)
    if leader is None:
        return None
    led, middle = leader
    low, high = led.node(v[0]), led.node(v[2])
    if not (low.t - middle.t) * (high.t - middle.t) < 0.0:
        return None

    def rate(node: Node) -> float:
        return leads.weakening(led.whole(node.v), led.whole(node.first))

    if not rate(low) * rate(high) < 0.0:
        return None
    here = led.whole(sign_change(led, low, high, rate, to_rounding=True).v)
    return float(smallest_singular_values(leads, here[None, :])[0]), here
