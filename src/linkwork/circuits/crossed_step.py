"""A step of a curve that leads across a change point, and the curve up to that point.

Steps keep the sign of det J, but where two crossings coincide the sign is the same on both sides.
Such a step cannot be proved. The place in it that is nearest to a singular one is next to the
change point, if there is one.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from linkwork.core.foundation.statuses import CircuitEnd
from linkwork.core.numerics.branch_tracking import BOLD, Node, follow
from linkwork.core.numerics.curve_tracing import Curve, Leg, crossing_beyond, node_between
from linkwork.core.numerics.local_parametrization import Parametrization, Parametrizations

_NARROWINGS = 24  # of a step at most, each
_INSIDE = (0.4, 0.6)  # to before the second or behind the first of these shares
_SHORT = 5e-4  # of the leader's natural size: from so near change points are located


def cut_at_crossing(leads: Parametrizations, curve: Curve, number: int, after: int) -> Curve | None:
    """The curve up to a change point in the step behind the node ``after`` of a leg.

    Returns
    -------
    Curve or None
        ``None`` if no change point is found there. It may need another leader than the leg's: the
        curve then has one more leg.
    """
    leg = curve.legs[number]
    if not 0 <= after < len(leg.nodes) - 1:
        return None
    low = _before_singular(leg.led, *leg.nodes[after : after + 2])
    if low is None:
        return None
    way = replace(leg, nodes=(*leg.nodes[: after + 1], low))
    sign = math.copysign(1.0, leg.nodes[-1].t - leg.nodes[0].t)
    v, heading = leg.led.whole(low.v), sign * leg.led.whole(low.first)
    speed = np.abs(heading) / leads.scale
    for lead in np.argsort(-speed, kind="stable").tolist():
        led = leads.with_parameter(lead)
        if led is None or not speed[lead] > 0.0:
            continue
        here, side = led.node(v), math.copysign(1.0, heading[lead])
        found = crossing_beyond(leads, led, here, side)
        if found is None:
            continue
        nodes, end = follow(led.solver, led.path, here, 0.5 * (here.t + float(found.v[lead])), BOLD)
        if end is not None or not nodes:
            continue
        return Curve(
            legs=(*curve.legs[:number], way, Leg(led=led, nodes=(here, *nodes))),
            end=CircuitEnd.CHANGE_POINT,
            passes=tuple(each for each in curve.passes if each[0] < number),
            crossing=found,
        )
    return None


def _before_singular(led: Parametrization, low: Node, high: Node) -> Node | None:
    """The node of a step just before its place that is nearest to a singular one."""
    for _ in range(_NARROWINGS):
        if abs(high.t - low.t) <= _SHORT * led.path.size:
            break
        first, second = (node_between(led, low, high, share) for share in _INSIDE)
        if first is None or second is None:
            return None
        if first.nearness < second.nearness:
            low = first
        else:
            high = second
    return low
