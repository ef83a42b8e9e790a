"""Whether the steps of a simulation make way."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array

__all__ = ["Chatter", "Pace"]

_STEPS = 100
_MOST_EVENTS = 60  # switches within this part of the whole time: they chatter
_CHATTER = 1e-7
_TIME, _PLACE = 1e-8, 1e-6  # of the whole time; of the place: less in so many steps is no way


class Pace:
    """The steps of a motion that lasts ``until``.

    At a pole of a load the rounding of the time shortens steps without end, long before they are
    too short.
    """

    def __init__(self, until: float) -> None:
        self.until = until
        self.count, self.time = 0, 0.0
        self.place: Array | float = np.inf

    def crawls(self, t: float, place: Array | float) -> bool:
        """Whether the last steps led almost nowhere."""
        self.count += 1
        if self.count % _STEPS:
            return False
        way = np.max(np.abs(np.subtract(place, self.place)))
        slow = way <= _PLACE * np.max(np.abs(place)) and t - self.time < _TIME * self.until
        self.time, self.place = t, place
        return bool(slow)


class Chatter:
    """Switches of a motion that lasts ``until``, of which too many in a short time chatter."""

    def __init__(self, until: float) -> None:
        self.span = _CHATTER * until
        self.recent: list[float] = []

    def starts(self, t: float) -> bool:
        """Whether the switch at ``t`` is one too many."""
        self.recent = [*(each for each in self.recent if each > t - self.span), t]
        return len(self.recent) > _MOST_EVENTS
