"""One march along one path: attempt a step, keep what succeeds, resize, until the goal."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from linkwork.marching.step_size import GROWTH, HALF, aim

__all__ = ["Attempt", "StepBounds", "Stop", "Trial", "march"]

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
