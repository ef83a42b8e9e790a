"""Where the parameter of a curve has its starting value again, modulo whole turns."""

from __future__ import annotations

import itertools
import math

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import EPSILON, LARGEST_POLISH
from linkwork.foundation.status import CONVERGED
from linkwork.numerics.continuation.branch_tracking import Node
from linkwork.numerics.continuation.local_parametrization import Parametrization, Parametrizations
from linkwork.numerics.continuation.step_division import node_between, one_way, reach, share_at

__all__ = ["Pass", "StartingValue"]

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
        best: Node | None = None
        off = _REACHED * max(1.0, abs(value))
        for _ in range(60):
            here = node_between(led, low, high, share_at(place, low, high, value))
            if here is None or here.t in (low.t, high.t):
                break
            gap = abs(float(here.v[place]) - value)
            if gap <= off:
                best, off = here, gap
            if gap <= 2.0 * EPSILON * max(1.0, abs(value)):
                break
            if (here.v[place] < value) == (low.v[place] < value):
                low = here
            else:
                high = here
        if best is None and abs(float(high.v[place]) - value) <= off:
            best = high
        return None if best is None else self._polish(led, best, value)

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
