"""Places, angles and rates of the bodies of a mechanism in all rows."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from linkwork.core.expression.derivatives import Jet
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.dimensions import Numbers
from linkwork.core.mechanism.loaded import LoadedBodies
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
