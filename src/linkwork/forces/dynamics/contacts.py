"""Contacts, stops and energy of a simulation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.foundation.arrays import Array, solutions
from linkwork.core.foundation.rounding import EPSILON
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.mechanism.part.springs import Load
from linkwork.core.motion.model import Model
from linkwork.core.motion.rows_between import motion_of_rows
from linkwork.core.numerics.system import SolvedRows
from linkwork.core.results.motion import Motion
from linkwork.forces.dynamics.events import Bound
from linkwork.forces.dynamics.input_dynamics import InputDynamics
from linkwork.forces.dynamics.reduction import Reduction
from linkwork.forces.reactions.applied import AppliedLoads
from linkwork.forces.reactions.geometry import Geometry
from linkwork.forces.reactions.parts import apply_load
from linkwork.forces.reactions.solving import forces_of_motion

# ----------------------------------------------------------------------
# What a simulated motion asks of its contacts, and the energy of its flywheels.


#: What a simulation goes on with, by how a contact fails.
_KEPT = {
    "lifts off": "keep the contact", "slips": "roll on", "goes slack": "keep the strand tight"
}  # fmt: skip
_CUTS, _ROUNDS = 16, 12  # of the time in which a contact lifts off: to rounding


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
            for _ in range(0 if len(looks) == 1 else _ROUNDS):
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
