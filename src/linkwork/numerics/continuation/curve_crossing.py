"""The change points at which traced curves end: located, or known from curves before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import CLOSER_TANGENT
from linkwork.numerics.continuation.branch_tracking import Node, node_at, predict
from linkwork.numerics.continuation.change_point import Crossing, is_clear, locate_change_point
from linkwork.numerics.continuation.local_parametrization import (
    Parametrization,
    Parametrizations,
    near,
    whole_turns,
)
from linkwork.numerics.continuation.starting_value import StartingValue
from linkwork.numerics.continuation.step_division import hermite

__all__ = ["CrossingsAhead", "crossing_beyond", "tangents_apart"]

_EARLY = 3e3  # nearness from which on a change point is looked for
_NEAR = 0.05  # weighted: how near a node has to be to the known change point that its curve meets
_TAYLOR = 0.01  # of the distance of both tangents there: how far from it Taylor's polynomial ends
_NEXT_TO = 1e-4  # weighted: how near to it its Jacobian is looked at,
_PART = 0.1  # or as this part of the way
_SLOWEST = 0.2  # weighted rate of a leader that leads to a change point, to the fastest
_RESTS = 1e-9  # weighted rate of a parameter that rests
_GROWTH = 1.2  # the condition grows like 1/distance from a change point, to within this factor


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
        clear=is_clear(led.solver, found),
    )


def tangents_apart(leads: Parametrizations, crossing: Crossing) -> float:
    """How far the tangents at a change point are apart at the weighted distance 1 from it."""
    one, other = crossing.directions / leads.scale
    return min(float(np.abs(one - sign * other).max()) for sign in (1.0, -1.0))


class CrossingsAhead:
    """The change points that a curve may end at without being followed up to them.

    Parameters
    ----------
    known : sequence of Crossing
        Those at which curves before have ended.

    Attributes
    ----------
    avoided : int, optional
        A leader with which none can be located. Where several blocks cross, it depends on the
        leader whether the crossing of one can be located alone.
    """

    def __init__(self, leads: Parametrizations, known: Sequence[Crossing]) -> None:
        self.leads, self.known = leads, known
        self.avoided: int | None = None
        self._tried: list[int] = []

    def take_avoided(self) -> int | None:
        """The leader to avoid, once."""
        found, self.avoided = self.avoided, None
        return found

    def next_of(
        self, led: Parametrization, here: Node, side: float, home: StartingValue
    ) -> Crossing | None:
        """That which the branch of a node meets next, as many whole turns away, unless its
        parameter has its starting value before; ``side``: in which direction the leader moves.
        """
        known = [*self.known]
        if here.nearness > _EARLY and led.lead not in self._tried:
            self._tried.append(led.lead)
            early = crossing_beyond(self.leads, led, here, side)
            if early is not None:
                known.append(early)
            elif len(self._tried) == 1:
                self.avoided = led.lead
        leads, v = self.leads, led.whole(here.v)
        for k in near(leads, [crossing.v for crossing in known], v, _NEAR):
            turns = whole_turns(leads, known[k].v, v)
            if known[k].clear and leads.repeats_after(turns):
                crossing = _moved(known[k], turns, leads.parameter)
                if _meets(leads, led, here, side, crossing):
                    ends = sorted((float(v[leads.parameter]), crossing.t))
                    return None if home.is_between(*ends) else crossing
        return None


def _moved(crossing: Crossing, turns: Array, parameter: int) -> Crossing:
    """A change point some whole turns (N,) away."""
    by = FULL_TURN * turns
    low, high = (edge + float(by[parameter]) for edge in crossing.bracket)
    v = crossing.v + by
    return replace(crossing, t=float(v[parameter]), v=v, bracket=(low, high))


def _meets(
    leads: Parametrizations, led: Parametrization, here: Node, side: float, crossing: Crossing
) -> bool:
    """Whether the branch of a node meets a change point next.

    Two curves pass a simple change point, and no others come near it. A branch is taken for one of
    them if the node lies next to its tangent, far from the other one's, if Taylor's polynomial of
    the node ends in the change point, and if J becomes singular there and not before.
    """
    weights, place = leads.scale[led.order], led.place(leads.parameter)
    end, tangents = crossing.v[led.order], crossing.directions[:, led.order]
    # blocks that take no part have no tangent there
    moving, h = (tangents != 0.0).any(axis=0), float(end[-1]) - here.t
    own = here.first / weights / np.abs(here.first / weights)[moving].max()
    tangents = tangents * np.copysign(1.0, tangents[:, -1:])
    off = np.abs(tangents / weights - own)[:, moving].max(axis=1)
    tangent = tangents[int(off.argmin())]
    if tangent[-1] < _SLOWEST * weights[-1] or h * side <= 0.0:
        return False
    slope, way = tangent / tangent[-1], abs(h / tangent[-1])
    room = way * tangents_apart(leads, crossing)
    beside = np.abs(here.v - (end - h * slope))[moving] / weights[moving]
    missed = np.abs(predict(here, float(end[-1])) - end) / weights
    if not (beside.max() <= CLOSER_TANGENT * room and missed.max() <= _TAYLOR * room):
        return False
    # the slope of the cubic through both ends
    rise = 3.0 * (end[place] - here.v[place]) / h - here.first[place] - slope[place]
    rates = np.array([here.first[place], rise, slope[place]]) / weights[place]
    if not (rates > -_RESTS).all() and not (rates < _RESTS).all():
        return False  # the parameter may turn back on the way
    part = min(_NEXT_TO / way, _PART)
    v = hermite(1.0 - part, h, here.v, here.first, end, slope)
    back = predict(here, float(v[-1])) - predict(here, float(end[-1]))
    v = np.where(moving, v, end + back)
    node = node_at(led.solver, led.path, float(v[-1]), v)
    growth = node.condition * part / here.condition
    same = np.array_equal(node.orientation, here.orientation)
    return same and 1.0 / _GROWTH <= growth <= _GROWTH
