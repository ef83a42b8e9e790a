"""The steps of path following: functions that choose, predict, attempt and resize a step."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from linkwork.core.foundation.arrays import Array

# ----------------------------------------------------------------------
# Predictions of a march: the polynomial through the last nodes and their derivatives.


SAME = 1e-9  # relative: steps so nearly equal share the weights of their prediction
FAR = 2.5  # times the step before: beyond this distance fewer nodes are trusted


def trusted_nodes(t: float, times: Array, known: int) -> int:
    """The number of the ``known`` last nodes, at ``times`` (K,), that predict well at t."""
    step, used = abs(t - times[0]), min(known, len(times))
    for k in range(len(times) - 1, 0, -1):
        # a polynomial far outside its nodes is worse than one through fewer of them
        if used > k and step > FAR * abs(times[k - 1] - times[k]):
            used = k
    return used


def hermite_weights(t: float, times: Array, i: int, count: int) -> tuple[float, float]:
    """Weights at t of the i-th of ``count`` nodes' value and derivative in Hermite's polynomial.

    With the Lagrange basis L_i these are (1 - 2 (t - t_i) L_i'(t_i)) L_i² and (t - t_i) L_i².
    """
    basis, slope = 1.0, 0.0
    for j in range(len(times)):
        if j < count and j != i:
            basis *= (t - times[j]) / (times[i] - times[j])
            slope += 1.0 / (times[i] - times[j])
    square = basis * basis  # eq. (18)
    return (1.0 - 2.0 * slope * (t - times[i])) * square, (t - times[i]) * square


def is_same_spacing(step: float, times: Array, spacing: Array) -> bool:
    """Whether the step and the distances between nodes at ``times`` (K,) equal ``spacing`` (K,)."""
    near = SAME * abs(step)
    # "not <=" instead of ">": a spacing of NaN or infinity equals no other one
    other = int(not abs(step - spacing[0]) <= near)
    for k in range(1, len(times)):
        other += not abs(times[k - 1] - times[k] - spacing[k]) <= near
    return other == 0


def keep_spacing(step: float, times: Array, spacing: Array) -> None:
    """Store in ``spacing`` (K,) the step and the distances between nodes at ``times`` (K,)."""
    spacing[0] = step
    for k in range(1, len(times)):
        spacing[k] = times[k - 1] - times[k]


# ----------------------------------------------------------------------
# The size of the next step of a march: towards a goal, after a success, after a failure.


GROWTH = 2.0  # largest factor from one step to the next
HALF = 0.5  # the next attempt after a step that failed, as a part of it
# A step often ends early, at a row of the table, and then tests only a part of its bound. The bound
# grows where that part is half or more: it is then at most 4 (GROWTH / 0.5) times a step that
# succeeded, while rows just short of the bound do not keep it from growing.
NEARLY_FULL = 0.5


def aim(goal: float, here: float, h: float) -> float:
    """The end of a step of at most ``h`` from ``here`` towards ``goal``."""
    away = goal - here
    # the goal itself: here + away may be off by a rounding
    return goal if abs(away) <= h else here + math.copysign(h, away)


def stride(goal: float, here: float, h: float) -> float:
    """The length of the step to :func:`aim`, with its sign."""
    away = goal - here
    return away if abs(away) <= h else math.copysign(h, away)


def is_lost(t: float, here: float, goal: float) -> bool:
    """Whether a step is lost to rounding: it ends where it began, before the goal."""
    return t == here and t != goal


def grow(h: float, moved: float, largest: float) -> float:
    """The bound of the next step after a successful step of length ``moved``."""
    return min(GROWTH * h, largest) if moved >= NEARLY_FULL * h else h


def by_error(error: float, target: float, order: int) -> float:
    """The factor that brings a prediction's error, which grows like h^order, to ``target``."""
    return float((target / error) ** (1.0 / order)) if error > 0.0 else GROWTH  # eq. (22)


# ----------------------------------------------------------------------
# One march along one path: attempt a step, keep what succeeds, resize, until the goal.


_LEAST = 0.1  # smallest factor from one attempt to the next


class _AtParameter(Protocol):
    @property
    def t(self) -> float: ...


N = TypeVar("N", bound=_AtParameter)


@dataclass(frozen=True)
class Attempt(Generic[N]):
    """One attempted step: the node reached, ``None`` if it is refused, and the factor by which the
    next step should be larger or smaller, ``None`` if unknown, 0 if no smaller one is possible.
    """

    node: N | None
    factor: float | None = None


class Trial(Protocol[N]):
    """Corrects and judges the steps of a march: the equations, in NumPy or compiled."""

    def attempt(self, here: N, t: float) -> Attempt[N]:
        """A step from a node to the parameter t."""

    def room(self, here: N, sign: float) -> float:
        """The largest step allowed from a node, in the direction of ``sign``."""


@dataclass(frozen=True, kw_only=True)
class StepBounds:
    """Steps of a march in units of ``size``, the path's natural length.

    ``smallest`` also counts relative to t; ``attempts``: how many are made at most.
    """

    size: float
    first: float
    largest: float
    smallest: float
    attempts: int


@dataclass(frozen=True)
class Stop(Generic[N]):
    """The end of a march before its goal: the last node, and the parameter that was not reached.

    ``exhausted``: all attempts were used.
    """

    node: N
    failed: float
    exhausted: bool = False


def march(
    trial: Trial[N],
    start: N,
    goal: float,
    bounds: StepBounds,
    watch: Callable[[N, N], bool] | None = None,
) -> tuple[list[N], Stop[N] | None]:
    """March from a node to ``t = goal``, or until ``watch``, called with both ends of every step,
    returns true.

    Returns
    -------
    nodes, stop
        The nodes after the start in the order reached; ``None`` if the march was not cut short.
    """
    nodes: list[N] = []
    here, h, failed = start, bounds.first * bounds.size, goal
    sign = math.copysign(1.0, goal - start.t)
    for _ in range(bounds.attempts):
        rest = abs(goal - here.t)
        room = trial.room(here, sign)
        smallest = bounds.smallest * max(bounds.size, abs(here.t))
        if room < smallest:
            return nodes, Stop(here, here.t + sign * 2.0 * room)
        h = min(h, bounds.largest * bounds.size, rest, room)
        # the last step to the goal may be of any length
        if h < rest and h < smallest:
            return nodes, Stop(here, failed)
        t = aim(goal, here.t, h)
        found = trial.attempt(here, t)
        if found.node is None:
            failed = t
            if found.factor == 0.0:
                return nodes, Stop(here, t)
            h *= HALF if found.factor is None else max(_LEAST, min(HALF, found.factor))  # eq. (22)
            if h < smallest:
                return nodes, Stop(here, t)
            continue
        before, here = here, found.node
        nodes.append(here)
        h *= min(GROWTH, max(HALF, found.factor or GROWTH))  # eq. (22)
        enough = watch is not None and watch(before, here)
        if enough or here.t == goal:
            return nodes, None
    return nodes, Stop(here, goal, exhausted=True)
