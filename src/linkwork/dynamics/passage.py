"""A motion under way along the curve of positions: its state, and what is known of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.dynamics.collocation import Step
from linkwork.dynamics.curve import PositionCurve
from linkwork.dynamics.events import Bound
from linkwork.dynamics.joint_friction import Rubbing
from linkwork.dynamics.pace import Chatter
from linkwork.dynamics.reduced_leg import ReducedLeg
from linkwork.dynamics.reduction import Reduction
from linkwork.dynamics.sample import Sample
from linkwork.foundation.arrays import Array

__all__ = ["Passage"]

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
