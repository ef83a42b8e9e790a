"""Events of a simulation: comparisons that switch loads, stops, the ends of legs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from linkwork.dynamics.collocation import Step
from linkwork.dynamics.reduced import ReducedLeg
from linkwork.foundation.arrays import Array
from linkwork.mechanism.stop import Stop
from linkwork.results.quantities.asked import Asked

__all__ = ["Bound", "Event", "first_event"]

_LOOKS = 24  # places of a step at which signs are compared
_ROUNDS = 12  # 24^12 is beyond rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class Bound:
    """One side of a stop: ``side`` +1 for a least value, -1 for a greatest one."""

    stop: Stop
    asked: Asked
    value: float
    side: float
    restitution: float

    def margin(self, leg: ReducedLeg, s: Array, speed: Array, t: Array, gain: Array) -> Array:
        """How far the quantity is inside, (B,)."""
        solved = leg.state(s, speed, t, gain).moving.solved
        found: Array = self.side * (np.atleast_1d(self.asked.values(solved, 1.0)) - self.value)
        return found


@dataclass(frozen=True, kw_only=True)
class Event:
    """Margin ``number`` changes its sign between two times, which are as near as rounding allows."""

    number: int
    before: float
    after: float


Margins = Callable[[Array, Array, Array], Array]


def first_event(step: Step, end: float, margins: Margins, falling: Array) -> Event | None:
    """The first sign change of margins (B, K) on a step up to the time ``end``.

    ``falling`` (K,): which margins count only where they become negative.
    """
    low, high = step.t, end
    found: Event | None = None
    for _ in range(_ROUNDS):
        times = np.linspace(low, high, _LOOKS + 1)
        s, speed = step.at(times)[:2]
        values = margins(s, speed, times)
        signs = values > 0.0
        changes = signs[1:] != signs[:-1]
        changes &= ~falling | signs[:-1]
        hits = np.argwhere(changes)
        if not len(hits):
            break
        k = int(hits[:, 0].min())
        number = int(hits[hits[:, 0] == k][0, 1])
        found = Event(number=number, before=float(times[k]), after=float(times[k + 1]))
        low, high = found.before, found.after
        if high - low <= 4.0 * np.spacing(max(abs(low), abs(high))):
            break
    return found
