"""The motion of several inputs, step by step, from event to event."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from linkwork.dynamics.events import Bound, Event, first_event, just_behind
from linkwork.dynamics.input_dynamics import InputDynamics
from linkwork.dynamics.pace import Pace
from linkwork.dynamics.reduction import FAR, NEAR
from linkwork.dynamics.vector_collocation import VectorStep, try_vector_step
from linkwork.forces.applied import AppliedLoads
from linkwork.forces.geometry import Geometry
from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.rounding import EPSILON
from linkwork.numerics.rows import SolvedRows

__all__ = ["InputTravel"]

_SHORTEST = 1e-12  # of the whole time: a shorter step makes no way
_FIRST = 1e-3  # of the whole time: the first step
_MOST_EVENTS = 60  # switches within this part of the whole time: they chatter
_CHATTER = 1e-7
_DIFFERENCE = 1e-3  # of fourth order, for the normal of a stop
_DRIVEN = 1e-9  # of the normal: less of it is rounding
_RESTS = 1e-8  # of the whole time: a shorter bounce is rest
_LOW = 1e-12  # of a radian, or of the longest link: so is a lower one, whose margin is rounding
_TOUCHES = 1e-9  # of the same: a stop so near at the start is touched
_SINGULAR = 1e4  # condition beyond which a dead point of the inputs is what stops the motion


@dataclass(eq=False)
class InputTravel:
    """A motion under way.

    ``times`` (B,): those asked for, rising. ``rows``: what is found so far, and ``added``, which
    of them were not asked for. ``ended``: why the motion ended early, "" if it did not.
    """

    dynamics: InputDynamics
    bounds: Sequence[Bound]
    times: Array
    speed: Array
    certify: bool
    progress: Callable[[float], None] | None = None
    rows: list[SolvedRows] = field(default_factory=list)
    added: list[bool] = field(default_factory=list)
    ended: str = ""
    t: float = 0.0
    taken: int = 0

    def __post_init__(self) -> None:
        self.until = float(self.times[-1])
        self.q = self.dynamics.here
        self.recent: list[float] = []

    def run(self) -> None:
        """Step until all times are reached or the motion ends."""
        self._switch()
        self._record_here("")
        self._touch()
        h = _FIRST * self.until
        pace = Pace(self.until)
        while self.t < self.until and not self.ended:
            if pace.crawls(self.t, self.q):
                self._end(self._why())
                continue
            # the acceleration of a law jumps between its segments
            target = min(self.until, self.dynamics.inputs.next_break(self.t))
            short = target - self.t
            step, following = try_vector_step(
                self.dynamics.acceleration, self.t, self.q, self.speed, min(h, short, self.longest)
            )
            if step is None:
                if following < _SHORTEST * self.until:
                    self._end(self._why())
                h = following
                continue
            reaches, self.longest = step.h == short, np.inf
            h = following if h <= short else max(h, following)
            self._advance(step, target if reaches else step.t + step.h)
            if self.progress is not None:
                self.progress(self.t / self.until)

    def _advance(self, step: VectorStep, end: float) -> None:
        event = None
        comparisons = len(self.dynamics.reduction.comparisons)
        if comparisons or self.bounds:
            event = first_event(step, end, self._margins, comparisons)
        if event is not None:
            end = event.before if event.falls else event.after
        times = self.times[self.taken :]
        times = times[times <= end]
        if len(times) and not self._record(times, *step.at(times), "", False):
            return
        self.taken += len(times)
        place, speed, _ = step.at(np.array([end]))
        # what follows starts from a proved position, never from one of a rejected step
        if not self.dynamics.settle(place[0], end):
            self._end("the position there is not proved: it is too close to a singular one")
            return
        self.t, self.q, self.speed = end, place[0], speed[0]
        if event is not None:
            self._meet(event)

    def _meet(self, event: Event) -> None:
        if event.falls:
            self._hit(event.number)
            return
        # the row has the loads, and so the accelerations, after the switch
        q, size = self.q, np.maximum(np.abs(self.q), 1.0)
        before = self.dynamics.acceleration(q[None], self.speed[None], self._now)[0]
        self.q, self.speed = just_behind(q, self.speed, before, size)
        self._switch()
        self._record_here("switch")
        limit = self.t - _CHATTER * self.until
        self.recent = [*(t for t in self.recent if t > limit), self.t]
        if len(self.recent) > _MOST_EVENTS:
            self._end("a comparison in a load switches without end there")
        for number in range(len(self.bounds)):
            way = self._normal(number) @ self._whole(self.speed, 1)
            if self._margin(number) <= 0.0 and way < 0.0:
                self._hit(number)

    def _hit(self, number: int) -> None:
        """A shock at a stop: an impulse along its normal."""
        bound, inputs = self.bounds[number], self.dynamics.inputs
        name = f"stop of {bound.asked.name}"
        self._record_here(name)
        normal = self._normal(number)
        free = normal[inputs.free]
        if np.abs(free).max() <= _DRIVEN * np.abs(normal).max():
            self._end(f"a law drives the mechanism into the {name}")
            return
        push = np.linalg.solve(self.dynamics.masses(), free)
        closing = float(normal @ self._whole(self.speed, 1))
        # eq. (172)
        self.speed = self.speed - (1.0 + bound.restitution) * closing / float(free @ push) * push
        leaving, pull = -bound.restitution * closing, self._pull(number, normal)
        flight = 2.0 * leaving / -pull if pull < 0.0 else np.inf if leaving or pull else 0.0
        low = leaving * flight < _LOW * np.abs(normal).max()
        if pull <= 0.0 and (low or flight <= _RESTS * self.until):
            self._end(f"it stays at the {name}, and contacts of several inputs are not computed")
        # a much longer step would look at the margin after the next shock only
        self.longest = 2.0 * flight if flight > 0.0 else np.inf
        self._switch()

    longest: float = np.inf

    def _pull(self, number: int, normal: Array) -> float:
        """The second derivative of the margin of a stop by time."""
        bend = self.dynamics.acceleration(self.q[None], self.speed[None], self._now)[0]
        return float(normal @ self._whole(bend, 2)) + self._curving(number)

    def _touch(self) -> None:
        """Hit a stop that is touched at the start, or end if the motion stays at it."""
        for number, bound in enumerate(self.bounds):
            normal = self._normal(number)
            if self.ended or self._margin(number) > _rounding(bound, normal):
                continue
            closing = float(normal @ self._whole(self.speed, 1))
            if closing < 0.0:
                self._hit(number)
            elif closing == 0.0 and self._pull(number, normal) < 0.0:
                name = f"stop of {bound.asked.name}"
                self._end(
                    f"it stays at the {name}, and contacts of several inputs are not computed"
                )

    def _margin(self, number: int) -> float:
        """The margin of a stop now."""
        return float(self._stop_margins(number, self._whole(self.q, 0)[None])[0])

    def _whole(self, free: Array, order: int) -> Array:
        """All inputs now, or their derivatives, from those of the free ones, (p,)."""
        found: Array = self.dynamics.inputs.complete(free[None], self._now, order)[0]
        return found

    def _normal(self, number: int) -> Array:
        """The derivatives of the margin of a stop by all inputs, (p,)."""
        here = self._whole(self.q, 0)
        steps = _DIFFERENCE * np.array([1.0, -1.0, 2.0, -2.0])
        around = np.stack([here + step * unit for step in steps for unit in np.eye(len(here))])
        up, down, far_up, far_down = self._stop_margins(number, around).reshape(4, len(here))
        found: Array = (8.0 * (up - down) - (far_up - far_down)) / (12.0 * _DIFFERENCE)
        return found

    def _curving(self, number: int) -> float:
        """The second derivative of the margin of a stop by time, at constant speeds."""
        speed = self._whole(self.speed, 1)
        size = float(np.abs(speed).max())
        if size == 0.0:
            return 0.0
        steps = _DIFFERENCE * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
        along = self._whole(self.q, 0) + steps[:, None] * speed / size
        found = self._stop_margins(number, along) @ np.array([-1.0, 16.0, -30.0, 16.0, -1.0])
        return float(found) / 12.0 * (size / _DIFFERENCE) ** 2

    def _stop_margins(self, number: int, inputs: Array) -> Array:
        """The margin of a stop at all inputs (B, p), with the speeds of now, (B,)."""
        times, bound = np.full(len(inputs), self.t), self.bounds[number]
        speeds = np.tile(self._whole(self.speed, 1), (len(inputs), 1))
        solved = self._geometry_of(inputs, speeds, times).solved
        found: Array = bound.side * (bound.asked.values(solved, 1.0) - bound.value)
        return found

    def _switch(self) -> None:
        """Let every comparison have the value that it has now."""
        reduction = self.dynamics.reduction
        if not reduction.comparisons:
            return
        reduction.switches = FrozenDict()
        applied = self._applied(self.q[None], self.speed[None], self._now)
        reduction.switch([float(margin[0]) for margin in reduction.margins(applied)])

    @property
    def _now(self) -> Array:
        return np.array([self.t])

    def _applied(self, q: Array, speed: Array, t: Array) -> AppliedLoads:
        return AppliedLoads(
            self._geometry(q, speed, t), 1.0, switches=self.dynamics.reduction.switches
        )

    def _geometry(self, q: Array, speed: Array, t: Array) -> Geometry:
        inputs = self.dynamics.inputs
        return self._geometry_of(inputs.complete(q, t, 0), inputs.complete(speed, t, 1), t)

    def _geometry_of(self, inputs: Array, speeds: Array, t: Array) -> Geometry:
        """Rows at all inputs (B, p) and their speeds."""
        v, found = self.dynamics.positions_of(inputs)
        rates = self.dynamics.solver.rates(v, speeds * self.dynamics.size)
        first = np.where(found[:, None], rates.first, np.nan)
        return self.dynamics.reduction.geometry(v, first, np.full_like(v, np.nan), t)

    def _margins(self, q: Array, speed: Array, t: Array) -> Array:
        """The margins of stops and of comparisons, in this order."""
        applied = self._applied(q, speed, t)
        solved = applied.geometry.solved
        found = [
            bound.side * (bound.asked.values(solved, 1.0) - bound.value) for bound in self.bounds
        ]
        found += self.dynamics.reduction.margins(applied)
        return np.stack(found, axis=1)

    def check_inside(self) -> tuple[Bound, float] | None:
        """A stop beyond which the motion would begin, and the value there."""
        for number, bound in enumerate(self.bounds):
            margin = self._margin(number)
            if margin < -_rounding(bound, self._normal(number)):
                return bound, bound.value + bound.side * margin
        return None

    def _record(
        self, t: Array, q: Array, speed: Array, bend: Array, event: str, added: bool
    ) -> bool:
        """Add rows; whether all their positions were found."""
        rows = self.dynamics.rows(q, speed, bend, t, self.certify)
        count = len(rows.v)
        self.rows.append(rows.with_columns(limit=np.full(count, event, dtype=object)))
        self.added += [added] * count
        if count < len(t):
            self.taken += count
            self._end("the inputs leave the branch of positions")
        return count == len(t)

    def _record_here(self, event: str) -> None:
        q, speed = self.q[None], self.speed[None]
        bend = self.dynamics.acceleration(q, speed, self._now)
        self._record(self._now, q, speed, bend, event, bool(event))

    def _end(self, why: str, event: str = "end") -> None:
        self.ended = why
        self._record_here(event)

    def _why(self) -> str:
        """Why no step succeeds."""
        if self.dynamics.nearness > _SINGULAR:
            return "a dead point of the inputs: their values do not lead on from there"
        near, far = (
            self._geometry(
                self.q + ahead[:, None] * self.speed,
                np.tile(self.speed, (len(ahead), 1)),
                self.t + ahead,
            )
            for ahead in (NEAR * self.until, FAR * self.until)
        )
        return self.dynamics.reduction.failing_load(near, far) or (
            "the accelerations have no bound there, or the inputs leave their reach"
        )


def _rounding(bound: Bound, normal: Array) -> float:
    """Up to which margin a stop is touched."""
    return _TOUCHES * float(np.abs(normal).max()) + 8.0 * EPSILON * abs(bound.value)
