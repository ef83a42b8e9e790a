"""Rest, and passage along the curve of positions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.rounding import EPSILON
from linkwork.forces.dynamics.collocation import Step
from linkwork.forces.dynamics.curve import PositionCurve
from linkwork.forces.dynamics.events import BEHIND, Bound, Chatter, Sample
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
