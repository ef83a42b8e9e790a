"""Places, angles and rates of the bodies of a mechanism in all rows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.expression.derivatives import Jet, evaluate
from linkwork.core.expression.grammar import CONSTANTS, parse
from linkwork.core.expression.tree import Node, names_in, with_switches
from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray, FrozenDict
from linkwork.core.foundation.lanes import cis, is_batched
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import force_of_inertia
from linkwork.core.mechanism.description import Description
from linkwork.core.mechanism.dimensions import Number, Numbers
from linkwork.core.mechanism.machine import LoadedBodies, Mass
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.results.quantities.definition import Solved
from linkwork.core.results.quantity import Kind


class Geometry:
    """A mechanism's points and links in B rows, each computed once.

    Derivatives are with respect to the leading input; ``partial`` ones with respect to each of the
    p inputs alone; angles in radians.

    Parameters
    ----------
    model : Model
    solved : Solved
        One position or the rows of a motion.
    """

    def __init__(self, model: Model, solved: Solved) -> None:
        self.model, self.solved = model, solved
        description = model.description
        assert isinstance(description, LoadedBodies)
        self.links = description.carried
        self._places: dict[str, Jet] = {}
        self._angles: dict[str, Jet] = {}
        self._directions: dict[str, Jet] = {}

    @cached_property
    def rows(self) -> int:
        """B."""
        first = next(iter(self.points), None)
        return 1 if first is None else len(self.place(first).v)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of values of all rows."""
        return (self.rows,)

    @property
    def numbers(self) -> Numbers:
        """Reads numbers and formulas of the file."""
        return self.model.description.numbers

    @property
    def points(self) -> tuple[str, ...]:
        """The points of the file."""
        return self.model.motion_quantities.names.points

    @property
    def driven(self) -> Model:
        """The mechanism with its own inputs, also where time drives it."""
        return self.model.untimed or self.model

    @cached_property
    def input_rates(self) -> Array:
        """The rate of every input with respect to the leading one, or to time, (p,) or (p, B)."""
        if not self.model.equations.inputs and self.model.untimed is None:
            return np.zeros(0)  # a structure
        if self.model.untimed is None:
            return leading_input(self.model.rows)[1]
        return np.stack([self.own(each.name).d1 for each in self.driven.equations.inputs])

    def by_leading(self, each: Array) -> Array:
        """The sum of amounts of all inputs (p, B), per unit of the leading one or of time, (B,)."""
        found: Array = (self.input_rates.T * each.T).sum(axis=-1)
        return found

    @cached_property
    def input_ways(self) -> Array:
        """The rate of every input; of a simulated motion at rest its acceleration, (p,) or (p, B).

        Friction acts against the motion, or against that which begins.
        """
        if self.model.untimed is None or self.model.description.timed:
            return self.input_rates
        still = (self.input_rates == 0.0).all(axis=0)
        return np.where(still, self.input_bends, self.input_rates)

    @property
    def input_bends(self) -> Array:
        """The acceleration of every input where time drives the mechanism, (p, B)."""
        return np.stack([self.own(each.name).d2 for each in self.driven.equations.inputs])

    def own(self, name: str) -> Jet:
        """A variable of the mechanism [rad] or [length]."""
        jet = self.solved.own(name)
        kind = self.model.motion_quantities.own[name].own.kind
        return Jet(*map(np.atleast_1d, (jet.v * self.model.units.scale(kind), jet.d1, jet.d2)))

    def place(self, point: str) -> Jet:
        """A point as x + iy."""
        if point not in self._places:
            jet = self.solved.place(point)
            self._places[point] = Jet(*map(np.atleast_1d, (jet.v, jet.d1, jet.d2)))
        return self._places[point]

    def direction(self, link: str) -> Jet:
        """The unit vector of a link's x axis: from its first point towards its second."""
        if link not in self._directions:
            self._directions[link] = self._direction(link)
        return self._directions[link]

    def _direction(self, link: str) -> Jet:
        if link == GROUND:
            one = np.ones(self.rows, dtype=complex)
            return Jet(one, 0.0 * one, 0.0 * one)
        points = self.links[link]
        if len(points) > 1:
            span = self.place(points[1]) - self.place(points[0])
            return _times(span, 1.0 / np.abs(span.v))  # of constant length
        turn = self.angle(link)  # of wheels and blocks
        unit = np.cos(turn.v) + 1j * np.sin(turn.v)
        return Jet(unit, 1j * turn.d1 * unit, (1j * turn.d2 - turn.d1**2) * unit)

    def angle(self, link: str) -> Jet:
        """The angle of a link."""
        if link not in self._angles:
            self._angles[link] = self._angle(link)
        return self._angles[link]

    def _angle(self, link: str) -> Jet:
        if link in self.model.equations.links:
            return self.own(link)
        # loops have no angles of links, only their points; nothing turns a link of one point there
        if link == GROUND or len(self.links[link]) < 2:
            zero = np.zeros(self.rows)
            return Jet(zero, zero, zero)
        unit = self.direction(link)
        first = unit.d1 / unit.v
        second = (unit.d2 / unit.v).imag
        return Jet(np.unwrap(np.angle(unit.v)), first.imag, second)

    def local(self, link: str, place: complex | Array) -> Jet:
        """A point given in the frame of a link."""
        return self.place(self.links[link][0]) + _times(self.direction(link), place)

    @cached_property
    def variables(self) -> Array:
        """All variables of the mechanism with its own inputs, internal units, (B, N)."""
        equations = self.driven.equations
        spans = {part.variable: part.points for part in equations.redundant}
        found = []
        for variable in equations.variables:
            if variable.name in spans:  # the length of a redundant link is no quantity
                first, second = (self.place(point).v for point in spans[variable.name])
                found.append(np.abs(second - first))
            else:
                found.append(self.own(variable.name).v)
        return np.stack(found, axis=1)

    @cached_property
    def _partials(self) -> tuple[ComplexArray, Array]:
        """Derivatives with respect to each input: points (p, B, P), variables (p, B, N)."""
        compiled, v = self.driven.compiled, self.variables
        units = np.eye(len(self.driven.equations.inputs))
        rates = np.zeros((len(units), *v.shape))  # none for a structure
        places = np.zeros((len(units), len(v), len(compiled.points.names)), dtype=complex)
        for k, unit in enumerate(units):
            rates[k] = compiled.solver.rates(v, unit).first
            places[k] = compiled.points.jet(v, rates[k], np.zeros_like(v))[1]
        return places, rates

    @property
    def alone(self) -> bool:
        """Whether there is one input, which leads."""
        return self.model.untimed is None and len(self.model.equations.inputs) == 1

    def partial(self, point: str) -> ComplexArray:
        """Derivatives of a point with respect to each input, (p, B)."""
        # the usual case: the motion itself is the partial derivative
        if self.alone:
            found: ComplexArray = self.place(point).d1[None, :]
            return found
        return self._partials[0][:, :, self.driven.compiled.points.names.index(point)]

    def turning(self, link: str) -> Array:
        """Derivatives of a link's angle with respect to each input, (p, B)."""
        count = len(self.driven.equations.inputs)
        if link == GROUND or self.alone:
            found: Array = np.broadcast_to(self.angle(link).d1, (count, self.rows))
            return found
        if link not in self.model.equations.links:
            first, second = self.links[link][:2]
            span = self.place(second).v - self.place(first).v
            return np.asarray(((self.partial(second) - self.partial(first)) / span).imag)
        variable = self.model.equations.links[link].variable
        # links held by sliders on ground do not turn
        if variable is None:
            return np.zeros((count, self.rows))
        names = [x.name for x in self.driven.equations.variables]
        symbols = [x.symbol for x in self.driven.equations.variables]
        k = names.index(variable) if variable in names else symbols.index(variable)
        return self._partials[1][:, :, k]

    def partial_local(self, link: str, place: complex | Array) -> ComplexArray:
        """Derivatives of a point in the frame of a link with respect to each input, (p, B)."""
        arm = 1j * self.direction(link).v * place
        found: ComplexArray = self.partial(self.links[link][0]) + self.turning(link) * arm
        return found

    @cached_property
    def length(self) -> float:
        """The longest link."""
        return self.model.equations.length_scale

    @cached_property
    def fastest(self) -> Array:
        """The largest rate of links [rad] and points [longest links] in every row, (B,)."""
        most = np.zeros(self.rows)
        for link in self.links:
            most = np.fmax(most, np.abs(self.angle(link).d1))
        for point in self.points:
            most = np.fmax(most, np.abs(self.place(point).d1) / self.length)
        return most

    @property
    def table_direction(self) -> float:
        """1 or -1: which way the leading input goes in the table; 1 for one row or no input."""
        if not self.model.equations.inputs:
            return 1.0
        names = self.model.motion_quantities.names
        values = self.model.rows[:, list(names.inputs).index(names.lead)]
        return -1.0 if values[-1] < values[0] else 1.0

    @property
    def lead(self) -> Array:
        """The leading input, [rad] or [length]."""
        return self.own(self.model.motion_quantities.names.lead).v

    def kind(self, name: str) -> Kind:
        """Whether an input is an angle or a length."""
        return self.driven.motion_quantities.names.inputs[name]


def _times(jet: Jet, factor: complex | Array) -> Jet:
    """A jet times what does not change along the motion."""
    return Jet(jet.v * factor, jet.d1 * factor, jet.d2 * factor)


# ----------------------------------------------------------------------
# Loads in all rows: given forces and torques, springs, weight and inertia of masses.


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
