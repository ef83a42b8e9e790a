"""Named quantities of many designs over many rows, from their variables."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.batch.rates import DesignRates
from linkwork.equations.compiling import coordinate_name
from linkwork.expression.jets import Jet, evaluate
from linkwork.expression.tree import names_in
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, ComplexArray, TurnArray
from linkwork.foundation.errors import UnknownNameError, choices
from linkwork.foundation.names import canonical, find_spelling
from linkwork.motion.lock_step import lock_step
from linkwork.motion.model import Model
from linkwork.results.quantity import Kind

__all__ = ["QuantityValues", "point_named", "quantity_found", "quantity_names"]


_NONE = np.zeros(())  # the rates of what is only asked for its value


class QuantityValues:
    """Reads quantities off the variables of D designs over R rows.

    Parameters
    ----------
    designs : Designs
    inputs : (R, p)
        As asked, in file units.
    v : (n, R, D)
        Unknowns, internal units; NaN where there is no position.
    turns : (R, D)
        How many whole turns further than asked the first input of a position is.
    rates : DesignRates, optional
        Without them only values can be asked for.
    """

    def __init__(
        self,
        designs: Designs,
        inputs: Array,
        v: Array,
        turns: TurnArray,
        rates: DesignRates | None = None,
    ) -> None:
        self.designs, self.inputs, self.v, self.turns = designs, inputs, v, turns
        self.model, self.rates = designs.base, rates
        self.equations = designs.base.equations
        self._number = {x.symbol: k for k, x in enumerate(self.equations.variables)}
        self._lost = np.isnan(v).any(axis=0) if len(v) else np.zeros(v.shape[1:], dtype=bool)

    def _blanks(self) -> tuple[Array, Array]:
        """0, NaN where a variable has no first or no second derivative, (R, D)."""
        if self.rates is None:
            return _NONE, _NONE
        first = np.isnan(self.rates.first).any(axis=0) | self._lost
        second = np.isnan(self.rates.second).any(axis=0) | first
        return np.where(first, np.nan, 0.0), np.where(second, np.nan, 0.0)

    def names(self) -> list[str]:
        """All names that :meth:`of` knows."""
        return quantity_names(self.model)

    def of(self, name: str) -> Array:
        """A quantity by name, (D, R), in file units.

        Raises
        ------
        UnknownNameError
            With the names that exist.
        """
        inputs = [x.name for x in self.equations.inputs]
        own = find_spelling(name, inputs)
        if own in inputs:
            column = self.inputs[:, inputs.index(own)]
            return np.broadcast_to(column, (len(self.designs), len(self.inputs)))
        return self.jet(name)[1].v.T

    def trace(self, point: str) -> ComplexArray:
        """Positions of a point as x + iy, (D, R)."""
        places: ComplexArray = self._place(point_named(self.model, point))[0].T
        return places

    def jet(self, name: str) -> tuple[Kind, Jet]:
        """What is named, (R, D): the value in file units, rates in radians and lengths.

        Raises
        ------
        UnknownNameError
            With the names that exist.
        """
        kind, own, what = quantity_found(self.model, name)
        if what == "output":
            return kind, self._output(own)
        match what:
            case "variable":
                symbol = {x.name: x.symbol for x in self.equations.variables}[own]
                jet = self._variable(symbol)
            case "link":
                jet = self._link(own)
            case "slider":
                jet = self._variable(canonical(self.equations.sliders[own]))
            case axis:
                jet = self._coordinate(own, axis)
        return kind, Jet(jet.v / self.model.units.scale(kind), jet.d1, jet.d2)

    def _variable(self, symbol: str) -> Jet:
        """A variable by symbol."""
        k = self._number[symbol]
        n, rates = len(self.equations.unknowns), self.rates
        if k < n:
            if rates is None:
                return Jet(self.v[k], _NONE, _NONE)
            return Jet(self.v[k], rates.first[k], rates.second[k])
        column = self.inputs[:, k - n] * self.model.input_scale[k - n]
        value = np.where(self._lost, np.nan, column[:, None])
        if k == n and self.turns.any():
            value = value + self.turns * FULL_TURN
        if rates is None:
            return Jet(value, _NONE, _NONE)
        rate = lock_step(self.model.rows)[1][k - n]
        first, second = (
            np.where(self._lost | ~driven, np.nan, own)
            for driven, own in zip(rates.driven, (rate, 0.0), strict=True)
        )
        return Jet(value, first, second)

    def _link(self, name: str) -> Jet:
        number = list(self.equations.links).index(name)
        blank = np.where(self._lost, np.nan, 0.0)
        zero = _NONE if self.rates is None else blank
        constant = Jet(blank + self.designs.link_angles[:, number], zero, zero)
        variable = self.equations.links[name].variable
        return constant if variable is None else self._variable(canonical(variable)) + constant

    def _coordinate(self, point: str, axis: str) -> Jet:
        parts = self._place(point)
        return Jet(*((part.real if axis == "x" else part.imag) for part in parts))

    def _place(self, name: str) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """A point as x + iy with both derivatives."""
        table = self.model.compiled.points
        number = {own: k for k, own in enumerate(table.names)}
        parent = self.equations.points[name].parent
        if parent is None:
            blanks = (np.where(self._lost, np.nan, 0.0), *self._blanks())
            place, first, second = (_as_complex(blank) for blank in blanks)
        else:
            place, first, second = self._place(parent)
        for term in np.flatnonzero(table.rows.row == number[name]):
            own, own1, own2 = self._term(int(term))
            place, first, second = place + own, first + own1, second + own2
        return place, first, second

    def _term(self, term: int) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """c s e^{iψ} with both derivatives."""
        rows = self.model.compiled.points.rows
        symbols = [x.symbol for x in self.equations.variables]
        value: ComplexArray = self.designs.points[:, term][None, :]
        mine = rows.phase_term == term
        turn = Jet.constant(0.0)
        for k, weight in zip(rows.phase_variable[mine], rows.phase_weight[mine], strict=True):
            angle = self._variable(symbols[k])
            turn = turn + Jet(weight * angle.v, weight * angle.d1, weight * angle.d2)
        if mine.any():
            value = value * np.exp(1j * np.asarray(turn.v))
        length = int(rows.length[term])
        if self.rates is None:
            value = value if length < 0 else value * self._variable(symbols[length]).v
            return value, np.zeros((), dtype=complex), np.zeros((), dtype=complex)
        s = Jet.constant(1.0) if length < 0 else self._variable(symbols[length])
        first = value * (s.d1 + 1j * s.v * turn.d1)
        second = s.d2 - s.v * turn.d1**2 + 1j * (2.0 * s.d1 * turn.d1 + s.v * turn.d2)
        return value * s.v, first, value * second

    def _output(self, name: str) -> Jet:
        """Formulas see and give file units; derivatives of angles come back in radians."""
        output, shape = self.equations.outputs[name], self._lost.shape
        scale = self.model.units.scale(Kind(output.kind))
        with np.errstate(all="ignore"):
            jet = evaluate(output.formula, self._known(name), self.equations.angle)
        v, d1, d2 = (
            np.where(self._lost, np.nan, np.broadcast_to(part, shape))
            for part in (jet.v, jet.d1 * scale, jet.d2 * scale)
        )
        return Jet(v, d1, d2)

    def _known(self, name: str) -> Mapping[str, Jet]:
        """What the formula of an output needs: dimensions, variables, links, coordinates."""
        equations = self.equations
        used = {node.name for node in names_in(equations.outputs[name].formula)}
        columns = zip(equations.dimensions, self.designs.numbers.T, strict=True)
        found = {own: Jet(values, _NONE, _NONE) for own, values in columns if own in used}
        for variable in equations.variables:
            if variable.symbol in used:
                jet = self._variable(variable.symbol)
                found[variable.symbol] = self._in_file_units(jet, Kind(variable.kind))
        for link in equations.links:
            if canonical(link) in used and canonical(link) not in found:
                found[canonical(link)] = self._in_file_units(self._link(link), Kind.ANGLE)
        for point in equations.points:
            for axis in "xy":
                symbol = coordinate_name(point, axis)
                if symbol in used:
                    found[symbol] = self._coordinate(point, axis)
        return found

    def _in_file_units(self, jet: Jet, kind: Kind) -> Jet:
        scale = 1.0 / self.model.units.scale(kind)
        return Jet(jet.v * scale, jet.d1 * scale, jet.d2 * scale)


def _as_complex(blank: Array) -> ComplexArray:
    """0, or NaN in both parts."""
    both: ComplexArray = np.asarray(blank * (1.0 + 1.0j), dtype=complex)
    return both


def quantity_names(model: Model) -> list[str]:
    """The names of all quantities, inputs first."""
    equations = model.equations
    released = {part.variable for part in equations.redundant}
    named = [x.name for x in (*equations.inputs, *equations.unknowns) if x.name not in released]
    named += [*equations.links, *equations.sliders, *equations.outputs]
    places = [f"{point}.{axis}" for point in equations.points for axis in "xy"]
    return [*dict.fromkeys(named), *places]


def quantity_found(model: Model, name: str) -> tuple[Kind, str, str]:
    """Kind and own spelling of what is named, and what it is; ``x``, ``y`` of points.

    Raises
    ------
    UnknownNameError
        With the names that exist.
    """
    equations = model.equations
    released = {part.variable for part in equations.redundant}
    kinds = {x.name: Kind(x.kind) for x in equations.variables if x.name not in released}
    outputs = {own: Kind(output.kind) for own, output in equations.outputs.items()}
    for what, table in (
        ("variable", kinds),
        ("link", dict.fromkeys(equations.links, Kind.ANGLE)),
        ("slider", dict.fromkeys(equations.sliders, Kind.LENGTH)),
        ("output", outputs),
    ):
        own = find_spelling(name, table)
        if own in table:
            return table[own], own, what
    point, _, axis = name.rpartition(".")
    point = find_spelling(point, equations.points)
    if point in equations.points and axis in ("x", "y"):
        return Kind.LENGTH, point, axis
    raise UnknownNameError(f'there is no "{name}" {choices("names", quantity_names(model), name)}')


def point_named(model: Model, name: str) -> str:
    """The own spelling of a point.

    Raises
    ------
    UnknownNameError
        With the points that exist.
    """
    points = model.equations.points
    own = find_spelling(name, points)
    if own not in points:
        raise UnknownNameError(f'there is no point "{name}" {choices("points", points, name)}')
    return own
