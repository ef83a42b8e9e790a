"""The motion of several inputs, step by step, from event to event."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from linkwork.core.equations.input_motion import law_motions
from linkwork.core.foundation.arrays import EPSILON, Array
from linkwork.core.foundation.errors import InputError, KeyWords, key_text
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.statuses import ChangePointPolicy
from linkwork.core.foundation.values import as_told, check_flags, finite_number
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.motion.branch_rows import motion_of_rows
from linkwork.core.motion.higher_rates import model_in_time
from linkwork.core.motion.model import Model
from linkwork.core.motion.solving import solve
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.results.motion import Motion
from linkwork.forces.dynamics.collocation import Step, try_step
from linkwork.forces.dynamics.curve import PositionCurve, curve_of
from linkwork.forces.dynamics.events import (
    BEHIND,
    Bound,
    Chatter,
    Contacts,
    Event,
    Pace,
    Sample,
    SimulatedRows,
    finished_motion,
    first_event,
    just_behind,
    with_contacts,
)
from linkwork.forces.dynamics.input_dynamics import InputDynamics
from linkwork.forces.dynamics.reduction import FAR, NEAR, Reduction
from linkwork.forces.dynamics.simulated import (
    bounds_of,
    check_loaded,
    check_masses_move,
    model_name,
    start_speeds,
    straight_or_stop,
)
from linkwork.forces.dynamics.travel import Travel
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry

_SHORTEST = 1e-12  # of the whole time: a shorter step makes no way
_FIRST = 1e-3  # of the whole time: the first step
_DRIVEN = 1e-9  # of the normal: less of it is rounding
_RESTS = 1e-8  # of the whole time: a shorter bounce is rest
_LOW = 1e-12  # of a radian, or of the longest link: so is a lower one, whose margin is rounding
_SINGULAR = 1e4  # condition beyond which a dead point of the inputs is what stops the motion


@dataclass(eq=False)
class InputTravel:
    """A motion under way.

    ``times`` (B,): those asked for, rising. ``rows``: what is found so far, and ``added``, which
    of them were not asked for. ``pushes`` and ``impulses``: of the stops in these rows, (B, S).
    ``ended``: why the motion ended early, "" if it did not.
    """

    dynamics: InputDynamics
    bounds: Sequence[Bound]
    times: Array
    speed: Array
    certify: bool
    progress: Callable[[float], None] | None = None
    rows: list[SolvedRows] = field(default_factory=list)
    pushes: list[Array] = field(default_factory=list)
    impulses: list[Array] = field(default_factory=list)
    added: list[bool] = field(default_factory=list)
    ended: str = ""
    t: float = 0.0
    taken: int = 0
    longest: float = np.inf  # step after a shock

    def __post_init__(self) -> None:
        self.until = float(self.times[-1])
        self.q = self.dynamics.here
        self.chatter = Chatter(self.until)
        self.contacts = Contacts(self.dynamics, self.bounds)

    def run(self) -> None:
        """Step until all times are reached or the motion ends."""
        self._switch()
        self._touch()
        self._record_here("")
        self._strike_touched()
        h = _FIRST * self.until
        pace = Pace(self.until)
        while self.t < self.until and not self.ended:
            if pace.crawls(self.t, self.q):
                self._end(self._why())
                continue
            # the acceleration of a law jumps between its segments
            target = min(self.until, self.dynamics.inputs.next_break(self.t))
            short = target - self.t
            length = min(h, short, self.longest)
            step, following, _ = try_step(
                self.contacts.acceleration, self.t, self.q, self.speed, length, unit=1.0
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

    def _advance(self, step: Step, end: float) -> None:
        event = None
        comparisons = self.dynamics.reduction.switch_count
        if comparisons or self.bounds:
            self._aim(turn=False)
            event = first_event(step, end, self._margins, comparisons)
        count = len(self.bounds)
        if event is not None:
            # stops are met just before, all others just after
            end = event.before if event.number < count else event.after
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
        self.t = end
        self.q, self.speed = self.contacts.close(place[0], speed[0], end)
        if event is not None:
            self._meet(event)

    def _meet(self, event: Event) -> None:
        if event.number < len(self.bounds):
            self._hit(event.number)
            return
        if event.falls:
            number = event.number - len(self.bounds)
            self.contacts.active.remove(number)
            self._let_go([number])
            self._record_here("start")
            return
        # the row has the loads, and so the accelerations, after the switch
        q, size = self.q, np.maximum(np.abs(self.q), 1.0)
        before = self.contacts.acceleration(q[None], self.speed[None], self._now)[0]
        self.q, self.speed = just_behind(q, self.speed, before, size)
        self._switch()
        self._record_here("switch")
        if self.chatter.starts(self.t):
            self._end("a comparison in a load switches without end there")
        self._let_go(self.contacts.release(self.q, self.speed, self.t))
        for number in range(len(self.bounds)):
            if number not in self.contacts.active and self._margin(number) <= 0.0:
                self._hit(number)

    def _hit(self, number: int) -> None:
        """A shock at a stop: an impulse along its normal."""
        bound, inputs = self.bounds[number], self.dynamics.inputs
        name = f"stop of {bound.asked.name}"
        normal = self._normal(number)
        closing = float(normal @ self._whole(self.speed, 1))
        if closing >= 0.0:
            return
        free = normal[inputs.free]
        if np.abs(free).max() <= _DRIVEN * np.abs(normal).max():
            self._record_here(name)
            self._end(f"a law drives the mechanism into the {name}")
            return
        before = self.speed
        self.speed, impulses = self.contacts.strike(number, before, self.t, bound.restitution)
        pull = self.contacts.pull(number, self.q, self.speed, self.t)
        leaving = -bound.restitution * closing
        flight = 2.0 * leaving / -pull if pull < 0.0 else np.inf if leaving or pull else 0.0
        low = leaving * flight < _LOW * np.abs(normal).max()
        rests = pull <= 0.0 and (low or flight <= _RESTS * self.until)
        if rests:
            self.speed, impulses = self.contacts.strike(number, before, self.t, 0.0)
        self._record_struck(name, before, impulses)
        # a much longer step would look at the margin after the next shock only
        self.longest = 2.0 * flight if flight > 0.0 else np.inf
        if rests:
            self.contacts.active.append(number)
            self.q, self.speed = self.contacts.close(self.q, self.speed, self.t)
            self._let_go(self.contacts.release(self.q, self.speed, self.t))
        self._switch()

    def _let_go(self, numbers: Sequence[int]) -> None:
        """Go behind what rounding could take for stops that the motion leaves."""
        for number in numbers:
            normal, bound = self._normal(number), self.bounds[number]
            free = normal[self.dynamics.inputs.free]
            scale = bound.asked.names.units.scale(bound.asked.own.kind)
            size = scale * abs(bound.value) + np.abs(normal) @ (
                1.0 + np.abs(self._whole(self.q, 0))
            )
            self.q = self.q + BEHIND * EPSILON * size * free / float(free @ free)

    def _touch(self) -> None:
        """Close the stops that are touched at the start and pushed against; go behind the others,
        which may be pushed against later.
        """
        for number in range(len(self.bounds)):
            if self._margin(number) > self._rounding(number):
                continue
            closing = float(self._normal(number) @ self._whole(self.speed, 1))
            pull = self.contacts.pull(number, self.q, self.speed, self.t)
            if closing == 0.0 and pull < 0.0:
                self.contacts.active.append(number)
            elif closing == 0.0:
                self._let_go([number])
        self._let_go(self.contacts.release(self.q, self.speed, self.t))

    def _strike_touched(self) -> None:
        """Hit the stops that are touched at the start."""
        for number in range(len(self.bounds)):
            if self._margin(number) <= self._rounding(number) and not self.ended:
                self._hit(number)

    def _rounding(self, number: int) -> float:
        """Up to which margin a stop is touched."""
        return self.bounds[number].rounding(float(np.abs(self._normal(number)).max()))

    def _margin(self, number: int) -> float:
        """The margin of a stop now."""
        solved = self._geometry(self.q[None], self.speed[None], self._now).solved
        return float(self.bounds[number].inside(solved)[0])

    def _whole(self, free: Array, order: int) -> Array:
        """All inputs now, or their derivatives, from those of the free ones, (p,)."""
        found: Array = self.dynamics.inputs.complete(free[None], self._now, order)[0]
        return found

    def _normal(self, number: int) -> Array:
        """The derivatives of the margin of a stop by all inputs, (p,)."""
        v, _ = self.dynamics.positions(self.q[None], self._now)
        found: Array = self.contacts.normals([number], v, self._now)[0, 0]
        return found

    def _switch(self) -> None:
        """Let every comparison have the value that it has now."""
        reduction = self.dynamics.reduction
        if not reduction.switch_count:
            return
        reduction.release()
        self._aim(turn=True)
        margins = self._switch_margins(self.q[None], self.speed[None], self._now)
        now = [float(margin[0]) for margin in margins]
        # springs are measured along their lines of now, also those of no length
        count = len(now) - len(reduction.springs)
        reduction.switch([*now[:count], *(1.0 for _ in reduction.springs)])

    def _aim(self, turn: bool) -> None:
        if self.dynamics.reduction.springs:
            self.dynamics.aim(self._geometry(self.q[None], self.speed[None], self._now), turn)

    def _switch_margins(self, q: Array, speed: Array, t: Array) -> list[Array]:
        own = self.dynamics
        switches = own.reduction.switches
        applied = AppliedLoads(self._geometry(q, speed, t), 1.0, switches=switches)
        rates = own.inputs.complete(speed, t, 1) * own.size
        springs = own.spring_margins(applied.geometry)
        return own.reduction.margins(applied, rates, springs)

    @property
    def _now(self) -> Array:
        return np.array([self.t])

    def _geometry(self, q: Array, speed: Array, t: Array) -> Geometry:
        own = self.dynamics
        v, found = own.positions(q, t)
        rates = own.solver.rates(v, own.inputs.complete(speed, t, 1) * own.size)
        first = np.where(found[:, None], rates.first, np.nan)
        return own.reduction.geometry(v, first, np.full_like(v, np.nan), t)

    def _margins(self, q: Array, speed: Array, t: Array) -> Array:
        """The margins of stops, the pushes of those that are closed, and the margins of switches,
        in this order.
        """
        active = self.contacts.active
        solved = self._geometry(q, speed, t).solved
        one = np.ones(len(t))
        found = [
            one if number in active else bound.inside(solved)
            for number, bound in enumerate(self.bounds)
        ]
        pushes = {}
        if active:
            pushes = dict(zip(active, self.contacts.solve(q, speed, t)[1].T, strict=True))
        found += [pushes.get(number, one) for number in range(len(self.bounds))]
        if self.dynamics.reduction.switch_count:
            found += self._switch_margins(q, speed, t)
        return np.stack(found, axis=1)

    def check_inside(self) -> tuple[Bound, float] | None:
        """A stop beyond which the motion would begin, and its margin there."""
        for number, bound in enumerate(self.bounds):
            margin = self._margin(number)
            if margin < -self._rounding(number):
                return bound, margin
        return None

    def _record(
        self, t: Array, q: Array, speed: Array, bend: Array, event: str, added: bool
    ) -> bool:
        """Add rows; whether all their positions were found."""
        rows = self.dynamics.rows(q, speed, bend, t, self.certify)
        count = len(rows.v)
        pushes = np.zeros((count, len(self.bounds)))
        if self.contacts.active:
            found = self.contacts.solve(q[:count], speed[:count], t[:count])[1]
            pushes[:, self.contacts.active] = found
        self.pushes.append(pushes)
        self.impulses.append(np.zeros_like(pushes))
        self.rows.append(rows.with_columns(limit=np.full(count, event, dtype=object)))
        self.added += [added] * count
        if count < len(t):
            self.taken += count
            self._end("the inputs leave the branch of positions")
        return count == len(t)

    def _record_here(self, event: str) -> None:
        q, speed = self.q[None], self.speed[None]
        bend = self.contacts.acceleration(q, speed, self._now)
        self._record(self._now, q, speed, bend, event, bool(event))

    def _record_struck(self, name: str, before: Array, impulses: Array) -> None:
        """The row of a shock, with the speeds before it."""
        after, self.speed = self.speed, before
        self._record_here(name)
        self.impulses[-1][:] = impulses
        self.speed = after

    def _end(self, why: str) -> None:
        self.ended = why
        self._record_here("end")

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


# ----------------------------------------------------------------------
# Simulation of a mechanism with several inputs, free or driven by laws.


def simulate_inputs(
    model: Model,
    *,
    times: Array,
    at: float | Mapping[str, float] | None,
    start_speed: Number | Mapping[str, Number],
    policy: ChangePointPolicy,
    certify: bool,
    place: KeyWords,
    progress: Callable[[float], None] | None,
) -> Motion:
    """The motion of several inputs at times (B,): some may have laws, the others are free.

    Raises
    ------
    InputError
        For friction, motions straight across change points, and a start at which
        an input moves no mass.
    """
    name = f"{model_name(model)} has {len(model.description.inputs)} inputs"
    if policy is not ChangePointPolicy.STOP:
        raise InputError(f"{name}: their simulation stops at change points, leave out {policy}")
    speeds = start_speeds(model, start_speed)
    start = _start(model, at)
    reduction = Reduction(model, model_in_time(model), place=place)
    if reduction.rubs:
        raise InputError(f"{name}: friction is simulated with one input only, leave out [friction]")
    dynamics = InputDynamics(reduction, start.equations.start.copy())
    inputs = dynamics.inputs
    inputs.check(model, float(times[-1]))
    check_masses_move(model, dynamics.masses())
    travel = InputTravel(
        dynamics=dynamics,
        bounds=bounds_of(reduction.named),
        times=times,
        speed=(speeds / dynamics.size)[inputs.free],
        certify=certify,
        progress=progress,
    )
    beyond = travel.check_inside()
    if beyond is not None:
        bound, margin = beyond
        raise bound.passed_at_start(margin, place)
    travel.run()
    return _motion_of_inputs(travel)


def _start(model: Model, at: float | Mapping[str, float] | None) -> Model:
    """The mechanism at its start: driven inputs where their laws begin."""
    if not model.description.timed:
        return model.from_position(solve(model, at, certify=False, throw=True))
    names = [variable.name for variable in model.equations.inputs]
    laws = law_motions(model.equations, model.description)
    if at is not None and not isinstance(at, Mapping):
        raise InputError(f"name the input that begins at {at:g}, for example {names[0]}={at:g}")
    known = {canonical(name): value for name, value in (at or {}).items()}
    values = {}
    for name, own, law, scale in zip(
        names, model.start_inputs, laws, model.input_scale, strict=True
    ):
        if law is not None and canonical(name) in known:
            raise InputError(f"a law drives {name}, which begins where the law does: leave it out")
        here = own if law is None else law[0] + float(law[1].jet(np.zeros(1))[0][0])
        values[name] = known.pop(canonical(name), here / scale)
    # names of no input are refused with the others
    return model.from_position(solve(model, {**values, **known}, certify=False, throw=True))


def _motion_of_inputs(travel: InputTravel) -> Motion:
    told = f"simulated to t = {travel.t:.10g} s"
    if travel.ended:
        model = travel.dynamics.reduction.model
        q = travel.dynamics.inputs.complete(travel.q[None], np.array([travel.t]), 0)[0]
        values = q * travel.dynamics.size / model.input_scale
        inputs = model.equations.inputs
        place = ", ".join(
            f"{variable.name} = {value:.6g} {model.input_units[variable.name]}".rstrip()
            for variable, value in zip(inputs, values, strict=True)
        )
        told = f"the motion ends at t = {travel.t:.10g} s, {place}: {travel.ended}"
    found = SimulatedRows(
        rows=SolvedRows.concatenate(travel.rows),
        added=travel.added,
        pushes=np.concatenate(travel.pushes),
        impulses=np.concatenate(travel.impulses),
    )
    missing = travel.times[travel.taken :]
    return finished_motion(travel.dynamics.reduction, found, travel.bounds, missing, told)


# ----------------------------------------------------------------------
# Simulation: the motion in time of a mechanism from its start under its loads.


_ROWS = 400
_MOST_ROWS = 10_000_000
_LEAST = 1e-100  # seconds: the square of a short step does not vanish
_WEIGHTLESS = 1e-14  # of the largest inertia on a leg: none, to the rounding of its polynomials
Start = tuple[Reduction, PositionCurve]


def simulate(
    model: Model,
    *,
    until: float,
    step: float | None = None,
    at: float | Mapping[str, float] | None = None,
    start_speed: Number | Mapping[str, Number] = 0,
    change_points: str | ChangePointPolicy = ChangePointPolicy.STOP,
    certify: bool = True,
    place: KeyWords = key_text,
    progress: Callable[[float], None] | None = None,
) -> Motion:
    """The motion in time under masses, loads, springs and a motor.

    Parameters
    ----------
    until : float
        The last time [s].
    step : float, optional
        Between rows [s]; by default 400 rows.
    at : number, optional
        The input value at the start, in file units; by default that of the guess.
    start_speed : str, number or Mapping[str, str or number]
        Of the input: ``"60 rad/s"``; a number is in file units per second. Of several by name;
        those that are not named begin at rest.
    change_points : str
        ``stop`` at change points, or go ``straight`` on.
    certify : bool
        Prove the positions of all rows.
    place : callable
        Words the key of a load that has no value.
    progress : callable, optional
        Called with the finished fraction, 0 to 1.

    Raises
    ------
    InputError
        If nothing has mass, the mechanism has no input, laws drive all inputs, or it has several
        inputs and friction.
    """
    check_flags(progress, certify=certify)
    times = _times(until, step)
    policy = straight_or_stop(change_points)
    check_loaded(model)
    if len(model.description.inputs) > 1:
        several = simulate_inputs(
            model.untimed or model, times=times, at=at, start_speed=start_speed, policy=policy,
            certify=certify, place=place, progress=progress,
        )  # fmt: skip
        return with_contacts(model, several)
    speed = float(start_speeds(model, start_speed)[0])
    reduction, curve = start_of(model, at, policy, certify, place)
    travel = Travel(
        curve=curve,
        reduction=reduction,
        bounds=bounds_of(reduction.named),
        times=times,
        progress=progress,
    )
    _check_inside(travel)
    _check_inertia(travel)
    travel.begin(speed)
    travel.run()
    return with_contacts(model, _motion(travel, certify), *_states(travel))


def start_of(
    model: Model,
    at: float | Mapping[str, float] | None,
    policy: ChangePointPolicy,
    certify: bool,
    place: KeyWords = key_text,
) -> Start:
    """The loads, and the curve of positions through the start."""
    check_loaded(model)
    position = solve(model, at, certify=False, throw=True)
    there = model.from_position(position)
    start = there.equations.start.copy()
    reduction = Reduction(model, model_in_time(model), place)
    return reduction, curve_of(model, start, policy, certify)


def _times(until: float, step: float | None) -> Array:
    until = finite_number("until", until)
    if until <= 0.0:
        raise InputError(f"until must be a positive time, got {as_told(until)}")
    if until < _LEAST:
        raise InputError(f"until must be at least {_LEAST:g} s, got {as_told(until)}")
    if step is None:
        return np.linspace(0.0, until, _ROWS + 1)[1:]
    step = finite_number("step", step)
    count = int(np.floor(min(until / step, _MOST_ROWS + 1) + 1e-9)) if step > 0.0 else 0
    if not 1 <= count <= _MOST_ROWS:
        raise InputError(
            f"step must be a part of until, {until:g} s, that makes 1 to {_MOST_ROWS} rows, "
            f"got {as_told(step)}"
        )
    times = step * np.arange(1.0, count + 1)
    return times if abs(times[-1] - until) < 1e-9 * step else np.append(times, until)


def _check_inside(travel: Travel) -> None:
    here, still = np.array([travel.s]), np.zeros(1)
    for bound in travel.bounds:
        if bound.is_beyond(travel.leg, travel.s, 0.0, travel.gain):
            margin = float(bound.margin(travel.leg, here, still, still, travel.gain)[0])
            raise bound.passed_at_start(margin, travel.reduction.place)


def _check_inertia(travel: Travel) -> None:
    here, largest = (
        float(travel.leg.numbers(s)[:, 0].max())
        for s in (np.array([travel.s]), travel.leg.table.edges)
    )
    if here <= _WEIGHTLESS * largest:
        raise InputError(
            "no body with mass moves at the start, as at a dead point of a massless crank: start "
            "at another input, or give the crank a mass"
        )


def _motion(travel: Travel, certify: bool) -> Motion:
    if travel.ended:
        travel.record_end()
    samples, missing = travel.samples, travel.times[travel.taken :]
    told = f"simulated to t = {travel.t:.10g} s"
    if travel.held is not None:
        held = f"held by {travel.holder}" if travel.holder else "in equilibrium"
        told += f"; at rest since t = {travel.held:.10g} s, {held}"
    if travel.ended:
        told = f"the motion ends at t = {travel.t:.10g} s: {travel.ended}"
    pushes, impulses = np.zeros((2, len(samples), len(travel.bounds)))
    for k, sample in enumerate(samples):
        if sample.stop >= 0:
            pushes[k, sample.stop], impulses[k, sample.stop] = sample.push, sample.impulse
    motion = finished_motion(
        travel.reduction,
        SimulatedRows(
            rows=_rows(travel, samples, certify),
            added=[bool(sample.event) for sample in samples],
            pushes=pushes,
            impulses=impulses,
        ),
        travel.bounds,
        missing,
        told,
    )
    if not travel.reduction.rubs:
        return motion
    lost = np.array([*(sample.lost for sample in samples), *([np.nan] * len(missing))])
    return replace(motion, friction_work=lost)


def _states(travel: Travel) -> tuple[Array, Callable[[Array], Motion]]:
    """Times while the motion moves, at all nodes of its steps, and the motion at such times."""
    nodes = [step.nodes[step.nodes <= end] for _, _, step, end in travel.steps]
    ends = np.array([end for _, _, _, end in travel.steps])

    def at(times: Array) -> Motion:
        samples = []
        for t in times:
            number, lap, step, _ = travel.steps[min(int(ends.searchsorted(t)), len(ends) - 1)]
            s, speed, bend = (float(x[0]) for x in step.at(np.array([t])))
            samples.append(
                Sample(t=float(t), leg=number, lap=lap, s=s, speed=speed, acceleration=bend)
            )
        rows = _rows(travel, samples, False)
        return motion_of_rows(travel.reduction.named, rows, "", np.ones(len(times), dtype=bool))

    return np.concatenate([*nodes, np.zeros(0)]), at


def _rows(travel: Travel, samples: Sequence[Sample], certify: bool) -> SolvedRows:
    """The positions of samples, solved again, with their rates in time."""
    parts, order = [], []
    for number in sorted({sample.leg for sample in samples}):
        mine = [k for k, sample in enumerate(samples) if sample.leg == number]
        order += mine
        own = [samples[k] for k in mine]
        s = np.array([sample.s for sample in own])
        rows = travel.curve.legs[number].rows(s, certify)
        speed, bend, t, lap = (
            np.array([getattr(sample, name) for sample in own])[:, None]
            for name in ("speed", "acceleration", "t", "lap")
        )
        one = np.ones_like(t)
        parts.append(
            rows.with_columns(
                v=np.hstack([rows.v + lap * travel.curve.gain, t]),
                first=np.hstack([rows.first * speed, one]),
                second=np.hstack([rows.second * speed**2 + rows.first * bend, 0.0 * one]),
                inputs=t.copy(),
                branch=np.full(len(own), travel.reduction.model.circuit, dtype=object),
                limit=np.array([sample.event for sample in own], dtype=object),
            )
        )
    return SolvedRows.concatenate(parts).take(np.argsort(order, kind="stable"))
