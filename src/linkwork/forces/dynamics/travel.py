"""Rest, and passage along the curve of positions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import EPSILON, Array, BoolArray
from linkwork.forces.dynamics.collocation import Step, shorter_step, try_step
from linkwork.forces.dynamics.curve import PositionCurve
from linkwork.forces.dynamics.events import (
    BEHIND,
    Bound,
    Chatter,
    Event,
    Pace,
    Sample,
    first_event,
    just_behind,
    margins_on,
)
from linkwork.forces.dynamics.joint_friction import Rubbing
from linkwork.forces.dynamics.reduced_leg import ReducedLeg
from linkwork.forces.dynamics.reduction import Reduction

# ----------------------------------------------------------------------
# Rest: which way the loads start a machine that friction, a stop or a load holds, and when.


_PIECES, _NODES, _LOOKS = 64, 17, 33  # pieces of the time at first, and places on each
_DEEPEST = 12  # halvings of a piece
_RESOLVED = 1e-4  # of the largest value: last coefficients of a polynomial through the places
_HALVINGS = 60
_ROUNDING = 1e-14  # of the larger acceleration
_MARGIN = 4.0  # of the change of an acceleration within rounding of the place
_SLOW = 1e-20  # of the leg in a second: a speed that has a direction only; also of accelerations


def excesses(leg: ReducedLeg, s: float, times: Array, gain: Array, ways: Sequence[float]) -> Array:
    """The acceleration along each of the ways ±1 with which a machine at rest would start, (B, W);
    not positive where it stays.

    It starts in a direction if friction against this motion, and loads that switch with it, leave
    an acceleration along it. That is where the effort of the input lies beyond those that hold it:
    see ``crank.effort.backward``. All switches must follow the state.
    """
    found = {}
    for way in (1.0, -1.0):
        rubbing = None
        if leg.friction is not None:
            rubbing = Rubbing(direction=way, ways=leg.friction.ways(s, way))
        near, pace = just_ahead(leg, s, way)
        speed = np.full_like(times, pace)
        # an equilibrium between two floating-point numbers pulls away on both sides
        pull, further = (
            way * leg.acceleration(np.full_like(times, place), speed, times, gain, rubbing)
            for place in (near, 2.0 * near - s)
        )
        with np.errstate(invalid="ignore"):
            pull = pull - _MARGIN * np.nan_to_num(np.maximum(further - pull, 0.0), posinf=0.0)
        # friction locks, but a load without a value ends the rest
        found[way] = np.where(np.isfinite(pull), pull, 0.0 if rubbing else np.inf)
    size = np.maximum(np.abs(found[1.0]), np.abs(found[-1.0]))
    least = _SLOW * float(np.ptp(leg.table.edges))
    rounding = np.where(np.isfinite(size), _ROUNDING * size + least, 0.0)
    return np.stack([found[way] - rounding for way in ways], axis=1)


def just_ahead(leg: ReducedLeg, s: float, way: float) -> tuple[float, float]:
    """Place and speed of a motion that begins at ``s``."""
    size = float(np.ptp(leg.table.edges))
    return s + way * BEHIND * EPSILON * (abs(s) + size), way * _SLOW * size


def first_start(
    leg: ReducedLeg, s: float, t: float, until: float, gain: Array, ways: Sequence[float]
) -> tuple[float, float]:
    """When a machine at rest starts to move in one of the ways, and in which; ``until`` and 0 if
    it does not. Located to rounding.
    """

    def pull(times: Array) -> Array:
        found: Array = excesses(leg, s, times, gain, ways)
        return found

    if not ways:
        return until, 0.0
    # friction that locks one way leaves the other; both at once is for the larger
    now = pull(np.array([t]))[0]
    if now.max() > 0.0:
        return t, float(ways[int(np.argmax(now))])
    if until <= t or "t" not in leg.reduction.names:
        return until, 0.0
    edges = np.linspace(t, until, _PIECES + 1)
    # a pulse between two comparisons may be short
    edges = np.union1d(edges, [*_switch_times(leg, s, edges, gain)])
    for low, high in pairwise(edges.tolist()):
        start = _first_positive(lambda x: pull(x).max(axis=1), low, high, _DEEPEST)
        if start is not None:
            return start, float(ways[int(np.argmax(pull(np.array([start]))[0]))])
    return until, 0.0


def _switch_times(leg: ReducedLeg, s: float, edges: Array, gain: Array) -> Iterator[float]:
    """Just after comparisons change their values during a rest."""
    if not leg.reduction.switch_count:
        return

    def positive(times: Array) -> BoolArray:
        found: BoolArray = leg.margins(np.full_like(times, s), 0.0 * times, times, gain) > 0.0
        return found

    values = positive(edges)
    for k, number in np.argwhere(values[1:] != values[:-1]).tolist():
        low, high = edges[k : k + 2].tolist()
        while high - low > 2.0 * math.ulp(
            max(high, edges[1])
        ):  # at t = 0 the first piece is the scale
            middle = 0.5 * (low + high)
            same = positive(np.array([middle]))[0, number] == values[k, number]
            low, high = (middle, high) if same else (low, middle)
        yield high


def _first_positive(
    function: Callable[[Array], Array], low: float, high: float, depth: int
) -> float | None:
    """Just after a function becomes positive between two times; ``None`` if it does not."""
    x = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    values = function(0.5 * (low + high) + 0.5 * (high - low) * x)
    last = np.abs(np.polynomial.chebyshev.chebfit(x, values, _NODES - 1)[-2:]).max()
    if last > _RESOLVED * np.abs(values).max() and depth > 0:
        middle = 0.5 * (low + high)
        first = _first_positive(function, low, middle, depth - 1)
        return first if first is not None else _first_positive(function, middle, high, depth - 1)
    times = np.linspace(low, high, _LOOKS)
    positive = np.flatnonzero(function(times) > 0.0)
    if not len(positive):
        return None
    if positive[0] == 0:
        return low
    low, high = times[positive[0] - 1 : positive[0] + 1].tolist()
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if high - low <= 2.0 * math.ulp(high):
            break
        low, high = (low, middle) if function(np.array([middle]))[0] > 0.0 else (middle, high)
    return high


# ----------------------------------------------------------------------
# A motion under way along the curve of positions: its state, and what is known of it.


_WAYS = (1.0, -1.0)
_SAME_SPEED = 1e-11  # a lap that ends as fast as it began repeats itself


@dataclass(eq=False)
class Passage:
    """A motion under way.

    ``times`` (B,): those asked for, rising. ``samples``: the states found so far. ``ended``: why
    the motion ended early, "" if it did not. ``still``: whether it is at rest, and ``touching``
    which stops, by the way that each blocks. ``held``: since when it is kept there at the end, and
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
    still: bool = False
    touching: dict[float, int] = field(default_factory=dict)
    longest: float = math.inf

    def __post_init__(self) -> None:
        self.until = float(self.times[-1])
        self.number, self.s, self.speed = self.curve.home, self.curve.value, 0.0
        self.taken = self.tried = 0
        self.legs: dict[int, ReducedLeg] = {}
        self.steps: list[tuple[int, int, Step, float]] = []
        self.lapped: tuple[float, float, int] | None = None
        self.chatter = Chatter(self.until)

    @property
    def leg(self) -> ReducedLeg:
        """The leg that the motion is on."""
        if self.number not in self.legs:
            self.legs[self.number] = ReducedLeg(
                self.reduction, self.curve.legs[self.number], self.curve.gain
            )
        return self.legs[self.number]

    @property
    def gain(self) -> Array:
        """What the variables have gained in laps, (N,)."""
        return self.lap * self.curve.gain

    def _acceleration(self, s: Array, speed: Array, t: Array) -> Array:
        return self.leg.acceleration(s, speed, t, self.gain, self.rubbing)

    def _now(self) -> float:
        here = (np.array([x]) for x in (self.s, self.speed, self.t))
        return float(self._acceleration(*here)[0])

    @property
    def _free(self) -> list[float]:
        """The ways that no stop blocks."""
        return [way for way in _WAYS if way not in self.touching]

    def _pushes(self, times: Array) -> list[tuple[int, float]]:
        """The number of the stop that pushes and its push at times (B,) at rest; -1 for none, NaN
        with friction, which leaves it open.
        """
        if not self.touching:
            return [(-1, 0.0)] * len(times)
        here, still, leg = np.full_like(times, self.s), np.zeros_like(times), self.leg
        force = leg.acceleration(here, still, times, self.gain) * leg.numbers(here)[:, 0]
        found = []
        for one in force.tolist():
            number, push = self.touching.get(math.copysign(1.0, one), -1), 0.0
            if number >= 0:
                slope = self.bounds[number].slope(leg, self.s, 0.0, self.gain)
                push = math.nan if self.reduction.rubs else -one / slope
            found.append((number, push))
        return found

    def _holding(self) -> str:
        """What holds a machine that stays at rest; "" if nothing has to."""
        pulls = excesses(self.leg, self.s, np.array([self.t]), self.gain, _WAYS)[0]
        for way, pull in zip(_WAYS, pulls, strict=True):
            if pull > 0.0 and way in self.touching:
                return f"the stop of {self.bounds[self.touching[way]].asked.name}"
        if self.reduction.rubs:
            return "friction"
        return "a load that switches there" if self.reduction.switch_count else ""

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
        self, t: float, s: float, speed: float, acceleration: float, event: str = "", **more: Any
    ) -> None:
        self.samples.append(
            Sample(
                t=t, leg=self.number, lap=self.lap, s=s, speed=speed, acceleration=acceleration,
                event=event, **{"lost": self.lost, **more},
            )
        )  # fmt: skip

    def record_end(self) -> None:
        """Add the state in which the motion has ended early."""
        self._record(self.t, self.s, self.speed, math.nan, "end")

    def _note_lap(self, ahead: bool) -> None:
        """Finish at once if a lap has ended as it began and all further ones are the same."""
        last = len(self.curve.legs) - 1 if ahead else 0
        repeats = self.curve.closed and self.reduction.of_position and not self.bounds
        repeats = repeats and not self.reduction.rubs
        repeats = repeats and all(leg.repeats for leg in self.legs.values())
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

    @property
    def fastest(self) -> float:
        """The fastest speed so far."""
        return max(abs(sample.speed) for sample in self.samples)


# ----------------------------------------------------------------------
# The motion along the curve of positions, step by step, from event to event.


_SHORTEST = 1e-14  # of the whole time: a shorter step makes no way
_FIRST = 0.02  # of the time in which the leg would be passed: the first step
_MOST_TRIES = 3  # to find the signs of friction at the beginning of a step
_AT_REST = 1e-5  # of the fastest speed so far
_ZERO = 1e-13  # of the fastest speed: none


@dataclass(eq=False)
class Travel(Passage):
    """A motion under way, from event to event."""

    def begin(self, input_speed: float) -> None:
        """Set the speed of the input at the start, [rad/s] or [length/s]."""
        self.speed = input_speed / float(self.leg.input_slope(np.array([self.s]))[0])
        self._switch()
        self._touch()
        if self.speed:
            self._hold()
            way = self.speed
        else:
            self.still, way = True, self._starting()
        ((stop, push),) = self._pushes(np.zeros(1))
        if way:
            self._record(0.0, self.s, self.speed, self._now())
        else:
            self._record(0.0, self.s, 0.0, 0.0, stop=stop, push=push)
        edges = self.leg.table.edges
        # a start at the end of a leg that moves away from it is on the leg before
        if (self.s <= edges[0] and way < 0.0) or (self.s >= edges[-1] and way > 0.0):
            self._leave(0 if way < 0.0 else 1)
            self._touch()
        for number in list(self.touching.values()):
            if self.speed:
                self._hit(number)

    def run(self) -> None:
        """Step until all times are reached or the motion ends."""
        h, rougher = self._first_step(), math.inf
        pace = Pace(self.until)
        while self.t < self.until and not self.ended:
            if (self.still and self._rest()) or self._is_outside():
                continue
            if pace.crawls(self.t, self.s):
                self.ended = self._unbounded()
                continue
            short = self.until - self.t
            step, following, rough = try_step(
                self._acceleration, self.t, self.s, self.speed, min(h, short), rougher=rougher
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
            margins = margins_on(self.leg, self.bounds, self.rubbing, self.gain)
            event = first_event(step, step.t + step.h, margins, self.reduction.switch_count)
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

    def _end(self, event: Event) -> float:
        """Stops are met just before, all others just after."""
        return event.before if 2 <= event.number < 2 + len(self.bounds) else event.after

    def _meet(self, event: Event) -> None:
        bounds = 2 + len(self.bounds)
        if event.number < 2:
            self._cross(event.number)
        elif event.number < bounds:
            self._hit(event.number - 2)
        elif self.rubbing is not None and event.number == bounds:
            self._come_to_rest("rest")
        elif event.falls:
            self._hold()
        else:
            self._switch_behind(self._now())
            self._go_on_switched()

    def _switch_behind(self, pull: float) -> None:
        """Let switches have their values just behind; ``pull``: the acceleration in front."""
        size = abs(self.s) + float(np.ptp(self.leg.table.edges))
        self.s, self.speed = just_behind(self.s, self.speed, pull, size)
        self._switch()

    def _go_on_switched(self) -> None:
        # the row has the loads, and so the acceleration, after the switch
        if abs(self.speed) <= _ZERO * self.fastest and not self.reduction.rubs:
            self._come_to_rest("switch")
            return
        self._hold()
        self._record(self.t, self.s, self.speed, self._now(), "switch")
        self._check_chatter()
        self._hit_passed()

    def _hit_passed(self) -> None:
        for number, bound in enumerate(self.bounds):
            if bound.is_passed(self.leg, self.s, self.speed, self.t, self.gain):
                self._hit(number)

    def _cross(self, side: int) -> None:
        """Onto the next leg; switches and stops may lie at the edge between the two."""
        pull, held = self._now(), self.reduction.held
        self._leave(side)
        if self.ended:
            return
        state = self.s, self.speed
        self._switch_behind(pull)
        if self.reduction.held != held:
            self._go_on_switched()
            return
        self.s, self.speed = state
        self._hold()
        self._hit_passed()

    def _switch(self, way: float = 0.0) -> None:
        """Let every switch have the value that it has now, or as a motion that way begins."""
        if not self.reduction.switch_count:
            return
        place, pace = just_ahead(self.leg, self.s, way) if way else (self.s, self.speed)
        s, speed, t = (np.array([x]) for x in (place, pace, self.t))
        self.reduction.release()
        self.reduction.switch(self.leg.margins(s, speed, t, self.gain)[0].tolist())

    def _check_chatter(self) -> None:
        if not self.chatter.starts(self.t):
            return
        self.ended = "a comparison in a load switches without end there"
        slow = max(_AT_REST * self.fastest, abs(self._now()) * self.chatter.span)
        if "t" not in self.reduction.names and abs(self.speed) < slow:
            # pushed back either way, also at a speed that the loads give in that time: it stays
            begin = self.chatter.recent[0]
            self.ended, self.speed, self.holder = "", 0.0, "a load that switches there"
            self.held = begin * (begin > _SHORTEST * self.until)
            gone = [k for k in self.samples if k.event == "switch" and k.t > self.held]
            self.samples = [k for k in self.samples if k not in gone]
            self._stay(self.until)

    def _stay(self, until: float) -> None:
        """Remain at rest up to a time."""
        times = self.times[self.taken :]
        times = times[times <= until]
        for t, (stop, push) in zip(times.tolist(), self._pushes(times), strict=True):
            self._record(t, self.s, 0.0, 0.0, stop=stop, push=push)
        self.taken += len(times)
        self.t = until

    def _is_outside(self) -> bool:
        """Whether the leg ended at another event, to rounding; the motion is then on the next."""
        low, high = self.leg.table.edges[[0, -1]]
        out = bool((self.s <= low and self.speed < 0) or (self.s >= high and self.speed > 0))
        if out:
            self._cross(0 if self.speed < 0.0 else 1)
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
        old, edge = leg.lead, self.leg.table.edges[side * -1]
        places = self.leg.table(np.array([edge, self.s]))
        self.number = number
        new = self.leg.leg
        # a short way beyond the end may have been missed: it belongs to the next leg
        beyond = float(places[1, new.lead] - places[0, new.lead])
        self.s = (new.begin if ahead else new.end) + beyond
        if old != new.lead:
            self.speed /= float(self.leg.slopes(np.array([self.s]))[0, old])
        self._switch()  # margins of springs are those of the leg
        self._hold()

    def _hit(self, number: int) -> None:
        bound, before, pull = self.bounds[number], self.speed, self._now()
        here = self.s, self.t, self.gain
        if bound.way(self.leg, *here) * before >= 0.0:
            return
        self.speed *= -bound.restitution
        self._switch()  # of the speed, which has jumped
        self._hold()
        flight = bound.flight(self.leg, self.speed, self._now(), self.until)
        self.longest = 2.0 * flight or math.inf
        self.touching = {}
        if flight == 0.0:
            self.speed, self.rubbing, self.still = 0.0, None, True
            self.touching = {math.copysign(1.0, before): number}
        mass = float(self.leg.numbers(np.array([self.s]))[0, 0])
        impulse = mass * (self.speed - before) / bound.slope(self.leg, *here)
        self._record(
            self.t, self.s, before, pull, f"stop of {bound.asked.name}", stop=number,
            impulse=impulse,
        )  # fmt: skip

    def _touch(self) -> None:
        """Note the stops that are touched at the start, by the way that each blocks."""
        self.touching = {}
        for number, bound in enumerate(self.bounds):
            away = bound.way_off(self.leg, self.s, self.t, self.gain)
            if away and away * self.speed <= 0.0:
                self.touching[-away] = number

    def _starting(self) -> float:
        """The way in which a machine at rest starts now, 0.0 if it does not; its switches and the
        signs of friction are those of this motion.
        """
        self.reduction.release()
        _, way = first_start(self.leg, self.s, self.t, self.t, self.gain, self._free)
        self._set_off(way)
        return way

    def _set_off(self, way: float) -> None:
        self._switch(way)
        if way and self.reduction.rubs:
            self.rubbing = self.leg.hold(self.s, 0.0, self.t, self.gain, way)

    def _come_to_rest(self, event: str) -> None:
        """Stop where friction or a load that switches may hold the machine."""
        speed, self.speed, self.rubbing, self.still = self.speed, 0.0, None, True
        way = self._starting()
        if not way:
            self._record(self.t, self.s, 0.0, 0.0, "rest")
        elif event == "switch":
            self.still, self.speed = False, math.copysign(speed, way)
            self._record(self.t, self.s, self.speed, self._now(), event)

    def _rest(self) -> bool:
        """Stay at rest as long as nothing starts the machine; whether time has passed."""
        self.reduction.release()
        begin = self.t
        start, way = first_start(self.leg, self.s, begin, self.until, self.gain, self._free)
        self._stay(np.nextafter(start, begin) if way else start)
        if not way:
            self.held = begin
            self.holder = self._holding()
            return True
        self.t = start
        self._set_off(way)
        self.still = False
        place = self.s
        beyond, self.speed = just_ahead(self.leg, place, way)
        if self.touching:  # behind what rounding could take for the stop
            self.s, self.touching = beyond, {}
        if self.taken < len(self.times) and self.times[self.taken] == start:
            self._record(start, place, 0.0, self._now())
            self.taken += 1
        if start > begin:
            self._record(start, place, 0.0, self._now(), "start")
        return start > begin

    def _hold(self) -> None:
        """Take the signs of friction from the state, for the steps that follow."""
        if not self.reduction.rubs or not self.speed:
            return
        direction = math.copysign(1.0, self.speed)
        self.rubbing = self.leg.hold(self.s, self.speed, self.t, self.gain, direction)

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
