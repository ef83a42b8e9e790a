"""Curves of positions, traced one after the other and proved together."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from linkwork.circuits.branches import (
    CurveBranch,
    TracedCurve,
    branches_of,
    trace_with_proof,
)
from linkwork.core.foundation.arrays import CLOSER_TANGENT, REGULAR_CONDITION, Array
from linkwork.core.foundation.statuses import CircuitEnd, Status
from linkwork.core.motion.following import Drive
from linkwork.core.motion.model import FITS, misfit
from linkwork.core.numerics.branch_tracking import (
    Parametrizations,
    apart,
    coincide,
    fastest_leader,
    near,
    same_position,
)
from linkwork.core.numerics.change_point import Crossing
from linkwork.core.numerics.curve_tracing import tangents_apart
from linkwork.core.numerics.newton import newton

_IMPROVED = 1e-4  # weighted: how far a crossing's other blocks are moved at most


# ----------------------------------------------------------------------
# All curves of positions through given ones: closed curves, and arcs between crossings.
#
# Where two curves cross (a change point) four half-branches leave; each is followed, so that
# everything that is connected is found.


_FINE = 8  # positions of a branch per step of its curve
_STRIDES = (1e-2, 3e-3, 1e-3, 1e-4)  # weighted, tried in this order
_NEAR = 0.3  # weighted: positions further from a branch do not lie on it
_STILL = 1e-5  # weighted change of the parameter along an arc on which it rests, up to a crossing


@dataclass(frozen=True, kw_only=True, eq=False)
class Arc:
    """A curve, followed until it closes or ends.

    ``up``: the walk that began forwards; ``down``: the one backwards, if the first did not close.
    ``crossings``: numbers of the change points at its ends. ``branches``: in the order start's own,
    onwards, backwards; their positions between the nodes of the curve are interpolated.
    """

    up: TracedCurve
    down: TracedCurve | None
    end: CircuitEnd
    crossings: tuple[int, ...]
    branches: tuple[CurveBranch, ...]

    @property
    def walks(self) -> tuple[TracedCurve, ...]:
        """All pieces."""
        return (self.up,) if self.down is None else (self.up, self.down)

    @property
    def certified(self) -> bool:
        """Whether all of it is proved."""
        return all(walk.certified for walk in self.walks)


class Explorer:
    """All curves found so far, and the change points between them.

    ``prove_turns``: whether to prove where dead points are.
    """

    def __init__(self, drive: Drive, certify: bool, *, prove_turns: bool = True) -> None:
        self.drive, self.leads, self.certify = drive, drive.leads, certify
        self.prove_turns = prove_turns
        self.arcs: list[Arc] = []
        self.crossings: list[Crossing] = []
        self._covered: set[tuple[int, int, float]] = set()
        self._passed: list[tuple[Array, int]] = []

    def solved_branches(self, arc: Arc) -> tuple[CurveBranch, ...]:
        """The branches of an arc, all their positions solved."""
        return tuple(_branches(self.leads, arc.up, arc.down, solved=True))

    def visit(self, seed: Array) -> int:
        """The number of the arc through a position at which the parameter can lead.

        The curve is followed if it is new, with everything that branches off at change points of
        arcs on which redundant links fit.
        """
        first, number = self.arc_through(seed), 0
        while number < len(self.crossings):
            if any(number in arc.crossings and self.fits(arc) for arc in self.arcs):
                while self.branch_off(number):
                    pass
            number += 1
        return first

    def arc_through(self, seed: Array) -> int:
        """The number of the arc through a position; it is followed if it is new."""
        number = self.known_arc(seed)
        return self._explore(seed, 1.0) if number is None else number

    def known_arc(self, seed: Array) -> int | None:
        """The number of the arc through a position, if that is followed already."""
        # positions that walks have passed at the starting value: the cheapest test comes first
        for k in near(self.leads, [v for v, _ in self._passed], seed):
            v, number = self._passed[k]
            if same_position(self.leads, v, seed):
                return number
        for number, arc in enumerate(self.arcs):
            if any(_lies_on(self.leads, branch, seed) for branch in arc.branches):
                return number
        return None

    def branch_off(self, number: int) -> bool:
        """Follow a half-branch of a crossing that no arc came along and on which redundant links
        fit; false if none is left.
        """
        crossing = self.crossings[number]
        for k, sign in self.half_branches(number):
            self._covered.add((number, k, sign))
            direction = sign * crossing.directions[k]
            beyond = _beyond(self.leads, crossing, direction)
            # an arc along which redundant links do not fit leads nowhere: nothing moves along it
            if beyond is not None and self._fit_at(beyond[None, :]):
                self._explore(beyond, direction)
                return True
        return False

    def half_branches(self, number: int) -> list[tuple[int, float]]:
        """Those of a crossing that no arc came along: the number of the direction, and its sign."""
        both = [(k, sign) for k in (0, 1) for sign in (1.0, -1.0)]
        return [(k, sign) for k, sign in both if (number, k, sign) not in self._covered]

    def fits(self, arc: Arc) -> bool:
        """Whether redundant links fit all along an arc."""
        return all(self._fit_at(leg.v) for walk in arc.walks for leg in walk.curve.legs)

    def _fit_at(self, v: Array) -> bool:
        """Whether redundant links fit at all of some positions (K, N)."""
        return bool((misfit(self.drive.model.equations, v) <= FITS).all())

    def _explore(self, seed: Array, heading: float | Array) -> int:
        """Follow the curve through a seed both ways; the number of the arc."""
        up, above = self._walk(seed, heading)
        down, below = (None, None) if up.curve.end.closed else self._walk(seed, -heading)
        ends = [c for c in (above, below) if c is not None]
        return self._keep(up, down, seed, ends)

    def _keep(self, up: TracedCurve, down: TracedCurve | None, seed: Array, ends: list[int]) -> int:
        number = len(self.arcs)
        reasons = [walk.curve.end for walk in (up, down) if walk is not None]
        # the reason that leaves most open
        reason = max(reasons, key=list(CircuitEnd).index)
        arc = Arc(
            up=up,
            down=down,
            end=reason,
            crossings=tuple(ends),
            branches=tuple(_branches(self.leads, up, down, solved=False)),
        )
        if _rests(self.leads, arc):
            arc = replace(arc, end=CircuitEnd.INPUT_CONSTANT)
        self.arcs.append(arc)
        self._passed.append((seed, number))
        for walk in arc.walks:
            self._passed += [(v, number) for _, v in walk.curve.passes]
        return number

    def _walk(self, start: Array, heading: float | Array) -> tuple[TracedCurve, int | None]:
        """A walk and the number of the crossing it ends at, if it does."""
        walk = trace_with_proof(
            self.leads, start, heading, self.certify, prove_turns=self.prove_turns
        )
        found = walk.curve.crossing
        if found is None or not walk.curve.legs:
            return walk, None
        led, node = walk.curve.last
        first = walk.curve.legs[-1].nodes[0]
        side = math.copysign(1.0, node.t - first.t)
        return walk, self._register(found, -side * led.whole(node.first))

    def _register(self, found: Crossing, came_from: Array) -> int:
        found = replace(found, v=_improved(self.drive, found.v))
        number = next(
            (k for k, one in enumerate(self.crossings) if coincide(self.leads, one.v, found.v)),
            len(self.crossings),
        )
        if number == len(self.crossings):
            self.crossings.append(found)
        units = self.crossings[number].directions / self.leads.scale
        # directions are compared by their angle, not by their size
        along = units @ (came_from / self.leads.scale) / np.linalg.norm(units, axis=1)
        # the half-branch that points back to where the walk came from
        k = int(np.abs(along).argmax())
        self._covered.add((number, k, math.copysign(1.0, along[k])))
        return number


def _improved(drive: Drive, v: Array) -> Array:
    """A crossing (N,) with the blocks that do not cross there solved to rounding.

    Where another block is near its own change point, its unknowns are known less well.
    """
    found = v.copy()
    for block in drive.solver.blocks:
        here, n = found[None, block.variables], len(block.unknowns)
        done = newton(block.system, here)
        moved = np.abs((done.v - here)[0, :n] / block.system.variable_scale[:n]).max(initial=0.0)
        if done.status[0] == Status.CONVERGED.code and moved < _IMPROVED:
            slope = block.system.jacobian(done.v)[0, :, :n] * block.system.variable_scale[:n]
            if np.linalg.cond(slope / block.system.equation_scale[:, None]) < REGULAR_CONDITION:
                found[block.unknowns] = done.v[0, :n]
    return found


def _beyond(leads: Parametrizations, crossing: Crossing, direction: Array) -> Array | None:
    """A position just beyond a crossing along a direction, clearly not on the other curve."""
    v, speed = crossing.v, np.abs(direction) / leads.scale
    gap = tangents_apart(leads, crossing)
    leader = fastest_leader(leads, v, speed)
    lead = int(np.argmax(speed)) if leader is None else leader[0].lead
    led = leads.with_parameter(lead)
    if led is None:
        return None
    for stride in _STRIDES:
        guess = v + stride * direction
        done = led.solver.solve(guess[led.order][None, :])
        if done.status[0] != Status.CONVERGED.code:
            continue
        found = led.whole(done.v[0])
        moving = speed > 0.0
        off = float(np.abs((found - guess) / leads.scale)[moving].max())
        # much nearer to this tangent than to the other: a smaller stride separates them better
        if off <= CLOSER_TANGENT * stride * gap and led.node(found).nearness < REGULAR_CONDITION:
            return found
    return None


def _branches(
    leads: Parametrizations, up: TracedCurve, down: TracedCurve | None, *, solved: bool
) -> list[CurveBranch]:
    """The branches of an arc; the first one is joined from both walks."""
    onward, back = (
        branches_of(leads, walk, _FINE, solved=solved)
        if walk is not None and walk.curve.legs
        else []
        for walk in (up, down)
    )
    if not onward or not back:
        return onward or back
    first, first_back = onward[0], back[0]
    best = first if first.ratio >= first_back.ratio else first_back
    joined = replace(
        first,
        v=np.concatenate([first_back.v[:0:-1], first.v]),
        limits=(*first_back.limits[:0:-1], *first.limits),
        begin=first_back.end,
        anchor=best.anchor,
        leader=best.leader,
        ratio=best.ratio,
        proved=first.proved and first_back.proved,
    )
    return [joined, *onward[1:], *back[1:]]


def _lies_on(leads: Parametrizations, branch: CurveBranch, seed: Array) -> bool:
    """Whether a position is that of a branch at the same value of the parameter.

    The branch's samples are so dense that Newton's method from between two of them stays there.
    """
    own = leads.with_parameter(leads.parameter)
    if own is None:
        return False
    for guess in _positions_near(leads, branch, float(seed[leads.parameter])):
        # far from the branch: Newton-Raphson could only come back to it
        if np.abs(apart(leads, guess, seed) / leads.scale).max() > _NEAR:
            continue
        done = own.solver.solve(guess[own.order][None, :])
        if done.status[0] != Status.CONVERGED.code:
            continue
        if same_position(leads, own.whole(done.v[0]), seed):
            return True
    return False


def positions_at_value(leads: Parametrizations, branch: CurveBranch, value: float) -> list[Array]:
    """The positions (N,) of a branch at a value of the parameter, modulo whole turns."""
    own = leads.with_parameter(leads.parameter)
    found = []
    for guess in _positions_near(leads, branch, value):
        if own is not None:
            done = own.solver.solve(guess[own.order][None, :])
            if done.status[0] == Status.CONVERGED.code:
                found.append(own.whole(done.v[0]))
    return found


def _positions_near(leads: Parametrizations, branch: CurveBranch, value: float) -> list[Array]:
    """Interpolated positions (N,) of a branch at a value of the parameter, modulo whole turns."""
    p = leads.parameter
    low, high = branch.range(p)
    shifts = [0.0]
    if leads.is_angle[p]:
        turn = 2.0 * math.pi
        first, last = math.ceil((low - value) / turn), math.floor((high - value) / turn)
        shifts = [k * turn for k in range(first, last + 1)]
    order = np.argsort(branch.v[:, p], kind="stable")
    t = branch.v[order, p]
    found = []
    for shift in shifts:
        here = value + shift
        if low <= here <= high:
            k = int(np.clip(np.searchsorted(t, here, side="right") - 1, 0, len(t) - 2))
            width = t[k + 1] - t[k]
            s = (here - t[k]) / width if width else 0.0
            # samples are dense: a line between two of them lies in the basin of the branch
            guess = (1.0 - s) * branch.v[order[k]] + s * branch.v[order[k + 1]]
            guess[p] = here
            found.append(guess)
    return found


def _rests(leads: Parametrizations, arc: Arc) -> bool:
    """Whether the parameter is constant along the whole arc."""
    p = leads.parameter
    values = [leg.v[:, p] for walk in arc.walks for leg in walk.curve.legs]
    if not values:
        return False
    return bool(np.ptp(np.concatenate(values)) < _STILL * leads.scale[p])


def is_regular(leads: Parametrizations, v: Array, most: float = REGULAR_CONDITION) -> bool:
    """Whether the input can lead at a position (N,): not at dead points and change points.

    ``most``: the condition of the equations there.
    """
    own = leads.with_parameter(leads.parameter)
    return own is not None and own.node(v).nearness < most
