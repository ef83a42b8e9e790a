"""The motion of a mechanism with one input as that of one number: A s̈ + ½A' ṡ² = Q.

A and ½A' follow from the masses and Q from the loads, all as functions of the leader's place s on
a leg of the curve of positions; they are tabulated, so that no mechanism is solved afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.dynamics.curve import Leg
from linkwork.dynamics.panels import Panels, fit_panels
from linkwork.expression.grammar import parse
from linkwork.expression.tree import Binary, Node, comparisons_in, names_in
from linkwork.forces.applied import AppliedLoads
from linkwork.forces.free_bodies import FreeBodies
from linkwork.forces.geometry import Geometry
from linkwork.forces.part.index import join_loads
from linkwork.forces.part.load import apply_load
from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.units import force_of_inertia
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.loaded import LoadedBodies
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import RowValues
from linkwork.results.quantity import Rate

__all__ = ["Forcing", "ReducedLeg", "Reduction", "State"]


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """B states on a leg: rows with their rates in time, and the displacements by the leader."""

    moving: Geometry
    displaced: Geometry


#: A further generalised force along the leader at B states, such as friction, (B,).
Forcing = Callable[[State], Array]


class Reduction:
    """What is the same on all legs.

    Parameters
    ----------
    model, named : Model
        The mechanism, and the same over time.
    forcing : sequence of Forcing
        Further forces.
    """

    def __init__(self, model: Model, named: Model, forcing: Sequence[Forcing] = ()) -> None:
        description = model.description
        assert isinstance(description, LoadedBodies)
        self.model, self.named, self.forcing = model, named, forcing
        self.description = description
        self.motor = description.inputs[0].motor
        self.switches: Mapping[Node, float] = FrozenDict()

    @cached_property
    def acting(self) -> tuple[Any, ...]:
        """The parts that load the mechanism: loads and springs."""
        parts = getattr(self.description, "parts", None)
        if parts is None:  # of loops
            return tuple(getattr(self.description, "loads", ()))
        return tuple(part for part in parts if part.acts)

    @cached_property
    def formulas(self) -> tuple[Node, ...]:
        """The formulas of all loads."""
        numbers = (each for part in self.acting for _, each in getattr(part, "formulas", ()))
        return tuple(parse(each, comparing=True) for each in numbers if isinstance(each, str))

    @cached_property
    def comparisons(self) -> tuple[Binary, ...]:
        """What can switch loads."""
        found = (each for formula in self.formulas for each in comparisons_in(formula))
        return tuple(dict.fromkeys(found))

    @cached_property
    def names(self) -> frozenset[str]:
        """The names in formulas that are no dimensions."""
        known = self.description.numbers.known
        used = {node.name for formula in self.formulas for node in names_in(formula)}
        return frozenset(used - set(known))

    @cached_property
    def of_position(self) -> bool:
        """Whether all loads follow from the position alone, smoothly."""
        timed = "t" in self.names or any(Rate.split(name)[1] for name in self.names)
        damped = any(getattr(part, "damping", 0) != 0 for part in self.acting)
        switched = bool(self.comparisons)
        driven = self.motor is not None and not self.motor.constant
        return not (timed or damped or switched or driven or self.forcing)

    @property
    def pushed(self) -> bool:
        """Whether anything but weights and the motor acts."""
        return bool(self.acting or self.forcing)

    @cached_property
    def inertia(self) -> float:
        """The moment of inertia, or mass, on the input, in the unit of force."""
        given = self.description.inputs[0].inertia
        if given is None:
            return 0.0
        own = self.description
        return own.numbers(given) * force_of_inertia(own.mass, own.length, own.force)

    def motor_torque(self, rate: Array) -> Array:
        """The motor's torque at rates of the input, [rad/s] or [length/s], (B,)."""
        assert self.torque is not None
        return self.torque(rate / self.model.input_scale[0])

    @cached_property
    def torque(self) -> Callable[[Array], Array] | None:
        """The motor's torque over the input's speed in file units."""
        if self.motor is None:
            return None
        own = self.description
        kind = "link" if self.model.equations.inputs[0].kind == "angle" else "slider"
        return self.motor.curve(kind, own.numbers, own.length)

    def geometry(self, v: Array, first: Array, second: Array, t: Array) -> Geometry:
        """Rows (B, N) with derivatives by time, or by a leader."""
        one = np.ones(len(v))
        rows = RowValues(
            self.named,
            np.column_stack([v, t]),
            np.column_stack([first, one]),
            np.column_stack([second, 0.0 * one]),
            np.ones(len(v), dtype=bool),
        )
        return Geometry(self.named, rows)

    def loaded(self, moving: Geometry) -> AppliedLoads:
        """All loads but weights, which the masses bring."""
        applied = AppliedLoads(moving, 1.0, switches=self.switches)
        if isinstance(self.description, Linkage):
            join_loads(FreeBodies(self.description, moving, applied))
            return applied
        for load in self.acting:
            apply_load(load, applied)
        return applied


class ReducedLeg:
    """A leg with its tables."""

    def __init__(self, reduction: Reduction, leg: Leg) -> None:
        self.reduction, self.leg = reduction, leg
        low, high = sorted((leg.begin, leg.end))
        self.variables = reduction.model.compiled.solver.variables
        scale = reduction.model.compiled.table.variable_scale
        groups = np.concatenate([[0, 1, 1], 2 + np.arange(self.variables)])
        groups = np.concatenate([groups, np.full(self.variables, groups[-1] + 1)])
        least = np.concatenate([np.zeros(3), scale, np.zeros(self.variables)])
        whole = fit_panels(self._tabulated, low, high, groups, least)
        #: A, Q of weights, Q of loads of position, A'.
        self.numbers: Panels = whole.part(slice(0, 3)).with_slope()
        #: Variables and their first derivatives.
        self.table: Panels = whole.part(slice(3, None))

    def _tabulated(self, s: Array) -> Array:
        """A, Q of weights, Q of loads of position, variables, first derivatives."""
        order = np.argsort(s, kind="stable")
        rows = self.leg.rows(s[order], False).take(np.argsort(order, kind="stable"))
        displaced = self.reduction.geometry(rows.v, rows.first, rows.second, np.zeros(len(s)))
        applied = AppliedLoads(displaced, 1.0)
        zero = np.zeros(len(s))
        with np.errstate(all="ignore"):
            applied.weigh(self.reduction.description)
            mass = 2.0 * sum(applied.kinetic, zero)
            weight = sum((body.weight_rate for body in applied.masses), zero)
        lead = self.reduction.model.compiled.solver.unknowns
        q1 = rows.first[:, lead]
        mass = mass + self.reduction.inertia * q1**2
        load = zero
        if self.reduction.of_position:
            still = self.reduction.geometry(rows.v, 0.0 * rows.v, 0.0 * rows.v, zero)
            load = self._pushes(State(moving=still, displaced=displaced))
            if self.reduction.motor is not None:
                load = load + self.reduction.motor_torque(zero) * q1
        return np.column_stack([mass, weight, load, rows.v, rows.first])

    def acceleration(self, s: Array, speed: Array, t: Array, gain: Array) -> Array:
        """s̈ at B states; ``gain`` (N,): what variables have gained in laps."""
        mass, weight, load, slope = self.numbers(s).T
        force = weight + load
        if not self.reduction.of_position:
            force = force + self.generalised_force(s, speed, t, gain)
        with np.errstate(all="ignore"):
            # eq. (92): A' is the derivative of the polynomial for A, so that energy is kept
            found: Array = (force - 0.5 * slope * speed**2) / mass
        return found

    def state(self, s: Array, speed: Array, t: Array, gain: Array) -> State:
        """The rows of B states."""
        row = self.table(s)
        v, first = row[:, : self.variables] + gain, row[:, self.variables :]
        unknown = np.full_like(v, np.nan)
        moving = self.reduction.geometry(v, first * speed[:, None], unknown, t)
        displaced = self.reduction.geometry(v, first, unknown, t)
        return State(moving=moving, displaced=displaced)

    def generalised_force(self, s: Array, speed: Array, t: Array, gain: Array) -> Array:
        """Q of all loads but weights, (B,)."""
        slope = self.input_slope(s)
        total = np.zeros(len(s))
        if self.reduction.pushed:
            total = self._pushes(self.state(s, speed, t, gain))
        if self.reduction.motor is not None:
            total = total + self.reduction.motor_torque(slope * speed) * slope
        return total

    def input_slope(self, s: Array) -> Array:
        """The derivative of the input by the leader, (B,)."""
        return self.slopes(s)[:, self.reduction.model.compiled.solver.unknowns]

    def slopes(self, s: Array) -> Array:
        """The derivatives of all variables by the leader, (B, N)."""
        return self.table(s)[:, self.variables :]

    def _pushes(self, state: State) -> Array:
        """Q of loads, springs and further forces, (B,)."""
        applied = self.reduction.loaded(state.moving)
        total = np.zeros(state.moving.rows)
        for point, force, _ in applied.forces:
            total = total + (force.conj() * state.displaced.place(point).d1).real
        for link, torque in applied.torques:
            total = total + torque * state.displaced.angle(link).d1
        for forcing in self.reduction.forcing:
            total = total + forcing(state)
        return total

    def margins(self, s: Array, speed: Array, t: Array, gain: Array) -> Array:
        """Left minus right side of all comparisons, (B, comparisons)."""
        moving = self.state(s, speed, t, gain).moving
        applied = AppliedLoads(moving, 1.0, switches=self.reduction.switches)
        return np.stack(
            [
                applied.formula(each.left) - applied.formula(each.right)
                for each in self.reduction.comparisons
            ],
            axis=1,
        )
