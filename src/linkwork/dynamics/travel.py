"""The motion along the curve of positions, step by step, from event to event."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from linkwork.dynamics.collocation import Step, shorter_step, try_step
from linkwork.dynamics.curve import PositionCurve
from linkwork.dynamics.events import Bound, Event, first_event, just_behind, margins_on
from linkwork.dynamics.joint_friction import Rubbing
from linkwork.dynamics.pace import Pace
from linkwork.dynamics.reduced_leg import ReducedLeg
from linkwork.dynamics.reduction import Reduction
from linkwork.dynamics.sample import Sample
from linkwork.dynamics.stiction import release, starting_directions
from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import FrozenDict

__all__ = ["Travel"]

_SHORTEST = 1e-14  # of the whole time: a shorter step makes no way
_FIRST = 0.02  # of the time in which the leg would be passed: the first step
_SAME_SPEED = 1e-11  # a lap that ends as fast as it began repeats itself
_MOST_EVENTS = 60  # switches within this part of the whole time: they chatter
_CHATTER = 1e-7
_MOST_TRIES = 3  # to find the signs of friction at the beginning of a step
_AT_REST = 1e-5  # of the fastest speed so far


@dataclass(eq=False)
class Travel:
    """A motion under way.

    ``times`` (B,): those asked for, rising. ``samples``: the states found so far. ``ended``: why
    the motion ended early, "" if it did not. ``held``: since when it is kept at rest, and
    ``holder`` by what. ``lost``: the work that friction has taken. ``longest``: step after a shock.
    """

    curve: PositionCurve
    reduction: Reduction
    bounds: Sequence[Bound]
    times: Array
    progress: Callable[[float], None] | None = None
    samples: list[Sample] = field(default_factory=list)
    ended: str = ""
    t: float = 0.0
    lap: int = 0
    held: float | None = None
    holder: str = ""
    lost: float = 0.0
    rubbing: Rubbing | None = None
    resting: Bound | None = None
    longest: float = math.inf

    def __post_init__(self) -> None:
        self.until = float(self.times[-1])
        self.number, self.s, self.speed = self.curve.home, self.curve.value, 0.0
        self.taken = self.tried = 0
        self.legs: dict[int, ReducedLeg] = {}
        self.steps: list[tuple[int, int, Step, float]] = []
        self.lapped: tuple[float, float, int] | None = None
        self.recent: list[float] = []

    @property
    def leg(self) -> ReducedLeg:
        """The leg that the motion is on."""
        if self.number not in self.legs:
            self.legs[self.number] = ReducedLeg(self.reduction, self.curve.legs[self.number])
        return self.legs[self.number]

    @property
    def gain(self) -> Array:
        """What the variables have gained in laps, (N,)."""
        return self.lap * self.curve.gain

    def _acceleration(self, s: Array, speed: Array, t: Array) -> Array:
        return self.leg.acceleration(s, speed, t, self.gain, self.rubbing)

    def begin(self, input_speed: float) -> None:
        """Set the speed of the input at the start, [rad/s] or [length/s]."""
        self.speed = input_speed / float(self.leg.input_slope(np.array([self.s]))[0])
        self._switch()
        if self.speed:
            self._hold()
        elif self.reduction.rubs:
            self._start()
        # at rest under friction the acceleration is none
        self._record(0.0, self.s, self.speed, 0.0 if self._is_held else self._now())
        edges = self.leg.table.edges
        way = self.speed or (0.0 if self._is_held else self._now())
        # a start at the end of a leg that moves away from it is on the leg before
        if (self.s <= edges[0] and way < 0.0) or (self.s >= edges[-1] and way > 0.0):
            self._leave(0 if way < 0.0 else 1)
        self._touch()

    def _now(self) -> float:
        here = (np.array([x]) for x in (self.s, self.speed, self.t))
        return float(self._acceleration(*here)[0])

    def run(self) -> None:
        """Step until all times are reached or the motion ends."""
        h, rougher = self._first_step(), math.inf
        pace = Pace(self.until)
        while self.t < self.until and not self.ended:
            if self._rests() or self._sticks() or self._is_outside():
                continue
            if pace.crawls(self.t, self.s):
                self.ended = self._unbounded()
                continue
            short = self.until - self.t
            step, following, rough = try_step(
                self._acceleration, self.t, self.s, self.speed, min(h, short), rougher
            )
            shorter = None if step is None else shorter_step(step, *self.leg.reach)
            if shorter is not None:
                step, following = None, shorter
            if step is not None and self._misjudges(step):
                continue
            if step is None:
                h, rougher = following, rough
                if h < _SHORTEST * self.until:
                    self.ended = self._unbounded()
                continue
            rougher = rough if following <= step.h else math.inf
            event = self._event(step)
            end = step.t + step.h if event is None else self._end(event)
            self._take(step, end)
            h = following if event is None and step.h < short else max(following, h)
            if event is not None:
                self._meet(event)
                rougher = math.inf
                if event.number >= 2:  # the accelerations have jumped
                    h = min(h, self._first_step(), self.longest)
            if self.progress is not None:
                self.progress(min(1.0, self.t / self.until))

    def _first_step(self) -> float:
        low, high = sorted((self.leg.leg.begin, self.leg.leg.end))
        pace, pull = abs(self.speed), abs(self._now())
        times = [self.until]
        if pace > 0.0:
            times.append((high - low) / pace)
        if math.isfinite(pull) and pull > 0.0:
            times.append(math.sqrt((high - low) / pull))
        return max(_FIRST * min(times), 10.0 * _SHORTEST * self.until)

    def _event(self, step: Step) -> Event | None:
        margins = margins_on(self.leg, self.bounds, self.rubbing, self.gain)
        return first_event(step, step.t + step.h, margins, len(self.reduction.comparisons))

    def _end(self, event: Event) -> float:
        """Stops are met just before, all others just after."""
        return event.before if 2 <= event.number < 2 + len(self.bounds) else event.after

    def _take(self, step: Step, end: float) -> None:
        times = self.times[self.taken :]
        times = times[(times > step.t) & (times <= end)]
        lost = self._losses(step, np.append(times, end))
        if len(times):
            for t, s, speed, bend, more in zip(times, *step.at(times), lost, strict=False):
                here = float(t), float(s), float(speed), float(bend)
                self._record(*here, lost=self.lost + float(more))
            self.taken += len(times)
        self.lost += float(lost[-1])
        self.steps.append((self.number, self.lap, step, end))
        place, pace, _ = step.at(np.array([end]))
        self.t, self.s, self.speed = end, float(place[0]), float(pace[0])

    def _losses(self, step: Step, times: Array) -> Array:
        """The work of friction from the beginning of a step up to times (B,)."""
        if self.rubbing is None:
            return np.zeros(len(times))
        s, speed, _ = step.at(step.nodes)
        power = self.leg.friction_power(s, speed, step.nodes, self.gain, self.rubbing)
        return step.integral(power, times)

    def _record(
        self, t: float, s: float, speed: float, acceleration: float, event: str = "",
        lost: float | None = None,
    ) -> None:  # fmt: skip
        self.samples.append(
            Sample(
                t=t, leg=self.number, lap=self.lap, s=s, speed=speed, acceleration=acceleration,
                event=event, lost=self.lost if lost is None else lost,
            )
        )  # fmt: skip

    def _meet(self, event: Event) -> None:
        bounds = 2 + len(self.bounds)
        if event.number < 2:
            self._leave(event.number)
        elif event.number < bounds:
            self._hit(self.bounds[event.number - 2])
        elif self.rubbing is not None and event.number == bounds:
            self._come_to_rest()
        elif event.falls:
            self._hold()
        else:
            # the row has the loads, and so the acceleration, after the switch
            size = abs(self.s) + float(np.ptp(self.leg.table.edges))
            self.s, self.speed = just_behind(self.s, self.speed, self._now(), size)
            self._switch()
            self._hold()
            self._record(self.t, self.s, self.speed, self._now(), "switch")
            self._check_chatter()
            for bound in self.bounds:
                if bound.is_passed(self.leg, self.s, self.speed, self.t, self.gain):
                    self._hit(bound)

    def _switch(self) -> None:
        """Let every comparison have the value that it has now."""
        if not self.reduction.comparisons:
            return
        s, speed, t = (np.array([x]) for x in (self.s, self.speed, self.t))
        self.reduction.switches = FrozenDict()
        self.reduction.switch(self.leg.margins(s, speed, t, self.gain)[0].tolist())

    def _check_chatter(self) -> None:
        self.recent = [t for t in self.recent if t > self.t - _CHATTER * self.until] + [self.t]
        if len(self.recent) <= _MOST_EVENTS:
            return
        self.ended = "a comparison in a load switches without end there"
        fastest = max(abs(sample.speed) for sample in self.samples)
        slow = max(_AT_REST * fastest, abs(self._now()) * _CHATTER * self.until)
        if "t" not in self.reduction.names and abs(self.speed) < slow:
            # pushed back either way, also at a speed that the loads give in that time: it stays
            self.ended, self.held = "", self.recent[0] * (self.recent[0] > _SHORTEST * self.until)
            self.holder = "a load that switches there"
            chatter = [k for k in self.samples if k.event == "switch" and k.t > self.held]
            self.samples = [k for k in self.samples if k not in chatter]
            self._stay(self.until)

    def _stay(self, until: float) -> None:
        """Remain at rest up to a time."""
        times = self.times[self.taken :]
        for t in times[times <= until]:
            self._record(float(t), self.s, 0.0, 0.0)
            self.taken += 1
        self.t = until

    def _is_outside(self) -> bool:
        """Whether the leg ended at another event, to rounding; the motion is then on the next."""
        low, high = self.leg.table.edges[[0, -1]]
        out = bool((self.s <= low and self.speed < 0) or (self.s >= high and self.speed > 0))
        if out:
            self._leave(0 if self.speed < 0.0 else 1)
        return out

    def _leave(self, side: int) -> None:
        """Onto the next leg, where another variable may lead."""
        leg = self.leg.leg
        ahead = (leg.begin <= leg.end) == (side == 1)
        self._note_lap(ahead)
        number, count = self.number + (1 if ahead else -1), len(self.curve.legs)
        if not 0 <= number < count:
            if not self.curve.closed:
                self.ended = self.curve.ends[1 if ahead else 0]
                return
            self.lap += 1 if ahead else -1
            number %= count
        old = leg.lead
        self.number = number
        new = self.leg.leg
        self.s = new.begin if ahead else new.end
        if old != new.lead:
            self.speed /= float(self.leg.slopes(np.array([self.s]))[0, old])
        self._hold()

    def _note_lap(self, ahead: bool) -> None:
        """Finish at once if a lap has ended as it began and all further ones are the same."""
        last = len(self.curve.legs) - 1 if ahead else 0
        repeats = self.curve.closed and self.reduction.of_position and not self.bounds
        repeats = repeats and not self.reduction.rubs
        if not repeats or self.number != last:
            return
        known = self.lapped
        self.lapped = (self.t, self.speed, len(self.steps))
        if known is None or abs(self.speed - known[1]) > _SAME_SPEED * abs(self.speed):
            return
        period, lap_steps = self.t - known[0], self.steps[known[2] :]
        times = self.times[self.taken :]
        for t in times:
            laps = math.floor((t - known[0]) / period)
            own = t - laps * period
            number, lap, step, _ = next(
                (each for each in lap_steps if own <= each[3]), lap_steps[-1]
            )
            s, speed, a = (float(x[0]) for x in step.at(np.array([own])))
            self.number = number
            turned, self.lap = self.lap, lap + (laps if ahead else -laps)
            self._record(float(t), s, speed, a)
            self.lap = turned
        self.taken, self.t = len(self.times), self.until
        self.number = last

    def _hit(self, bound: Bound) -> None:
        self._record(self.t, self.s, self.speed, self._now(), f"stop of {bound.asked.name}")
        self.speed *= -bound.restitution
        self._hold()
        flight = bound.flight(self.leg, self.speed, self._now(), self.until)
        self.longest = 2.0 * flight
        if flight == 0.0:
            self.speed, self.rubbing, self.resting = 0.0, None, bound

    def _touch(self) -> None:
        """Hit a stop that is touched at the start, or stay at it."""
        for bound in self.bounds:
            away = bound.way_off(self.leg, self.s, self.t, self.gain)
            if away * self.speed < 0.0:
                self._hit(bound)
            elif away and not self.speed and (self._is_held or away * self._now() <= 0.0):
                self.resting = bound

    def _rests(self) -> bool:
        """Stay at a stop as long as the loads push there; whether time has passed."""
        if self.resting is None:
            return False
        away = self.resting.way(self.leg, self.s, self.t, self.gain)
        looks = np.linspace(self.t, self.until, 400)
        if self.leg.friction is not None:
            pull = away * (starting_directions(self.leg, self.s, looks, self.gain) == away)
        else:
            ones = np.ones_like(looks)
            pull = self._acceleration(self.s * ones, 0.0 * ones, looks)
        leaves = np.flatnonzero(away * pull > 0.0)
        until = self.until if not len(leaves) else float(looks[leaves[0]])
        self.resting = None
        if until <= self.t:
            return False
        self._stay(until)
        self._switch()
        return True

    @property
    def _is_held(self) -> bool:
        """Whether the machine is at rest and no direction is chosen."""
        return self.reduction.rubs and self.rubbing is None

    def _hold(self) -> None:
        """Take the signs of friction from the state, for the steps that follow."""
        if not self.reduction.rubs or not self.speed:
            return
        direction = math.copysign(1.0, self.speed)
        self.rubbing = self.leg.hold(self.s, self.speed, self.t, self.gain, direction)

    def _start(self) -> bool:
        """Choose the direction in which the loads overcome friction at rest, if they do."""
        here = np.array([self.t])
        direction = float(starting_directions(self.leg, self.s, here, self.gain)[0])
        if direction:
            self.rubbing = self.leg.hold(self.s, 0.0, self.t, self.gain, direction)
        return direction != 0.0

    def _come_to_rest(self) -> None:
        self.speed, self.rubbing = 0.0, None
        if not self._start():
            self._record(self.t, self.s, 0.0, 0.0, "rest")

    def _sticks(self) -> bool:
        """Stay at rest as long as friction holds the machine; whether time has passed."""
        if not self._is_held or self._start():
            return False
        # comparisons follow the time meanwhile
        self.reduction.switches = FrozenDict()
        starts = release(self.leg, self.s, self.t, self.until, self.gain)
        begin, end = self.t, self.until if starts is None else starts
        self._stay(end)
        self._switch()
        if starts is None:
            self.held, self.holder = begin, "friction"
        elif self._start():
            self._record(self.t, self.s, 0.0, self._now(), "start")
        return True

    def _misjudges(self, step: Step) -> bool:
        """Whether friction has another sign as soon as a step begins; it is taken from there."""
        if self.rubbing is None or self.rubbing.sides is None or self.tried > _MOST_TRIES:
            self.tried = 0
            return False
        times = step.t + np.array([0.0, 0.02]) * step.h
        s, speed, _ = step.at(times)
        margins = self.leg.friction_margins(s, speed, times, self.gain, self.rubbing)
        if not ((margins[0] <= 0.0) & (margins[1] < 0.0)).any():
            self.tried = 0
            return False
        self.tried += 1
        place, pace, time = float(s[1]), float(speed[1]), float(times[1])
        self.rubbing = self.leg.hold(place, pace, time, self.gain, self.rubbing.direction)
        return True

    def _unbounded(self) -> str:
        """Why no step succeeds."""
        if self.rubbing is not None and not math.isfinite(self._now()):
            return "friction locks the mechanism there: no acceleration is in equilibrium with it"
        found = self.leg.failing_load(self.s, self.speed, self.t, self.gain, self.until)
        return found or "the accelerations have no bound there"
