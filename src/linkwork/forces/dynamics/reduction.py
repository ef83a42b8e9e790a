"""The loads, the motor and the flywheel of a simulated mechanism with one input."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Binary, Node, names_in
from linkwork.core.foundation.arrays import Array, FrozenDict
from linkwork.core.foundation.errors import KeyWords, key_text
from linkwork.core.foundation.units import force_of_inertia
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.machine import LoadedBodies
from linkwork.core.mechanism.part.springs import Spring
from linkwork.core.motion.model import Model
from linkwork.core.motion.positions import RowValues
from linkwork.core.results.quantity import Rate
from linkwork.forces.dynamics.collocation import motors_of
from linkwork.forces.reactions.free_bodies import FreeBodies
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry, load_formulas
from linkwork.forces.reactions.parts import apply_load, join_loads
from linkwork.forces.reactions.switches import held_switches, load_switches, switch_margins


class Displaced(Geometry):
    """Positions with derivatives by the leader, which counts as the one input."""

    alone = True

    @cached_property
    def input_rates(self) -> Array:
        """That of the leader with respect to itself."""
        return np.ones(1)


#: Of the whole time: where a load that no step can follow shows, and where it is as usual.
NEAR = 1e-14 * np.array([0.0, 1.0, 1e1, 1e2, 1e3, 1e4])
FAR = np.array([-1e-3, 1e-3])
_POLE = 1e3  # times its usual amount: a load that no step can follow


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """B states on a leg: rows with their rates in time, and the displacements by the leader."""

    moving: Geometry
    displaced: Geometry


class Reduction:
    """What is the same on all legs.

    Parameters
    ----------
    model, named : Model
        The mechanism, and the same over time.
    place : callable
        Words the key of a load for messages.
    """

    def __init__(self, model: Model, named: Model, place: KeyWords = key_text) -> None:
        description = model.description
        assert isinstance(description, LoadedBodies)
        self.model, self.named = model, named
        self.description, self.place = description, place
        #: Of all inputs; the first one is that of a mechanism with one input.
        self.motors = motors_of(model)
        self.motor = self.motors[0]
        #: Springs whose tension jumps at zero length, and the signs of their margins now.
        springs = description.springs if isinstance(description, Linkage) else ()
        self.springs = [spring for spring in springs if self._jumps(spring)]
        self.sides: list[bool] = []
        self.switches: Mapping[Node, float] = FrozenDict()
        #: Whether joints have friction; a rolling wheel has adhesion, which takes no energy.
        self.rubs = isinstance(description, Linkage) and any(
            description.numbers(own.mu) > 0.0
            for name, own in description.friction.items()
            if not any("slips" in p.lets_go and name in p.names for p in description.parts)
        )

    def _jumps(self, spring: Spring) -> bool:
        numbers = self.description.numbers
        return spring.between is not None and numbers(spring.stiffness) * numbers(spring.free) > 0

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
        return tuple(parse(each, comparing=True) for _, each in load_formulas(self.description))

    @cached_property
    def comparisons(self) -> tuple[Binary, ...]:
        """What can switch loads."""
        return load_switches(self.description)

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
        return not (timed or damped or switched or driven)

    @cached_property
    def inertias(self) -> Array:
        """The moments of inertia, or masses, on all inputs, in the unit of force, (p,)."""
        own = self.description
        unit = force_of_inertia(own.mass, own.length, own.force)
        given = [each.inertia for each in own.inputs]
        return np.array([0.0 if x is None else own.numbers(x) * unit for x in given])

    @property
    def inertia(self) -> float:
        """That on the first input."""
        return float(self.inertias[0])

    @cached_property
    def switch_count(self) -> int:
        """The number of all margins at which loads jump or have a kink."""
        corners = sum(len(motor.corners) for motor in self.motors if motor is not None)
        return len(self.comparisons) + corners + len(self.springs)

    def margins(self, applied: AppliedLoads, rates: Array, springs: Array) -> list[Array]:
        """Of all switches, (B,) each: of formulas, of motors at rates (B, p), and those of the
        springs (B, S) as given.
        """
        found = switch_margins(self.comparisons, applied)
        for motor, rate in zip(self.motors, rates.T, strict=True):
            found += [] if motor is None else motor.margins(rate)
        return [*found, *springs.T]

    def switch(self, margins: Sequence[float]) -> None:
        """Let every switch have the value that belongs to its margin."""
        self.switches = held_switches(self.comparisons, margins[: len(self.comparisons)])
        further = list(margins[len(self.comparisons) :])
        for motor in self.motors:
            if motor is not None:
                corners, further = further[: len(motor.corners)], further[len(motor.corners) :]
                motor.piece = sum(margin > 0.0 for margin in corners)
        self.sides = [margin > 0.0 for margin in further]

    @property
    def held(self) -> tuple[object, ...]:
        """The values of all switches, to be compared."""
        pieces = [motor.piece for motor in self.motors if motor is not None]
        return dict(self.switches), pieces, self.sides

    def release(self) -> None:
        """Let every load follow the state."""
        self.switches, self.sides = FrozenDict(), []
        for motor in self.motors:
            if motor is not None:
                motor.piece = None

    def failing_load(self, there: Geometry, before: Geometry) -> str:
        """Why a load stops the motion ``there``, in the rows in which no step succeeds; "" if none
        does. ``before``: rows at some distance.
        """
        near, far = (AppliedLoads(rows, 1.0, switches=self.switches) for rows in (there, before))
        for key, formula in load_formulas(self.description):
            found = near.value(formula)
            if not np.isfinite(found).all():
                return f'{self.place(key)} "{formula}" has no finite value there'
            usual = np.nanmax(np.abs(far.value(formula)), initial=0.0)
            if np.abs(found).max() > _POLE * usual > 0.0:
                return f'{self.place(key)} "{formula}" grows without bound there'
        return ""

    def geometry(self, v: Array, first: Array, second: Array, t: Array) -> Geometry:
        """Rows (B, N) with derivatives by time, or by a leader."""
        return Geometry(self.named, self._rows(v, first, second, t))

    def displaced(self, v: Array, first: Array, second: Array) -> Displaced:
        """Rows (B, N) with derivatives by a leader."""
        return Displaced(self.named, self._rows(v, first, second, np.zeros(len(v))))

    def _rows(self, v: Array, first: Array, second: Array, t: Array) -> RowValues:
        one = np.ones(len(v))
        return RowValues(
            self.named,
            np.column_stack([v, t]),
            np.column_stack([first, one]),
            np.column_stack([second, 0.0 * one]),
            np.ones(len(v), dtype=bool),
        )

    def loaded(self, moving: Geometry, springs: Array | None = None) -> AppliedLoads:
        """All loads but weights, which the masses bring; ``springs`` (B, S): margins of springs."""
        passed = {}
        if springs is not None and self.sides:
            passed = {
                spring.name: np.where((margin > 0.0) == side, 1.0, -1.0)
                for spring, margin, side in zip(self.springs, springs.T, self.sides, strict=True)
            }
        applied = AppliedLoads(moving, 1.0, switches=self.switches, passed=passed)
        if isinstance(self.description, Linkage):
            join_loads(FreeBodies(self.description, moving, applied))
            return applied
        for load in self.acting:
            apply_load(load, applied)
        return applied
