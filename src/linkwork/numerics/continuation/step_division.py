"""Steps of a curve divided so that a variable is monotonic in each piece."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.status import CONVERGED
from linkwork.numerics.continuation.branch_tracking import Node, follow, node_at
from linkwork.numerics.continuation.local_parametrization import Parametrization
from linkwork.numerics.newton import sharp

__all__ = ["divide_step", "hermite", "node_between", "one_way", "reach", "share_at", "sign_change"]

_STILL = 8.0 * EPSILON  # relative: a variable that moves less over a step rests, to rounding
_KEPT = 256  # divided steps of one leader
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


def share_at(place: int, low: Node, high: Node, value: float) -> float:
    """The fraction of a step at which the cubic through a variable has a value."""
    h = high.t - low.t
    ends = tuple(float(x[place]) for x in (low.v, low.first, high.v, high.first))
    # the cubic is monotonic in a divided step, so bisection finds the only place
    rising = ends[2] > ends[0]
    s0, s1 = 0.0, 1.0
    for _ in range(60):
        s = 0.5 * (s0 + s1)
        if (hermite(s, h, *ends) < value) == rising:
            s0 = s
        else:
            s1 = s
    return 0.5 * (s0 + s1)


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


def divide_step(led: Parametrization, place: int, a: Node, b: Node) -> list[Node]:
    """A step, divided so finely that a variable turns back at most once in each piece.

    The cubic through the variable's rates and their derivatives at both ends is compared with the
    rate halfway. The step is halved until that cubic, within its error, is zero at most once;
    reversals within the rounding of the rate are not seen.
    """
    # the search for dead points divides the steps that the search for the closing point has divided
    key = place, id(a), id(b)
    if key not in led.divided_steps:
        if len(led.divided_steps) >= _KEPT:
            led.divided_steps.clear()
        led.divided_steps[key] = _divide(led, place, a, b, _DIVISIONS)
    return led.divided_steps[key]


def _divide(led: Parametrization, place: int, a: Node, b: Node, depth: int) -> list[Node]:
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
    left = _divide(led, place, a, middle, depth - 1)
    return [*left, *_divide(led, place, middle, b, depth - 1)[1:]]


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
