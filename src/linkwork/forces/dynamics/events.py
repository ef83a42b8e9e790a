"""States of a simulated motion at times."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, KeyWords
from linkwork.core.foundation.rounding import EPSILON
from linkwork.core.results.quantities.definition import Asked, Solved
from linkwork.forces.dynamics.collocation import Step
from linkwork.forces.dynamics.joint_friction import Rubbing
from linkwork.forces.dynamics.reduced_leg import ReducedLeg


@dataclass(frozen=True, kw_only=True)
class Sample:
    """A state at a time: the leg, laps gained, place, speed and acceleration of the leader.

    ``event``: what happens there, "" for one that was asked for; ``lost``: the work of friction;
    ``stop``: the number of the bound that pushes, -1 for none, with its ``push`` or ``impulse``.
    """

    t: float
    leg: int
    lap: int
    s: float
    speed: float
    acceleration: float
    event: str = ""
    lost: float = 0.0
    stop: int = -1
    push: float = 0.0
    impulse: float = 0.0


# ----------------------------------------------------------------------
# Whether the steps of a simulation make way.


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


# ----------------------------------------------------------------------
# Events of a simulation: comparisons that switch loads, stops, the ends of legs.


_RESTS = 1e-8  # of the whole time: a shorter bounce is rest
_LOW = 1e-12  # of the leg: so is a lower one, whose margin is rounding
_NEXT = 1e-6  # of the leg: places on both sides of one, for slopes
_TOUCHES = 1e-9  # of the leg: a stop so near is touched
_LOOKS = 24  # places of a step at which signs are compared
_ROUNDS = 60  # halvings are the worst case
BEHIND = 8.0  # roundoffs of a state that is computed again
_NEAR = 1e-4  # of a bracket: around the straight line's zero, where the next one is looked for

_T = TypeVar("_T", float, Array)


@dataclass(frozen=True, kw_only=True, eq=False)
class Bound:
    """One side of a stop: ``side`` +1 for a least value, -1 for a greatest one; its key."""

    key: tuple[str | int, ...]
    asked: Asked
    value: float
    side: float
    restitution: float

    def inside(self, solved: Solved) -> Array:
        """How far the quantity is inside, (B,)."""
        found: Array = self.side * (np.atleast_1d(self.asked.values(solved, 1.0)) - self.value)
        return found

    def margin(self, leg: ReducedLeg, s: Array, speed: Array, t: Array, gain: Array) -> Array:
        """The same in states on a leg."""
        return self.inside(leg.state(s, speed, t, gain).moving.solved)

    def passed_at_start(self, margin: float, place: KeyWords) -> InputError:
        """The error of a motion that begins beyond the stop."""
        return InputError(
            f"{self.asked.name} begins at {self.value + self.side * margin:.6g}, beyond its stop "
            f"at {self.value:g}: {place(self.key)}"
        )

    def slope(self, leg: ReducedLeg, s: float, t: float, gain: Array) -> float:
        """The derivative of the margin by the leader, in radians or lengths."""
        here, one, now = np.array([s]), np.ones(1), np.array([t])
        jet = self.asked.jet(leg.state(here, one, now, gain).displaced.solved)
        return self.side * float(np.atleast_1d(jet.d1)[0])

    def _near(self, leg: ReducedLeg, s: float, t: float, gain: Array) -> tuple[float, float]:
        """The margin at a place at rest, and its slope by the length of the leg."""
        here = s + _NEXT * float(np.ptp(leg.table.edges)) * np.array([-1.0, 0.0, 1.0])
        below, found, above = self.margin(leg, here, np.zeros(3), np.full(3, t), gain).tolist()
        return found, (above - below) / (2.0 * _NEXT)

    def way(self, leg: ReducedLeg, s: float, t: float, gain: Array) -> float:
        """1 or -1: in which direction of the leader the margin grows."""
        return math.copysign(1.0, self._near(leg, s, t, gain)[1])

    def way_off(self, leg: ReducedLeg, s: float, t: float, gain: Array) -> float:
        """The same where the stop is touched, to rounding; 0 where it is not."""
        margin, slope = self._near(leg, s, t, gain)
        return math.copysign(1.0, slope) if margin <= self.rounding(slope) else 0.0

    def is_passed(self, leg: ReducedLeg, s: float, speed: float, t: float, gain: Array) -> bool:
        """Whether a motion is at the stop or behind it, and moves outwards."""
        here, pace, now = (np.array([x]) for x in (s, speed, t))
        outside = float(self.margin(leg, here, pace, now, gain)[0]) <= 0.0
        return outside and self.way(leg, s, t, gain) * speed < 0.0

    def is_beyond(self, leg: ReducedLeg, s: float, t: float, gain: Array) -> bool:
        """Whether the margin is negative by more than rounding."""
        margin, slope = self._near(leg, s, t, gain)
        return margin < -self.rounding(slope)

    def rounding(self, slope: float) -> float:
        """Up to which margin the stop is touched, by the slope of the margin."""
        return _TOUCHES * abs(slope) + 8.0 * EPSILON * abs(self.value)

    def flight(self, leg: ReducedLeg, speed: float, pull: float, until: float) -> float:
        """How long a motion that leaves the stop takes to fall back on it; 0 if it stays there.

        A much longer step would look at the margin after the next shock only.
        """
        if speed == 0.0:
            return 0.0
        found = 2.0 * abs(speed) / abs(pull) if pull * speed < 0.0 else math.inf
        low = abs(speed) * found < _LOW * float(np.ptp(leg.table.edges))
        return 0.0 if low or found < _RESTS * until else found


@dataclass(frozen=True, kw_only=True)
class Event:
    """Margin ``number`` changes its sign between two times, as near as rounding allows.

    ``falls``: whether it is one that counts only where it becomes negative.
    """

    number: int
    before: float
    after: float
    falls: bool


Margins = Callable[[Array, Array, Array], Array]


def margins_on(
    leg: ReducedLeg, bounds: Sequence[Bound], rubbing: Rubbing | None, gain: Array
) -> Margins:
    """The margins of the leg's two ends, of stops, of rest and the signs of friction, and of
    comparisons, in this order.
    """
    edges = leg.table.edges

    def margins(s: Array, speed: Array, t: Array) -> Array:
        found = [s - edges[0], edges[-1] - s]
        found += [bound.margin(leg, s, speed, t, gain) for bound in bounds]
        if rubbing is not None:
            found += [rubbing.direction * speed]
            found += [*leg.friction_margins(s, speed, t, gain, rubbing).T]
        if leg.reduction.switch_count:
            found += [*leg.margins(s, speed, t, gain).T]
        return np.stack(found, axis=1)

    return margins


def first_event(step: Step, end: float, margins: Margins, comparisons: int) -> Event | None:
    """The first sign change of margins (B, K) on a step up to the time ``end``.

    All but the last ``comparisons`` margins count only where they become negative.
    """
    times = np.linspace(step.t, end, _LOOKS + 1)
    s, speed, _ = step.at(times)
    # the polynomials meet their beginning only to rounding, which must hide no switch at rest
    s[0], speed[0] = step.s, step.speed
    values = margins(s, speed, times)
    falling = np.arange(values.shape[1]) < values.shape[1] - comparisons
    changes = (values[1:] > 0.0) != (values[:-1] > 0.0)
    changes &= ~falling | (values[:-1] > 0.0)
    if not changes.any():
        return None
    k = int(np.flatnonzero(changes.any(axis=1))[0])
    both = np.flatnonzero(changes[k])
    # several may change between the same two places: the first one counts
    found = [
        (*_located(step, margins, number, times[k : k + 2], values[k : k + 2, number]), number)
        for number in map(int, both)
    ]
    before, after, number = min(found)
    return Event(number=number, before=before, after=after, falls=bool(falling[number]))


def just_behind(place: _T, speed: _T, acceleration: _T, size: _T) -> tuple[_T, _T]:
    """Place and speed behind a switch, some roundoffs further.

    Rounding depends on how many states are computed together, and positions are solved again for
    their rows: all must find this state behind the switch. ``acceleration``: that in front of it.
    """
    further = BEHIND * EPSILON
    place = place + further * size * np.sign(speed)
    return place, speed + further * np.abs(speed) * np.sign(acceleration)


def _located(
    step: Step, margins: Margins, number: int, times: Array, values: Array
) -> tuple[float, float]:
    """Just before and just after the sign change between two times."""
    (low, high), (below, above) = times.tolist(), values.tolist()
    for _ in range(_ROUNDS):
        width = high - low
        # at t = 0 the step gives the scale
        if width <= 4.0 * np.spacing(max(abs(low), abs(high), step.h)):
            break
        guess = low + width * below / (below - above)
        # around the place on the straight line, and in the middle if that is of no use
        near = np.array([guess - _NEAR * width, guess + _NEAR * width, 0.5 * (low + high)])
        inside = np.sort(near[(near > low) & (near < high)])
        found = margins(*step.at(inside)[:2], inside)[:, number]
        all_times = np.concatenate([[low], inside, [high]])
        all_values = np.concatenate([[below], found, [above]])
        k = int(np.flatnonzero((all_values[1:] > 0.0) != (all_values[:-1] > 0.0))[0])
        low, high = all_times[k : k + 2].tolist()
        below, above = all_values[k : k + 2].tolist()
    return low, high
