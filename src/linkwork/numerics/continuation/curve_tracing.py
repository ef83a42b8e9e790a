"""Following a curve of positions beyond dead points, by changing which variable leads.

The curve F(x, t) = 0 turns back in t at a dead point, where dx/dt is infinite. With one of the fast
unknowns in the lead it is an ordinary branch again (local parametrisation: Rheinboldt & Burkardt
1983, doi:10.1145/357456.357460). A curve is therefore a chain of legs, each followed and proved by
the same means as a sweep; only a crossing of curves stops it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.circuit_end import CircuitEnd
from linkwork.numerics.continuation.branch_tracking import BOLD, End, Node, TrackOptions, follow
from linkwork.numerics.continuation.change_point import Crossing
from linkwork.numerics.continuation.curve_crossing import CrossingsAhead, crossing_beyond
from linkwork.numerics.continuation.local_parametrization import (
    Parametrization,
    Parametrizations,
    fastest_leader,
    same_position,
)
from linkwork.numerics.continuation.proved_tracking import follow_with_proof
from linkwork.numerics.continuation.starting_value import Pass, StartingValue

__all__ = ["Curve", "CurveOptions", "Leg", "trace"]

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
    known: Sequence[Crossing] | None = None,
) -> Curve:
    """Follow the curve through a position until it closes or ends.

    Parameters
    ----------
    start : (N,)
        A position on the curve, not where curves cross.
    heading : float or (N,)
        How the variables move at first, in direction; +1 for a growing parameter, -1 for a falling
        one.
    known : sequence of Crossing, optional
        Change points that need not be located again if the curve comes to one. By default all are
        approached as far as rounding allows and located.
    """
    if isinstance(heading, float):
        side, heading = heading, np.zeros(len(start))
        heading[leads.parameter] = side
    return _Tracer(leads, start, heading, options or CurveOptions(), known).run()


class _Tracer:
    """The state of one trace: the position reached and the direction of travel."""

    def __init__(
        self,
        leads: Parametrizations,
        start: Array,
        heading: Array,
        options: CurveOptions,
        known: Sequence[Crossing] | None,
    ) -> None:
        self.leads, self.start, self.options = leads, start, options
        self.here, self.heading = start, heading
        self.crossing: Crossing | None = None
        self.ahead = None if known is None else CrossingsAhead(leads, known)
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
            stuck, avoid = 0, None if self.ahead is None else self.ahead.take_avoided()
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
            if self.ahead is not None and not prove:
                self.crossing = self.ahead.next_of(led, after, sign, self.home)
                if self.crossing is not None or self.ahead.avoided is not None:
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
