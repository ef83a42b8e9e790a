"""Turns of an input straight across change points, by analytic continuation.

Where branches cross, the Jacobian is singular but the motion that goes straight on is smooth. The
polynomial through the last positions is continued beyond the crossing; there the branches are apart
again, and Newton-Raphson corrects it. Positions next to a crossing are those of the polynomial.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from linkwork.circuits.branches import TracedCurve, trace_with_proof
from linkwork.core.foundation.arrays import EPSILON, Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.statuses import CONVERGED, Certification, ChangePointPolicy, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import unproved
from linkwork.core.numerics.block_solver import BlockSolver
from linkwork.core.numerics.branch_tracking import (
    Parametrizations,
    Track,
    rows_on_track,
    whole_turns,
)
from linkwork.core.numerics.curve_tracing import Leg as TracedLeg
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.numerics.position_proof import prove

_POINTS = 10  # of a polynomial
_SINGULAR = 100.0  # condition beyond which a position is taken from its polynomial
_FIRST, _LARGEST, _SHORTEST = 0.01, 0.07, 1e-4  # steps [rad]
_OFF = 1e-5  # weighted: how far a prediction may be from the position
_CONTINUED = 1e-8  # weighted: how well two polynomials must agree at a crossing
_EXACT = 1e-10  # weighted: the same for nodes that are kept
_MOST = 4000  # steps in a turn
_MOST_TURNS = 12  # after which a motion straight on counts as never closing
_CLOSED = 1e-9  # weighted: how well a turn ends where it began


@dataclass(frozen=True, kw_only=True, eq=False)
class Turn:
    """Positions (K, N) at rising values (K,) of the input, until they repeat and a little more.

    ``turns``: of the input, after which they do.
    """

    solver: BlockSolver
    begin: float
    at: Array
    v: Array
    turns: int = 1

    @property
    def end(self) -> float:
        """Where the positions repeat."""
        return self.begin + self.turns * FULL_TURN

    def gain(self, leads: Parametrizations) -> Array:
        """What the variables gain until then, (N,)."""
        ends, _ = self.interpolate(np.array([self.begin, self.end]))
        grown = ends[1] - ends[0]
        return np.where(leads.is_angle, FULL_TURN * np.round(grown / FULL_TURN), 0.0)

    def repeats(self, leads: Parametrizations) -> bool:
        """Whether they do."""
        (first, last), _ = self.interpolate(np.array([self.begin, self.end]))
        gap = np.abs(last - first - self.gain(leads)) / self.solver.variable_scale
        return bool(gap.max() < _CLOSED)

    def interpolate(self, values: Array) -> tuple[Array, tuple[Array, Array]]:
        """Positions (B, N) at values of the input, with both derivatives, by polynomials."""
        last = len(self.at) - _POINTS
        first = np.clip(np.searchsorted(self.at, values) - _POINTS // 2, 0, last)
        near = first[:, None] + np.arange(_POINTS)
        nodes, v = self.at[near] - values[:, None], self.v[near]
        size = np.abs(nodes).max(axis=1, keepdims=True)
        # Taylor coefficients about each value
        powers = (nodes / size)[:, :, None] ** np.arange(_POINTS)
        found = np.linalg.solve(powers, v)
        return found[:, 0], (found[:, 1] / size, 2.0 * found[:, 2] / size**2)

    def rows(self, values: Array, certify: bool) -> SolvedRows:
        """Positions and derivatives by the input at values (B,)."""
        solver = self.solver
        guess, (first, second) = self.interpolate(values)
        guess[:, -1] = values
        solved = solver.solve(guess)
        rates = solver.rates(solved.v, np.ones(1))
        fine = (solved.status == CONVERGED) & (rates.nearness < _SINGULAR)
        fine &= (np.abs(solved.v - guess) / solver.variable_scale).max(axis=1) < _OFF
        pick = fine[:, None]
        v = np.where(pick, solved.v, guess)
        rows = rates.with_columns(
            v=v,
            first=np.where(pick, rates.first, first),
            second=np.where(pick, rates.second, second),
            status=np.full(len(v), CONVERGED, dtype=np.int8),
            residual=solver.residual(v),
            iterations=solved.iterations,
        )
        if not (certify and solver.is_provable):
            return unproved(rows, Certification.NOT_ASKED)
        return with_proofs(solver, rows, v[:, -1:], Certification.BRANCH_CHOSEN)


def with_proofs(
    solver: BlockSolver, rows: SolvedRows, inputs: Array, standing: Certification
) -> SolvedRows:
    """Rows with proofs for rounded ``inputs`` (B, p), and with a ``standing`` where these hold."""
    proof = prove(solver, rows.v, 4.0 * EPSILON * np.abs(inputs))
    code = np.where(proof.holds, standing.code, Certification.POSITION_NOT_PROVED.code)
    return rows.with_columns(
        certification=code.astype(np.int8),
        radius=np.where(proof.holds, proof.radius, np.nan),
        uniqueness_radius=np.where(proof.holds, proof.least_uniqueness_radius, np.nan),
    )


def turn_of(leads: Parametrizations, solver: BlockSolver, start: Array) -> Turn | None:
    """The turns from a regular position (N,) until positions repeat; ``None`` if they cannot be
    followed, or never do.
    """
    turns = 1
    begin = float(start[-1])
    sharp = [True]  # which nodes are kept: those next to a crossing are polynomials
    scale = solver.variable_scale
    at, v = [begin], [start]
    h = _FIRST
    quick = replace(solver.options, max_steps=8)
    for _ in range(_MOST_TURNS * _MOST):
        if at[-1] > begin + turns * FULL_TURN + _LARGEST:
            nodes = np.array(at)[sharp], np.stack(v)[sharp]
            turn = Turn(solver=solver, begin=begin, at=nodes[0], v=nodes[1], turns=turns)
            if turn.repeats(leads):
                return turn
            turns += 1
            if turns > _MOST_TURNS:
                return None
        t = at[-1] + h
        guess, doubt = _continued(solver, at, v, t)
        found = solver.solve(guess[None, :], quick)
        off = float((np.abs(found.v[0] - guess) / scale).max())
        rates = solver.rates(found.v, np.ones(1))
        near = not rates.nearness[0] < _SINGULAR
        doubtful = float((np.abs(doubt) / scale).max())
        if near and doubtful < _CONTINUED:
            at.append(t)
            v.append(guess)
            sharp.append(doubtful < _EXACT)
        elif found.status[0] == CONVERGED and off < _OFF and not near:
            at.append(t)
            v.append(found.v[0])
            sharp.append(True)
            h = min(1.3 * h, _LARGEST)
        else:
            h *= 0.5
            if h < _SHORTEST:
                return None
    return None


def _continued(
    solver: BlockSolver, at: list[float], v: list[Array], t: float
) -> tuple[Array, Array]:
    """The polynomial through the last positions at t, and its difference from one of less order."""
    if len(at) < 3:
        rates = solver.rates(v[-1][None, :], np.ones(1))
        h = t - at[-1]
        found = v[-1] + h * rates.first[0] + 0.5 * h * h * rates.second[0]  # eq. (17)
        doubt = np.full_like(found, np.inf)
    else:
        found = _extrapolate(at[-_POINTS:], v[-_POINTS:], t)
        doubt = found - _extrapolate(at[-_POINTS + 1 :], v[-_POINTS + 1 :], t)
    found[-1] = t
    return found, doubt


def _extrapolate(at: list[float], v: list[Array], t: float) -> Array:
    """Neville's scheme."""
    rows = [np.array(row) for row in v]
    for k in range(1, len(rows)):
        for j in range(len(rows) - k):
            low, high = at[j], at[j + k]
            rows[j] = ((t - high) * rows[j] + (low - t) * rows[j + 1]) / (low - high)
    return rows[0]


# ----------------------------------------------------------------------
# The curve of positions that a mechanism with one input can take, in legs with a leader each.
#
# On a leg one variable, its leader, determines all others; at dead points of the input another one
# leads (see :mod:`linkwork.core.numerics.curve_tracing`).


_GAIN = 1e-9  # of the scale: a length that grew by more in a lap has really grown
_DOUBLINGS = 24  # of the longest link: how far an input length without unknowns may move


@dataclass(frozen=True, kw_only=True, eq=False)
class Leg:
    """A piece of the curve from the leader's value ``begin`` to ``end``.

    ``rows`` solves positions at values of the leader (B,): all variables in the mechanism's order,
    with derivatives by the leader; with proofs if asked.
    """

    lead: int
    begin: float
    end: float
    rows: Callable[[Array, bool], SolvedRows]


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionCurve:
    """Legs one after the other; ``home`` is the leg on which the start lies, ``value`` its place.

    ``gain`` (N,): what the variables of a closed curve gain in a lap. ``ends``: why an open curve
    ends before its first and behind its last leg.
    """

    legs: tuple[Leg, ...]
    home: int
    value: float
    closed: bool
    gain: Array
    ends: tuple[str, str] = ("", "")


def curve_of(model: Model, start: Array, policy: ChangePointPolicy, certify: bool) -> PositionCurve:
    """The curve through a position (N,) that the input leads to well."""
    drive = Drive.through(model, start[model.compiled.solver.unknowns :], np.ones(1), 0)
    if not model.equations.unknowns:
        return _without_unknowns(model, drive, start)
    if policy is ChangePointPolicy.STRAIGHT and drive.free:
        turn = turn_of(drive.leads, drive.solver, start)
        if turn is not None:
            leg = Leg(lead=len(start) - 1, begin=turn.begin, end=turn.end, rows=turn.rows)
            return PositionCurve(
                legs=(leg,), home=0, value=turn.begin, closed=True, gain=turn.gain(drive.leads)
            )
    ways = [trace_with_proof(drive.leads, start, 1.0, certify)]
    if not ways[0].curve.end.closed:
        ways.append(trace_with_proof(drive.leads, start, -1.0, certify))
    forward = [_leg(way_leg, ways[0]) for way_leg in ways[0].curve.legs]
    if ways[0].curve.end.closed:
        last = ways[0].curve.legs[-1]
        arrived = last.led.whole(last.nodes[-1].v)
        gain = FULL_TURN * whole_turns(drive.leads, start, arrived)
        grown = arrived - start
        lengths = ~drive.leads.is_angle & (np.abs(grown) > _GAIN * drive.leads.scale)
        gain = np.where(lengths, grown, gain)
        return PositionCurve(
            legs=tuple(forward), home=0, value=forward[0].begin, closed=True, gain=gain
        )
    backward = [_leg(way_leg, ways[1]) for way_leg in ways[1].curve.legs]
    turned = [
        Leg(lead=leg.lead, begin=leg.end, end=leg.begin, rows=leg.rows)
        for leg in reversed(backward)
    ]
    if not (forward or turned):
        raise InputError(
            "a simulation cannot start at a change point, where branches meet: start a little "
            "before or after it"
        )
    value = forward[0].begin if forward else turned[-1].end
    return PositionCurve(
        legs=(*turned, *forward),
        home=len(turned) if forward else len(turned) - 1,
        value=value,
        closed=False,
        gain=np.zeros(len(start)),
        ends=(ways[1].curve.end.value, ways[0].curve.end.value),
    )


def _leg(leg: TracedLeg, way: TracedCurve) -> Leg:
    led, nodes = leg.led, leg.nodes
    ordered = nodes if nodes[-1].t >= nodes[0].t else nodes[::-1]
    track = Track(nodes=tuple(ordered), start=0)

    def rows(values: Array, certify: bool) -> SolvedRows:
        found = rows_on_track(led.solver, led.path, track, values)
        if certify and led.provable:
            standing = Certification.CERTIFIED if way.certified else Certification.MOTION_NOT_PROVED
            found = with_proofs(led.solver, found, found.v[:, -1:], standing)
        else:
            found = unproved(found, Certification.NO_BOUND if certify else Certification.NOT_ASKED)
        columns = {name: led.whole(getattr(found, name)) for name in ("v", "first", "second")}
        return found.with_columns(**columns)

    return Leg(lead=led.lead, begin=nodes[0].t, end=nodes[-1].t, rows=rows)


def _without_unknowns(model: Model, drive: Drive, start: Array) -> PositionCurve:
    """A driven link or slider alone: the input is the position."""
    value = float(start[0])
    angle = bool(model.compiled.table.is_angle[0])
    reach = 0.5 * FULL_TURN if angle else model.equations.length_scale

    def rows(values: Array, certify: bool) -> SolvedRows:
        v = np.asarray(values, dtype=float)[:, None]
        count, proved = len(v), Certification.CERTIFIED if certify else Certification.NOT_ASKED
        return SolvedRows.blank(v, 1, Status.CONVERGED, proved).with_columns(
            v=v,
            first=np.ones_like(v),
            second=np.zeros_like(v),
            residual=np.zeros(count),
            condition=np.ones(count),
            radius=np.zeros(count),
            uniqueness_radius=np.full(count, np.inf),
        )

    if angle:
        leg = Leg(lead=0, begin=value - reach, end=value + reach, rows=rows)
        gain = np.full(1, FULL_TURN)
        return PositionCurve(legs=(leg,), home=0, value=value, closed=True, gain=gain)
    # every leg is twice as far as the one before, so that its tables resolve what is near
    edges = value + reach * np.concatenate(
        [-(2.0 ** np.arange(_DOUBLINGS))[::-1], 2.0 ** np.arange(_DOUBLINGS)]
    )
    legs = [Leg(lead=0, begin=a, end=b, rows=rows) for a, b in pairwise(edges.tolist())]
    why = f"the input is {edges[-1] - value:.2g} {model.description.length} from its start"
    home = _DOUBLINGS - 1
    return PositionCurve(
        legs=tuple(legs), home=home, value=value, closed=False, gain=np.zeros(1), ends=(why, why)
    )
