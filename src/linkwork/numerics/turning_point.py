"""Dead points: where the parameter of a curve of positions turns back, to machine precision.

With a fast unknown in the lead the dead point is an ordinary position at which the parameter's rate
is zero, so Newton-Raphson on that rate finds it, and the branch through it can be proved.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.status import Status
from linkwork.numerics.curve import Curve, CurveOptions, Leg
from linkwork.numerics.divided_steps import divided
from linkwork.numerics.leaders import Leads, Led, fastest_leader
from linkwork.numerics.track import Node, follow, node_at

__all__ = ["TurningPoint", "turn_beyond", "turning_points"]

_CONVERGED = Status.CONVERGED.code
_UNIT = np.finfo(float).eps
_MOST_STEPS = 400  # to a dead point ahead: it is near, unless it is none
_RESTING = 1e-7  # weighted rate below which the parameter may not move at all,
_LEVEL = 100.0  # nor does it if the rate's own rate is at most so many times that


@dataclass(frozen=True, kw_only=True, eq=False)
class TurningPoint:
    """Where the parameter turns back on a curve: a dead point.

    ``v`` (N,) the position; ``bracket`` of the parameter around it; ``direction`` (N,) how the
    variables move through it (weighted norm 1). ``leg``, ``after``: behind which node of the curve
    it lies. ``node``: the position as the leg's leader sees it.
    """

    t: float
    bracket: tuple[float, float]
    v: Array
    direction: Array
    located: bool
    leg: int
    after: int
    node: Node


def turning_points(leads: Leads, curve: Curve) -> Iterator[TurningPoint]:
    """The dead points on a curve, in its order.

    Where the parameter's rate by the leader changes sign, Newton-Raphson on that rate, kept inside
    the sign change, finds the place. Steps in which the rate may change sign twice are divided.
    """
    for number, leg in enumerate(curve.legs):
        if leg.led.lead == leads.parameter:
            continue
        place = leg.led.place(leads.parameter)
        still = _RESTING * leads.scale[leads.parameter] / leads.scale[leg.led.lead]
        level = _LEVEL * still / leads.scale[leg.led.lead]
        for k, (a, b) in enumerate(itertools.pairwise(leg.nodes)):
            if all(
                abs(node.first[place]) < still and abs(node.second[place]) < level
                for node in (a, b)
            ):
                continue
            chain = divided(leg.led, place, a, b)
            for low, high in itertools.pairwise(chain):
                if _rises(low, place) is not _rises(high, place):
                    yield _refined(leads, leg.led, low, high, (number, k))


def _rises(node: Node, place: int) -> bool:
    """Whether the parameter grows with the leader; a rate of exactly zero counts as growing."""
    return bool(node.first[place] >= 0.0)


def turn_beyond(
    leads: Leads, v: Array, rates: Array, side: float, options: CurveOptions | None = None
) -> tuple[Leg, TurningPoint] | None:
    """The dead point ahead of a position at which a branch could not be followed further.

    Parameters
    ----------
    v, rates : (N,)
        The position and its derivatives by the parameter.
    side : float
        +1 if the parameter was growing, -1 if it was falling.

    Returns
    -------
    leg, turn
        The way from the position through the dead point, led by the fastest variable; ``None`` if
        the parameter does not turn back there.
    """
    opt = options or CurveOptions()
    speed = np.abs(rates / leads.scale)
    leader = fastest_leader(leads, v, speed, avoid=leads.parameter)
    if leader is None:
        return None
    led, node = leader
    place = led.place(leads.parameter)
    sign = math.copysign(1.0, side * rates[led.lead])
    weight = float(leads.scale[led.lead])
    nodes, _ = follow(
        led.solver,
        led.path,
        node,
        node.t + sign * weight,
        replace(opt.track, most_steps=_MOST_STEPS),
        watch=lambda _, after: bool(after.first[place] * node.first[place] <= 0.0),
    )
    if not nodes or nodes[-1].first[place] * node.first[place] > 0.0:
        return None
    before = nodes[-2] if len(nodes) > 1 else node
    pieces = itertools.pairwise(divided(led, place, before, nodes[-1]))
    low, high = next(  # the first one, where there are several
        pair for pair in pieces if pair[0].first[place] * pair[1].first[place] <= 0.0
    )
    turn = _refined(leads, led, low, high, (0, max(len(nodes) - 1, 0)))
    chain = (node, *nodes[:-1], turn.node) if turn.node.t != before.t else (node, *nodes[:-1])
    return Leg(led=led, nodes=chain), turn


def _refined(leads: Leads, led: Led, low: Node, high: Node, where: tuple[int, int]) -> TurningPoint:
    place, p = led.place(leads.parameter), leads.parameter
    best = here = low if abs(low.first[place]) < abs(high.first[place]) else high
    sharp = replace(led.solver.options, equation_tolerance=_UNIT)
    located, step = False, np.inf
    for _ in range(60):
        step = -here.first[place] / here.second[place] if here.second[place] else np.inf
        if abs(step) <= 4.0 * _UNIT * max(1.0, abs(here.t)):
            located = True
            break
        s = here.t + step
        edges = sorted((low.t, high.t))
        if not edges[0] < s < edges[1]:
            s = 0.5 * (low.t + high.t)
            step = s - here.t
        guess = here.v + step * here.first + 0.5 * step * step * here.second
        guess[-1] = s
        found = led.solver.solve(guess[None, :], sharp)
        if found.status[0] != _CONVERGED:
            break
        here = node_at(led.solver, led.path, s, found.v[0])
        if here.first[place] * low.first[place] > 0.0:
            low = here
        else:
            high = here
        if abs(here.first[place]) < abs(best.first[place]):
            best = here
        elif abs(step) < 1e-9:
            located = True  # to rounding
            break
    here = best
    v = led.whole(here.v)
    direction = led.whole(here.first)
    # t is quadratic in the leader here, so the leader's last step counts squared
    rounding = 4.0 * _UNIT * max(1.0, here.condition) * max(1.0, abs(float(v[p])))
    error = abs(here.second[place]) * step * step + rounding
    return TurningPoint(
        t=float(v[p]),
        bracket=(float(v[p] - error), float(v[p] + error)),
        v=v,
        direction=direction / np.abs(direction / leads.scale).max(),
        located=located,
        leg=where[0],
        after=where[1],
        node=here,
    )
