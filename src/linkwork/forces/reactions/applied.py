"""Loads in all rows: given forces and torques, springs, weight and inertia of masses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import Node, names_in, with_switches
from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray
from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.lanes import cis, is_batched
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import force_of_inertia
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.loaded import LoadedBodies
from linkwork.core.mechanism.machine import Mass
from linkwork.forces.reactions.geometry import Geometry


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A mass in motion: its weight and inertia as a force and a torque, (B,) each.

    ``centre`` in the link's frame, ``place`` at rest on ground; ``mass`` and ``inertia`` in the
    unit of force; the rates are those of its weight's work and of its kinetic energy.
    """

    link: str
    centre: complex | Array
    place: ComplexArray
    force: ComplexArray
    torque: Array
    mass: float
    inertia: float | Array
    weight_rate: Array
    kinetic_rate: Array


@dataclass(eq=False)
class AppliedLoads:
    """All loads on a mechanism.

    ``forces`` are (point, force, link), ``torques`` (link, torque), ``stored`` the energies of
    springs and weights, (B,) each; ``rate`` is the speed of the leading input, 0 without one.
    ``switches``: comparisons in formulas that do not follow the rows, with their value 0 or 1.
    ``passed``: springs beyond their zero length that pull as if they had not passed it, -1, (B,).
    ``undefined``: formulas with rows in which they have no finite value, (B,).
    """

    geometry: Geometry
    rate: float
    forces: list[tuple[str, ComplexArray, str | None]] = field(default_factory=list)
    torques: list[tuple[str, Array]] = field(default_factory=list)
    masses: list[Body] = field(default_factory=list)
    kinetic: list[Array] = field(default_factory=list)
    stored: list[Array] = field(default_factory=list)
    stored_rates: list[Array] = field(default_factory=list)
    switches: Mapping[Node, float] = FrozenDict()
    passed: Mapping[str, Array] = FrozenDict()
    undefined: dict[str, BoolArray] = field(default_factory=dict)

    @cached_property
    def moves(self) -> bool:
        """Whether the leading input has a speed."""
        return bool(np.any(np.not_equal(self.rate, 0.0)))

    def push(self, point: str, force: ComplexArray, link: str | None = None) -> None:
        """A force on a point, (B,), on the pin there or on one of its links."""
        self.forces.append((point, force, link))

    def turn(self, link: str, torque: Array) -> None:
        """A torque on a link, (B,)."""
        self.torques.append((link, torque))

    def moving(self, geometry: Geometry) -> Iterator[tuple[AnyArray, Jet]]:
        """Every force and torque with what it moves in the rows of a geometry."""
        for point, force, _ in self.forces:
            yield force, geometry.place(point)
        for link, torque in self.torques:
            yield torque, geometry.angle(link)

    def value(self, number: Number) -> Array:
        """A number or formula in all rows, (B,)."""
        if not isinstance(number, str):
            still: Array = np.zeros(self.geometry.shape) + self.geometry.numbers(number)
            return still
        found = self.formula(parse(number, comparing=True))
        # of families, and of values that are recorded, rows are judged later
        if not is_batched(found):
            lost = ~np.isfinite(found)
            if lost.any():
                self.undefined[number] = lost
        return found

    def formula(self, tree: Node) -> Array:
        """The value of a formula in all rows, (B,)."""
        geometry, model = self.geometry, self.geometry.model
        tree = with_switches(tree, self.switches)
        names = {node.name: self._named(node.name) for node in names_in(tree)}
        with np.errstate(all="ignore"):
            known = {name: jet for name, jet in names.items() if jet is not None}
            found = evaluate(tree, known, model.units.angle)
        return np.zeros(geometry.shape) + found.v

    def _named(self, name: str) -> Jet | None:
        model = self.geometry.model
        known: Mapping[str, float] = self.geometry.numbers.known
        if name in known:
            return _constant(known[name])
        # dimensions come first: a file may call one of them t
        if name == "t":
            return _constant(time_of(self.geometry))
        if name in CONSTANTS:
            return None
        asked = model.motion_quantities.find(name)
        # without a speed there is a rate in simulations only
        speed = np.nan if model.speed is None else model.speed
        return _constant(np.atleast_1d(asked.values(self.geometry.solved, speed)))

    def weigh(self, loaded: LoadedBodies) -> None:
        """Add the weight and the inertia of all masses."""
        if not loaded.masses:
            return
        unit = force_of_inertia(loaded.mass, loaded.length, loaded.force)
        fall = 0j
        if loaded.gravity is not None:
            numbers = self.geometry.numbers
            size = loaded.gravity.acceleration(numbers, loaded.length)
            angle, way = loaded.gravity.angle, -1j
            if angle is not None:
                way = cis(numbers(angle) * loaded.angle.radians)
            fall = size * way
        for link, mass in loaded.masses.items():
            if link != GROUND:
                self._add_mass(link, mass, unit, fall)

    def _add_mass(self, link: str, given: Mass, unit: float, fall: complex) -> None:
        geometry = self.geometry
        numbers = geometry.numbers
        mass, inertia = numbers(given.mass) * unit, numbers(given.inertia) * unit
        x, y = map(numbers, given.center or (0.0, 0.0))
        centre: complex | Array = x + 1j * y
        # a rod's length follows from its points, which loops give row by row
        if given.shape is not None:
            first, second = geometry.links[link][:2]
            length = np.abs(geometry.place(second).v - geometry.place(first).v)
            centre, inertia = length / 2.0, mass * length**2 / 12.0
        place, turn, rate = geometry.local(link, centre), geometry.angle(link), self.rate
        squared = rate * rate  # a power of a float may overflow with an error
        velocity, bend, spin, turned = (
            # without a speed nothing moves, and rates need not exist
            part * factor if self.moves else np.zeros(geometry.shape)
            for part, factor in (
                (place.d1, rate),
                (place.d2, squared),
                (turn.d1, rate),
                (turn.d2, squared),
            )
        )
        falling = mass * (velocity * np.conj(fall)).real
        force: Any = mass * (fall - bend)  # real where nothing moves
        self.masses.append(
            Body(
                link=link,
                centre=centre,
                place=place.v,
                # weight and inertia of eq. (71) as one load
                force=force + 0j,
                torque=-inertia * turned,
                mass=mass,
                inertia=inertia,
                weight_rate=falling,
                kinetic_rate=mass * (velocity.conj() * bend).real + inertia * spin * turned,
            )
        )
        self.stored.append(-mass * (place.v * np.conj(fall)).real)
        self.stored_rates.append(-falling)
        self.kinetic.append(0.5 * (mass * np.abs(velocity) ** 2 + inertia * spin**2))


def virtual_work(load: AnyArray, moved: Jet) -> Array:
    """The work of a force or torque per unit of what the geometry moves with, (B,)."""
    found: Array = (np.conj(load) * moved.d1).real
    return found


def load_formulas(description: Description) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """The keys of all formulas of loads, and the formulas."""
    for k, load in enumerate(getattr(description, "loads", ())):
        for key, number in load.formulas:
            if isinstance(number, str):
                yield ("loads", k, *key), number


def time_of(geometry: Geometry) -> Array:
    """The time since the first row of the table [s]; NaN without a speed."""
    model = geometry.model
    if model.untimed is not None:
        return geometry.lead
    if not model.equations.inputs:
        return np.full(geometry.shape, np.nan)
    lead = list(model.motion_quantities.names.inputs).index(model.motion_quantities.names.lead)
    speed = model.speed or np.nan
    return np.asarray((geometry.lead - model.rows[0, lead]) / speed)


def _constant(value: Any) -> Jet:
    zero = np.zeros(())
    number: Any = value if is_batched(value) else np.asarray(value)
    return Jet(number, zero, zero)
