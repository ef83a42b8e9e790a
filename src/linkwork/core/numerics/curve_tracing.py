"""Steps of a curve divided so that a variable is monotonic in each piece."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, LARGEST_POLISH, Array
from linkwork.core.foundation.statuses import CONVERGED, CircuitEnd
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.numerics.branch_tracking import (
    BOLD,
    End,
    Node,
    Parametrization,
    Parametrizations,
    TrackOptions,
    fastest_leader,
    follow,
    follow_with_proof,
    node_at,
    same_position,
)
from linkwork.core.numerics.change_point import Crossing, locate_change_point
from linkwork.core.numerics.newton import sharp

_STILL = 8.0 * EPSILON  # relative: a variable that moves less over a step rests, to rounding
_DIVISIONS = 24  # halvings of a step in which a variable turns back several times
_SAFE = 4.0  # the error of a cubic is at most this many times that halfway
_SEARCH = 80  # positions solved to find a sign change
_EDGE = 1e-3  # of a bracket: nearer to its ends nothing is tried
_SHARES = np.linspace(0.0, 1.0, 65)


def node_between(
    led: Parametrization, low: Node, high: Node, s: float, to_rounding: bool = False
) -> Node | None:
    """The node at the fraction s of a step; ``None`` if it is not found.

    Newton-Raphson from the cubic through both ends; where that fails, or comes onto another branch,
    by steps from the nearer end. ``to_rounding``: iterate down to rounding.
    """
    h = high.t - low.t
    guess = hermite(s, h, low.v, low.first, high.v, high.first)
    guess[-1] = low.t + s * h
    options = sharp(led.solver.options) if to_rounding else None
    found = led.solver.solve(guess[None, :], options)
    if found.status[0] == CONVERGED:
        here = node_at(led.solver, led.path, float(guess[-1]), found.v[0])
        sides = (here.orientation, low.orientation, high.orientation)
        if np.array_equal(sides[0], sides[1]) or not np.array_equal(sides[1], sides[2]):
            return here
    nearer = low if s < 0.5 else high
    nodes, end = follow(led.solver, led.path, nearer, float(guess[-1]))
    return nodes[-1] if nodes and end is None else None


def one_way(led: Parametrization, place: int, before: Node, after: Node) -> list[Node]:
    """A step, divided where a variable turns back within it."""
    chain = [before]
    for low, high in itertools.pairwise(divide_step(led, place, before, after)):
        if low.first[place] * high.first[place] < 0.0:
            chain.append(sign_change(led, low, high, lambda node: float(node.first[place])))
        chain.append(high)
    return chain


def sign_change(
    led: Parametrization,
    low: Node,
    high: Node,
    rate: Callable[[Node], float],
    to_rounding: bool = False,
) -> Node:
    """The node between two at which a rate changes sign, to rounding.

    False position with halved end values (Illinois: Dowell & Jarratt 1971, doi:10.1007/BF01934364),
    and bisection where the bracket does not shrink.
    """
    a, b = rate(low), rate(high)
    best = low if abs(a) < abs(b) else high
    least = min(abs(a), abs(b))
    before, kept = np.inf, 0  # the bracket's width three tries ago, the end that was kept last
    for number in range(_SEARCH):
        width = abs(high.t - low.t)
        if least == 0.0 or width <= 4.0 * EPSILON * max(1.0, abs(low.t)):
            break
        s = a / (a - b)  # eq. (38)
        if number % 3 == 0:
            # false position can creep from one side: every third try has to have quartered the
            # bracket
            s = s if width < 0.25 * before else 0.5
            before = width
        here = node_between(led, low, high, min(max(s, _EDGE), 1.0 - _EDGE), to_rounding)
        if here is None or here.t in (low.t, high.t):
            break
        value = rate(here)
        if abs(value) < least:
            best, least = here, abs(value)
        if (value > 0.0) == (a > 0.0):
            low, a = here, value
            b = 0.5 * b if kept < 0 else b  # eq. (38)
            kept = -1
        else:
            high, b = here, value
            a = 0.5 * a if kept > 0 else a  # eq. (38)
            kept = 1
    return best


def divide_step(
    led: Parametrization, place: int, a: Node, b: Node, depth: int = _DIVISIONS
) -> list[Node]:
    """A step, divided so finely that a variable turns back at most once in each piece.

    The cubic through the variable's rates and their derivatives at both ends is compared with the
    rate halfway. The step is halved until that cubic, within its error, is zero at most once;
    reversals within the rounding of the rate are not seen.
    """
    h = b.t - a.t
    ends = (a.first[place], a.second[place], b.first[place], b.second[place])
    low, high = reach(h, *ends)
    if low > 0.0 or high < 0.0:
        return [a, b]
    middle = node_between(led, a, b, 0.5) if h and depth else None
    if middle is None:
        return [a, b]
    size = max(abs(ends[0]), abs(ends[2]), abs(middle.first[place]))
    if size * abs(h) <= _STILL * max(1.0, abs(float(a.v[place]))):
        return [a, b]
    off = abs(float(middle.first[place]) - float(hermite(0.5, h, *ends)))
    if _zero_once(_SAFE * off + 8.0 * EPSILON * size, h, *ends):
        return [a, b]
    left = divide_step(led, place, a, middle, depth - 1)
    return [*left, *divide_step(led, place, middle, b, depth - 1)[1:]]


def reach(h: float, v0: float, d0: float, v1: float, d1: float) -> tuple[float, float]:
    """Between what bounds a variable stays over a step.

    The cubic through both ends stays between its Bernstein coefficients; what it departs from a
    line is allowed for once more, many times the error of a step that is not refused.
    """
    rise = v1 - v0
    bent = abs(3.0 * rise - h * (2.0 * d0 + d1)) + abs(h * (d0 + d1) - 2.0 * rise)  # eq. (19)
    points = (v0, v0 + h * d0 / 3.0, v1 - h * d1 / 3.0, v1)
    return min(points) - bent, max(points) + bent


def _zero_once(error: float, h: float, v0: float, d0: float, v1: float, d1: float) -> bool:
    """Whether any function that near to a cubic, as cubics through both ends are, has one zero.

    The cubic's error is about e · 16 s²(1 - s)², its slope's at most 3.1 e: where the function may
    be zero it must not level off.
    """
    value = hermite(_SHARES, h, v0, d0, v1, d1)
    slope = _hermite_slope(_SHARES, h, v0, d0, v1, d1)
    space = 0.5 * (_SHARES[1] - _SHARES[0])  # a cubic does not change more between two samples
    steepest = float(np.abs(slope).max()) + space * _steepest_change(h, v0, d0, v1, d1)
    near = np.abs(value) <= error + space * steepest
    if not near.any():
        return True
    # a function that near to the cubic has a slope of its own sign wherever it may be zero
    least = 3.1 * error + space * _steepest_change(h, v0, d0, v1, d1)
    rising, falling = slope[near] > least, slope[near] < -least
    return bool(rising.all() or falling.all())


def hermite(
    s: float | Array,
    h: float,
    v0: Array | float,
    d0: Array | float,
    v1: Array | float,
    d1: Array | float,
) -> Array:
    """The cubic through both ends of a step, at the fraction s of it."""
    rise = v1 - v0
    bend = 3.0 * rise - h * (2.0 * d0 + d1) + s * (h * (d0 + d1) - 2.0 * rise)  # eq. (19)
    value: Array = v0 + s * (h * d0 + s * bend)  # type: ignore[assignment]  # of numbers: one
    return value


def _hermite_slope(s: Array, h: float, v0: float, d0: float, v1: float, d1: float) -> Array:
    """Its derivative by s."""
    rise = v1 - v0
    square, cubic = 3.0 * rise - h * (2.0 * d0 + d1), h * (d0 + d1) - 2.0 * rise
    slope: Array = h * d0 + s * (2.0 * square + s * (3.0 * cubic))
    return slope


def _steepest_change(h: float, v0: float, d0: float, v1: float, d1: float) -> float:
    """The largest second derivative of the cubic by s, in size."""
    rise = v1 - v0
    square, cubic = 3.0 * rise - h * (2.0 * d0 + d1), h * (d0 + d1) - 2.0 * rise
    return max(abs(2.0 * square), abs(2.0 * square + 6.0 * cubic))


# ----------------------------------------------------------------------
# Where the parameter of a curve has its starting value again, modulo whole turns.


_REACHED = 1e-11  # a value of the parameter this near, relative, is reached


#: A value, and the ends of a piece of a step in which the parameter is monotonic and passes it.
Pass = tuple[float, Node, Node]


class StartingValue:
    """The values of the parameter at which the curve through a position can close.

    Parameters
    ----------
    own : Parametrization
        With the parameter in the lead.
    start : (N,)
    """

    def __init__(self, leads: Parametrizations, own: Parametrization, start: Array) -> None:
        self.leads, self.own = leads, own
        self._home = float(start[leads.parameter])
        self._period = FULL_TURN if leads.is_angle[leads.parameter] else math.inf

    def next_to(self, t: float, sign: float, leaving: float | None) -> float:
        """The next such value after t; ``leaving``: one of them that does not count."""
        home, period = self._home, self._period
        if not math.isfinite(period):
            if (home - t) * sign > 0.0 and home != leaving:
                return home
            return t + sign * 1e3 * float(self.leads.scale[self.leads.parameter])
        turns = (t - home) / period
        # rounding may give the value that the curve is just leaving: the loop below steps on
        number = math.floor(turns) + 1 if sign > 0 else math.ceil(turns) - 1
        while (home + number * period - t) * sign <= 0.0 or home + number * period == leaving:
            number += int(sign)
        return home + number * period

    def is_between(self, low: float, high: float) -> bool:
        """Whether there is such a value between two, or as near as rounding tells."""
        off = _REACHED * max(1.0, abs(low), abs(high))
        return self.next_to(low - off, 1.0, None) <= high + off

    def passes(
        self, led: Parametrization, before: Node, after: Node, leaving: float | None
    ) -> list[Pass]:
        """The first pass of such a value between two nodes, if any."""
        place = led.place(self.leads.parameter)
        ends = before.v[place], before.first[place], after.v[place], after.first[place]
        if not self.is_between(*reach(after.t - before.t, *ends)):
            return []
        for low, high in itertools.pairwise(one_way(led, place, before, after)):
            t0, t1 = float(low.v[place]), float(high.v[place])
            if t0 != t1:
                value = self.next_to(t0, math.copysign(1.0, t1 - t0), leaving)
                if (value - t0) * (value - t1) <= 0.0:
                    return [(value, low, high)]
            leaving = None
        return []

    def node(self, led: Parametrization, passed: Pass) -> Node | None:
        """The position in a piece of a step at which the parameter has the value, to rounding.

        The piece is narrowed down at true positions: over a long step interpolation is not good
        enough close to a dead point, where the value is passed twice.
        """
        place = led.place(self.leads.parameter)
        value, low, high = passed
        here = sign_change(led, low, high, lambda node: float(node.v[place]) - value)
        reached = abs(float(here.v[place]) - value) <= _REACHED * max(1.0, abs(value))
        return self._polish(led, here, value) if reached else None

    def _polish(self, led: Parametrization, here: Node, value: float) -> Node:
        """The position with exactly the value, if the parameter determines it well enough."""
        own = self.own
        near = led.whole(here.v)
        side = own.node(near).orientation
        near[self.leads.parameter] = value
        found = own.solver.solve(near[own.order][None, :])
        v = own.whole(found.v[0])
        same = np.abs((v - near) / self.leads.scale).max() < LARGEST_POLISH
        # close to a dead point the correction may jump to the other branch
        same = same and np.array_equal(own.node(v).orientation, side)
        return led.node(v) if found.status[0] == CONVERGED and same else here


# ----------------------------------------------------------------------
# The change points at which traced curves end.


def crossing_beyond(
    leads: Parametrizations, led: Parametrization, last: Node, side: float
) -> Crossing | None:
    """The change point just beyond a node at which a curve could not be followed; ``side``: in
    which direction the leader was moving.
    """
    found = locate_change_point(led.solver, led.path, last, side)
    if found is None:
        return None
    v = led.whole(found.v)
    t, width = float(v[leads.parameter]), 0.5 * (found.bracket[1] - found.bracket[0])
    return Crossing(
        t=t,
        v=v,
        directions=np.stack([led.whole(d) for d in found.directions]),
        bracket=(t - width, t + width),
        located=found.located,
    )


def tangents_apart(leads: Parametrizations, crossing: Crossing) -> float:
    """How far the tangents at a change point are apart at the weighted distance 1 from it."""
    one, other = crossing.directions / leads.scale
    return min(float(np.abs(one - sign * other).max()) for sign in (1.0, -1.0))


# ----------------------------------------------------------------------
# Following a curve of positions beyond dead points, by changing which variable leads.
#
# The curve F(x, t) = 0 turns back in t at a dead point, where dx/dt is infinite. With one of the
# fast unknowns in the lead it is an ordinary branch again (local parametrisation: Rheinboldt &
# Burkardt 1983, doi:10.1145/357456.357460). A curve is therefore a chain of legs, each followed and
# proved by the same means as a sweep; only a crossing of curves stops it.


_APART = 0.3  # of the largest condition of ordinary steps: where these go on behind proved ones
_MOST_PROVED = 4  # legs of proved steps past one place
_MOST_NODES = 120  # of such a leg: more do not lead past
_LEG = 8.0  # natural sizes of the leader, after which a leg ends if nothing else ends it


@dataclass(frozen=True, kw_only=True)
class CurveOptions:
    """When another variable takes the lead, and when a curve is given up.

    ``fast``: the leader is replaced where another variable moves this many times faster [weighted].
    ``slow``: the parameter leads again where nothing moves faster than this many times its rate.
    ``far``: a length this many times the mechanism's own has run to infinity.
    ``most_turns``: of the parameter, after which the curve counts as never closing.
    ``most_proved_legs``: of proved steps, each within a second, past places where steps shrink.
    """

    fast: float = 6.0
    slow: float = 3.0
    far: float = 1e4
    most_turns: int = 60
    most_legs: int = 2000
    most_proved_legs: int = 32
    track: TrackOptions = field(default_factory=lambda: BOLD)


@dataclass(frozen=True, kw_only=True, eq=False)
class Leg:
    """A piece of a curve with one leader; nodes in the order traced, in the solver's order."""

    led: Parametrization
    nodes: tuple[Node, ...]

    @cached_property
    def v(self) -> Array:
        """Positions (K, N), all variables in their order."""
        return self.led.whole(np.stack([node.v for node in self.nodes]))

    @cached_property
    def first(self) -> Array:
        """First derivatives with respect to the leader, (K, N), all variables in their order."""
        return self.led.whole(np.stack([node.first for node in self.nodes]))

    @cached_property
    def second(self) -> Array:
        """Second derivatives with respect to the leader, (K, N)."""
        return self.led.whole(np.stack([node.second for node in self.nodes]))


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """Legs in the order traced and why the curve ends.

    ``passes``: the positions (N,) at which the parameter passed its starting value modulo
    whole turns, each with the number of the leg that it ends. ``crossing``: the change point that
    it ends at.
    """

    legs: tuple[Leg, ...]
    end: CircuitEnd
    passes: tuple[tuple[int, Array], ...]
    crossing: Crossing | None = None

    @property
    def last(self) -> tuple[Parametrization, Node]:
        """Where it ends."""
        leg = self.legs[-1]
        return leg.led, leg.nodes[-1]


def trace(
    leads: Parametrizations,
    start: Array,
    heading: float | Array,
    options: CurveOptions | None = None,
) -> Curve:
    """Follow the curve through a position until it closes or ends.

    Parameters
    ----------
    start : (N,)
        A position on the curve, not where curves cross.
    heading : float or (N,)
        How the variables move at first, in direction; +1 for a growing parameter, -1 for a falling
        one.
    """
    if isinstance(heading, float):
        side, heading = heading, np.zeros(len(start))
        heading[leads.parameter] = side
    return _Tracer(leads, start, heading, options or CurveOptions()).run()


class _Tracer:
    """The state of one trace: the position reached and the direction of travel."""

    def __init__(
        self,
        leads: Parametrizations,
        start: Array,
        heading: Array,
        options: CurveOptions,
    ) -> None:
        self.leads, self.start, self.options = leads, start, options
        self.here, self.heading = start, heading
        self.crossing: Crossing | None = None
        self.legs: list[Leg] = []
        self.passes: list[tuple[int, Array]] = []
        self.proved_legs = 0
        # the starting value, on which the curve is now: it does not count as passed again at once
        self.leaving: float | None = float(start[leads.parameter])
        own = leads.with_parameter(leads.parameter)
        if own is None:
            raise ValueError("the parameter of a curve must determine the position")
        self.home = StartingValue(leads, own, start)
        if np.count_nonzero(heading) == 1 and heading[leads.parameter]:
            rates = own.whole(own.node(start).first)
            if np.isfinite(rates).all():
                self.heading = heading[leads.parameter] * rates

    def run(self) -> Curve:
        """Leg after leg."""
        opt, stuck = self.options, 0
        avoid: int | None = None
        for _ in range(opt.most_legs):
            leader = self._leader(avoid)
            if leader is None:
                return self._end_trace(CircuitEnd.SINGULAR)
            led, node = leader
            leg, end = self._leg(led, node)
            moved = len(leg.nodes) > 1
            if moved:
                self.legs.append(leg)
                self._arrive(leg)
            if end is not None:
                self.crossing = self._crossing_beyond(leg)
            if self.crossing is not None:
                return self._end_trace(CircuitEnd.CHANGE_POINT)
            if end is not None:
                # another leader may pass where this one could not; if it cannot, J is singular
                stuck = 0 if moved else stuck + 1
                avoid = led.lead
                if stuck <= 1:
                    continue
                if not self._passes_with_proof():
                    return self._end_trace(CircuitEnd.SINGULAR)
            stuck, avoid = 0, None
            ending = self._ending()
            if ending is not None:
                return self._end_trace(ending)
        return self._end_trace(CircuitEnd.NEVER_CLOSES)

    def _passes_with_proof(self) -> bool:
        """Whether legs of proved steps lead on, to where branches are apart again or the parameter
        has its starting value.
        """
        most = self.options.most_proved_legs
        for _ in range(_MOST_PROVED):
            leader = self._leader(None)
            if leader is None or not leader[0].provable or self.proved_legs == most:
                return False
            self.proved_legs += 1
            leg, _ = self._leg(*leader, prove=True)
            if len(leg.nodes) < 2:
                return False
            self.legs.append(leg)
            self._arrive(leg)
            if len(leg.nodes) > _MOST_NODES:
                return False
            if self._has_passed:
                return True
            if leg.nodes[-1].nearness < self.options.track.largest_condition:
                return True
        return False

    @property
    def _has_passed(self) -> bool:
        """Whether the last leg has brought the parameter to its starting value."""
        return bool(self.passes) and self.passes[-1][0] == len(self.legs) - 1

    def _end_trace(self, end: CircuitEnd) -> Curve:
        return Curve(
            legs=tuple(self.legs), end=end, passes=tuple(self.passes), crossing=self.crossing
        )

    def _arrive(self, leg: Leg) -> None:
        last = leg.nodes[-1]
        self.here = leg.led.whole(last.v)
        sign = math.copysign(1.0, last.t - leg.nodes[0].t)
        self.heading = sign * leg.led.whole(last.first)

    def _leader(self, avoid: int | None) -> tuple[Parametrization, Node] | None:
        """The parameter where it is fast enough, else the fastest variable that determines all."""
        scale, parameter = self.leads.scale, self.leads.parameter
        speed = np.abs(self.heading) / scale
        first = parameter if speed[parameter] * self.options.slow >= speed.max() else None
        return fastest_leader(self.leads, self.here, speed, avoid, first)

    def _leg(
        self, led: Parametrization, node: Node, *, prove: bool = False
    ) -> tuple[Leg, End | None]:
        """One leg: up to a change of leader, a pass of the starting value, or an end.

        ``prove``: with every step proved, until branches are apart.
        """
        opt = self.options
        regular = _APART * opt.track.largest_condition
        parameter, scale = self.leads.parameter, self.leads.scale
        place = led.place(parameter)
        sign = math.copysign(1.0, self.heading[led.lead])
        weights = scale[led.order]
        own = led.lead == parameter
        passed: list[Pass] = []

        def done(before: Node, after: Node) -> bool:
            if prove and after.nearness < min(regular, before.nearness):
                return True
            speed = np.abs(after.first) / weights
            if not own:
                leaving = self.leaving if before is node else None
                passed.extend(self.home.passes(led, before, after, leaving))
                if passed or speed[place] * opt.slow >= speed.max():
                    return True
            if bool((np.abs(after.v / weights)[~self.leads.is_angle[led.order]] > opt.far).any()):
                return True
            return bool(speed.max() > opt.fast * speed[-1])

        size = float(weights[-1])
        # so that a circuit that runs to infinity ends after a few legs
        if not self.leads.is_angle[led.lead]:  # a length on its way to infinity doubles in one leg
            size = max(size, abs(node.t) / _LEG)
        goal = node.t + sign * _LEG * size
        if own:
            goal = self.home.next_to(node.t, sign, self.leaving)
        path = replace(led.path, size=size)
        end: End | None = None
        if prove:
            nodes = follow_with_proof(led.solver, path, node, goal, done)
        else:
            nodes, end = follow(led.solver, path, node, goal, opt.track, watch=done)
        chain = [node, *nodes]
        if nodes:
            self.leaving = None
        if passed:
            crossing = self.home.node(led, passed[0])
            if crossing is not None:
                chain[-1], self.leaving = crossing, passed[0][0]
                self.passes.append((len(self.legs), led.whole(crossing.v)))
        elif own and nodes and nodes[-1].t == goal:
            self.leaving = goal
            self.passes.append((len(self.legs), led.whole(nodes[-1].v)))
        return Leg(led=led, nodes=tuple(chain)), end

    def _crossing_beyond(self, leg: Leg) -> Crossing | None:
        """The change point at which a leg could not go on."""
        first, last = leg.nodes[0], leg.nodes[-1]
        sides = (1.0, -1.0) if first is last else (math.copysign(1.0, last.t - first.t),)
        found = (crossing_beyond(self.leads, leg.led, last, side) for side in sides)
        return next((one for one in found if one is not None), None)

    def _ending(self) -> CircuitEnd | None:
        v, scale = self.here, self.leads.scale
        lengths = ~self.leads.is_angle
        if np.abs(v / scale)[lengths].max(initial=0.0) > self.options.far:
            return CircuitEnd.RUNS_TO_INFINITY
        # only where the parameter has its starting value can the curve close
        if self._has_passed and same_position(self.leads, v, self.start):
            return CircuitEnd.CLOSED
        if abs(v - self.start)[self.leads.parameter] > self.options.most_turns * 2.0 * np.pi:
            return CircuitEnd.NEVER_CLOSES
        return None
