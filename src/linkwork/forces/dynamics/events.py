"""States of a simulated motion at times."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.foundation.arrays import EPSILON, Array, solutions
from linkwork.core.foundation.errors import InputError, KeyWords
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.mechanism.part.springs import Load
from linkwork.core.motion.branch_rows import motion_of_rows
from linkwork.core.motion.model import Model
from linkwork.core.numerics.newton import SolvedRows
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked, Solved
from linkwork.forces.dynamics.collocation import Step
from linkwork.forces.dynamics.input_dynamics import InputDynamics
from linkwork.forces.dynamics.joint_friction import Rubbing
from linkwork.forces.dynamics.reduced_leg import ReducedLeg
from linkwork.forces.dynamics.reduction import Reduction
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry
from linkwork.forces.reactions.parts import apply_load
from linkwork.forces.reactions.solving import forces_of_motion


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


# ----------------------------------------------------------------------
# Contacts, stops and energy of a simulation.


# ----------------------------------------------------------------------
# What a simulated motion asks of its contacts, and the energy of its flywheels.


#: What a simulation goes on with, by how a contact fails.
_KEPT = {
    "lifts off": "keep the contact", "slips": "roll on", "goes slack": "keep the strand tight"
}  # fmt: skip
_CUTS, _CONTACT_ROUNDS = 16, 12  # of the time in which a contact lifts off: to rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedRows:
    """The K rows of a simulation, which of them were ``added`` to those asked for, and what its S
    stops give: ``pushes`` and ``impulses`` (K, S).
    """

    rows: SolvedRows
    added: Sequence[bool]
    pushes: Array
    impulses: Array


def finished_motion(
    reduction: Reduction, found: SimulatedRows, bounds: Sequence[Bound], missing: Array, told: str
) -> Motion:
    """The motion of simulated rows, and of the times (B,) that are ``missing`` behind them."""
    rows = found.rows
    if len(missing):
        blank = SolvedRows.blank(missing[:, None], rows.v.shape[1], Status.OUT_OF_REACH)
        rows = SolvedRows.concatenate([rows, blank])
    added = np.array([*found.added, *[False] * len(missing)])
    motion = motion_of_rows(reduction.named, rows, told, added)
    tables: list[dict[str, Array]] = [{}, {}]
    for table, parts in zip(tables, (found.pushes, found.impulses), strict=True):
        for bound, part in zip(bounds, parts.T, strict=True):
            given = np.append(bound.side * part, np.full(len(missing), np.nan))
            table[bound.asked.name] = table.get(bound.asked.name, 0.0) + given
    motion = replace(motion, stop_forces=tables[0], stop_impulses=tables[1])
    energy = np.zeros(len(motion))
    for which, inertia in zip(reduction.description.inputs, reduction.inertias, strict=True):
        if inertia:
            energy += 0.5 * inertia * motion[f"{which.column}.velocity"] ** 2
    if energy.any():
        motion = replace(motion, flywheel_energy=energy)
    return _with_energy_watched(motion, reduction)


def with_contacts(
    model: Model,
    motion: Motion,
    times: Array | None = None,
    at: Callable[[Array], Motion] | None = None,
) -> Motion:
    """The motion, whose message says when a cam lifts off, a strand goes slack or a wheel slips.

    ``at``: the motion at times (B,) while it moves; ``times``: some of them, so close that no
    change is missed between them.
    """
    parts = {
        part.names[0]: part for part in getattr(model.description, "parts", ()) if part.lets_go
    }
    if not parts:
        return motion
    looks = [motion] if at is None or times is None or not len(times) else [motion, at(times)]
    t = np.concatenate([each["t"] for each in looks])
    order = np.argsort(t, kind="stable")
    found = [forces_of_motion(model, each) for each in looks]
    told = [motion.message]
    for name in found[0].values:
        part = parts.get(name.partition(".")[0])
        for tables, slips in (("lifted", False), ("slipping", True)):
            wrong = np.concatenate([getattr(each, tables)[name] for each in found])[order]
            if part is None or not wrong.any():
                continue
            k = int(wrong.argmax())
            low, high = t[order][[max(k - 1, 0), k]].tolist()
            for _ in range(0 if len(looks) == 1 else _CONTACT_ROUNDS):
                assert at is not None
                inside = np.linspace(low, high, _CUTS + 1)
                cut = getattr(forces_of_motion(model, at(inside)), tables)[name]
                if not cut.any():
                    break
                first = max(int(cut.argmax()), 1)
                low, high = inside[[first - 1, first]].tolist()
            how = part.lets_go[slips]
            told.append(f"{name} {how} at t = {high:.10g} s: later rows {_KEPT[how]}")
    frictions = getattr(model.description, "friction", ())
    told += [
        f"{name} rolls without slip"
        for name, part in parts.items()
        if "slips" in part.lets_go and name in frictions and not any(name in x for x in told[1:])
    ]
    return replace(motion, message="; ".join(told))


# ----------------------------------------------------------------------
# Stops on which a mechanism with several inputs rests: they push, and stay closed.


_NOISE = 16.0 * EPSILON  # of what stops give


class Contacts:
    """The stops of a mechanism, of which it touches those with the numbers ``active``."""

    def __init__(self, dynamics: InputDynamics, bounds: Sequence[Bound]) -> None:
        self.dynamics, self.bounds = dynamics, bounds
        self.active: list[int] = []

    def _jets(self, numbers: Sequence[int], v: Array, whole: Array, t: Array) -> list[Jet]:
        """The margins [rad] or [length] at positions (B, N) and speeds of all inputs (B, p), with
        derivatives by time at constant speeds.
        """
        own = self.dynamics
        rates = own.solver.rates(v, whole * own.size)
        solved = own.reduction.geometry(v, rates.first, rates.second, t).solved
        found = []
        for number in numbers:
            bound = self.bounds[number]
            jet = bound.asked.jet(solved)
            scale = bound.asked.names.units.scale(bound.asked.own.kind)
            found.append(
                Jet(
                    bound.side * scale * (jet.v - bound.value), bound.side * jet.d1,
                    bound.side * jet.d2,
                )
            )  # fmt: skip
        return found

    def normals(self, numbers: Sequence[int], v: Array, t: Array) -> Array:
        """The derivatives of margins by all inputs, (B, c, p)."""
        units = np.eye(len(self.dynamics.size))
        parts = [self._jets(numbers, v, np.tile(unit, (len(v), 1)), t) for unit in units]
        return np.stack([np.stack([jet.d1 for jet in part], axis=1) for part in parts], axis=2)

    def solve(self, q: Array, speed: Array, t: Array) -> tuple[Array, Array]:
        """Accelerations of the free inputs (B, f) and the pushes of the active stops, (B, c)."""
        own, active = self.dynamics, self.active
        if not active:
            return own.acceleration(q, speed, t), np.zeros((len(q), 0))
        v, mass, force = own.balance(q, speed, t)
        good = np.isfinite(force).all(axis=1) & np.isfinite(mass).all(axis=(1, 2))
        bend, pushes = np.full_like(force, np.nan), np.full((len(q), len(active)), np.nan)
        # eq. (173)
        normal = self.normals(active, v, t)
        jets = self._jets(active, v, own.inputs.complete(speed, t, 1), t)
        curve = np.stack([jet.d2 for jet in jets], axis=1)
        curve += np.einsum("bcp,bp->bc", normal, own.inputs.complete(0.0 * q, t, 2))
        free = normal[:, :, own.inputs.free]
        columns = np.concatenate([force[:, :, None], np.swapaxes(free, 1, 2)], axis=2)
        moved = solutions(mass[good], columns[good])
        stiff = free[good] @ moved[:, :, 1:]
        gap = -curve[good] - np.einsum("bcf,bf->bc", free[good], moved[:, :, 0])
        pushes[good] = solutions(stiff, gap[:, :, None])[:, :, 0]
        pushed = np.einsum("bfc,bc->bf", moved[:, :, 1:], pushes[good])
        rest = moved[:, :, 0] + pushed
        # where stops take all forces, what is left is their rounding
        bend[good] = np.where(np.abs(rest) <= _NOISE * np.abs(pushed), 0.0, rest)
        return bend, pushes

    def acceleration(self, q: Array, speed: Array, t: Array) -> Array:
        """q̈ (B, f) of states (B, f) at times (B,); NaN where there is no position."""
        return self.solve(q, speed, t)[0]

    def pull(self, number: int, q: Array, speed: Array, t: float) -> float:
        """The second derivative of a margin by time."""
        own, now = self.dynamics, np.array([t])
        bend = self.acceleration(q[None], speed[None], now)
        v = own.variables[None]
        whole = own.inputs.complete(speed[None], now, 1)
        (jet,) = self._jets([number], v, whole, now)
        return float(
            jet.d2[0] + self.normals([number], v, now)[0, 0] @ own.inputs.complete(bend, now, 2)[0]
        )

    def strike(
        self, number: int, speed: Array, t: float, restitution: float
    ) -> tuple[Array, Array]:
        """The speeds of the free inputs after a shock at a stop, and the impulses at it and at the
        active stops, which stay closed as long as they push.
        """
        own, now = self.dynamics, np.array([t])
        closed = [number, *(each for each in self.active if each != number)]
        while True:
            normal = self.normals(closed, own.variables[None], now)[0]
            closing = normal @ own.inputs.complete(speed[None], now, 1)[0]
            goal = np.zeros(len(closed))
            goal[0] = -restitution * closing[0]  # eq. (172)
            free = normal[:, own.inputs.free]
            moved = np.linalg.solve(own.masses(), free.T)
            impulses = np.linalg.solve(free @ moved, goal - closing)
            if impulses[1:].min(initial=0.0) >= 0.0:
                break
            closed.pop(1 + int(np.argmin(impulses[1:])))
        self.active = [each for each in self.active if each in closed]
        found = np.zeros(len(self.bounds))
        found[closed] = impulses
        return speed + moved @ impulses, found

    def close(self, q: Array, speed: Array, t: float) -> tuple[Array, Array]:
        """The nearest state at which the active stops are exactly closed and at rest."""
        if not self.active:
            return q, speed
        own, now = self.dynamics, np.array([t])
        v = own.variables[None]
        normal = self.normals(self.active, v, now)[0]
        inverse = np.linalg.pinv(normal[:, own.inputs.free])
        whole = own.inputs.complete(speed[None], now, 1)[0]
        jets = self._jets(self.active, v, whole[None], now)
        return q - inverse @ [float(jet.v[0]) for jet in jets], speed - inverse @ (normal @ whole)

    def release(self, q: Array, speed: Array, t: float) -> list[int]:
        """Let go of stops that would have to pull, the strongest first; returns their numbers."""
        gone = []
        while self.active:
            pushes = self.solve(q[None], speed[None], np.array([t]))[1][0]
            if not pushes.min() < 0.0:
                break
            gone.append(self.active.pop(int(np.argmin(pushes))))
        return gone


# ----------------------------------------------------------------------
# The energy of a motion under conservative loads, which must not drift.


_DRIFTS = 1e-9  # of the largest kinetic energy
_ROUNDING = 64.0 * EPSILON  # of the largest energy


def _with_energy_watched(motion: Motion, reduction: Reduction) -> Motion:
    """The motion; where its energy drifts, it says so and is not certified from there.

    Shocks at stops may take energy, so that it is compared between two of them.
    """
    if not _is_conservative(reduction):
        return motion
    with np.errstate(all="ignore"):
        kinetic, potential = _energies(motion, reduction)
        energy = kinetic + potential
    drift = np.zeros(len(energy))
    shocks = [k + 1 for k, event in enumerate(motion.limit) if event.startswith("stop of")]
    for part in np.split(np.arange(len(energy)), shocks):
        drift[part] = np.abs(energy[part] - energy[part[:1]])
    largest = float(np.nanmax(kinetic, initial=0.0))
    floor = _ROUNDING * float(np.nanmax(np.abs(potential), initial=0.0))
    first = np.flatnonzero(drift > _DRIFTS * largest + floor)
    if not len(first):
        return motion
    begin = int(first[0])
    share, since = float(np.nanmax(drift)) / largest, float(motion.inputs["t"][begin])
    certification = [
        Certification.ENERGY_DRIFTS if k >= begin and each.certified else each
        for k, each in enumerate(motion.certification)
    ]
    told = f"{motion.message}; its energy drifts by {share:.1e} of the largest kinetic energy, "
    return replace(
        motion,
        message=f"{told}first at t = {since:.10g} s: rows are not certified from there",
        certification=tuple(certification),
    )


def _is_conservative(reduction: Reduction) -> bool:
    """Whether weights, springs and constant loads alone move the mechanism."""
    description = reduction.description
    driven = any(motor is not None and not motor.constant for motor in reduction.motors)
    laws = any(which.law is not None for which in description.inputs)
    varying = bool(reduction.names - set(CONSTANTS))
    lossy = any(
        part.turns_with is not None if isinstance(part, Load) else part.damping != 0
        for part in reduction.acting
    )
    return not (driven or laws or varying or lossy or reduction.rubs)


def _energies(motion: Motion, reduction: Reduction) -> tuple[Array, Array]:
    """The kinetic energy, flywheels included, and the energy of all that loads the mechanism."""
    geometry = Geometry(reduction.named, motion)
    applied = reduction.loaded(geometry)
    applied.weigh(reduction.description)
    zero = np.zeros(geometry.shape)
    kinetic, stored = sum(applied.kinetic, zero), sum(applied.stored, zero)
    for which, inertia, motor in zip(
        reduction.model.equations.inputs, reduction.inertias, reduction.motors, strict=True
    ):
        jet = geometry.own(which.name)
        kinetic = kinetic + 0.5 * inertia * jet.d1**2
        if motor is not None:
            stored = stored - motor.torque(0.0 * jet.v) * jet.v
    pushed = AppliedLoads(geometry, 1.0)
    for part in reduction.acting:
        if isinstance(part, Load):
            apply_load(part, pushed)
    for load, moved in pushed.moving(geometry):
        stored = stored - (np.conj(load) * moved.v).real
    return kinetic, stored
