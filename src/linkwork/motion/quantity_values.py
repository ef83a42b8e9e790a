"""A mechanism's own quantities from its solved variables, as arrays of any one shape."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.expression.jets import Jet, evaluate
from linkwork.expression.tree import names_in
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.names import canonical
from linkwork.motion.model import Model
from linkwork.results import quantities
from linkwork.results.quantities.asked import Group
from linkwork.results.quantity import Kind

__all__ = ["LastAxis", "QuantityValues", "term_jet"]


class LastAxis:
    """Numbers that are asked for as the last axis of an array."""

    def __init__(self, numbers: Sequence[Any]) -> None:
        self.numbers = numbers

    def __getitem__(self, index: tuple[Any, int]) -> Any:
        return self.numbers[index[-1]]


class QuantityValues(ABC):
    """Quantities of the positions whose variables a subclass gives, shape S.

    Parameters
    ----------
    model : Model
    lost : S
        Where there is no position.
    still : S
        The rate of parts that do not move: 0, NaN where there is no position.
    link_constants : (…, links)
        Constants that links add to their variables [rad], in the order of the equations.
    dimensions : (…, dimensions)
        Named numbers in the order of the equations; leading axes as the last ones of S.
    """

    def __init__(
        self, model: Model, lost: BoolArray, still: Array, link_constants: Array, dimensions: Array
    ) -> None:
        self.model, self.equations, self.lost, self.still = model, model.equations, lost, still
        self.link_constants, self.dimensions = link_constants, dimensions
        self.names = {variable.name: variable for variable in self.equations.variables}

    @abstractmethod
    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units."""

    @abstractmethod
    def place(self, point: str) -> Jet:
        """A point by its exact name."""

    def own(self, name: str) -> Jet:
        """A quantity by its exact name: file units, derivatives in radians and lengths."""
        asked = self.model.motion_quantities.own[name]
        match asked.group:
            case Group.LINK:
                jet = self._link(name)
            case Group.SLIDER:
                jet = self.variable(canonical(self.equations.sliders[name]))
            case Group.OUTPUT:
                return self._output(name)
            case Group.COORDINATE:
                return self._coordinate(name)
            case _:
                jet = self.variable(self.names[name].symbol)
        return Jet(jet.v / self.model.units.scale(asked.own.kind), jet.d1, jet.d2)

    def _link(self, name: str) -> Jet:
        angle = self.equations.links[name]
        number = list(self.equations.links).index(name)
        blank = np.where(self.lost, np.nan, 0.0)
        constant = Jet(blank + self.link_constants[..., number], self.still, self.still)
        if angle.variable is None:
            return constant
        return self.variable(canonical(angle.variable)) + constant

    def _coordinate(self, name: str) -> Jet:
        point, _, axis = name.rpartition(".")
        place = self.place(point)
        parts = (place.v, place.d1, place.d2)
        return Jet(*(part.real if axis == "x" else part.imag for part in parts))

    def _output(self, name: str) -> Jet:
        """Formulas see and give file units; derivatives of angles come back in radians."""
        output = self.equations.outputs[name]
        scale = self.model.units.scale(Kind(output.kind))
        with np.errstate(all="ignore"):
            jet = evaluate(output.formula, self._known(name), self.equations.angle)
        v, d1, d2 = (
            np.where(self.lost, np.nan, np.broadcast_to(part, self.lost.shape))
            for part in (jet.v, jet.d1 * scale, jet.d2 * scale)
        )
        return Jet(v, d1, d2)

    def _known(self, name: str) -> Mapping[str, Jet]:
        """The values of an output's names: dimensions, variables, links, coordinates, …"""
        equations = self.equations
        used = {node.name for node in names_in(equations.outputs[name].formula)}
        zero = np.zeros(())
        found = {
            own: Jet(self.dimensions[..., k], zero, zero)
            for k, own in enumerate(equations.dimensions)
            if own in used
        }
        for variable in equations.variables:
            if variable.symbol in used:
                jet = self.variable(variable.symbol)
                found[variable.symbol] = self._in_file_units(jet, Kind(variable.kind))
        for link in equations.links:
            if canonical(link) in used and canonical(link) not in found:
                found[canonical(link)] = self._in_file_units(self._link(link), Kind.ANGLE)
        for point in equations.points:
            for axis in "xy":
                symbol = coordinate_name(point, axis)
                if symbol in used:
                    found[symbol] = self._coordinate(f"{point}.{axis}")
        for symbol in used - set(found):
            if quantities.row_quantity(symbol) is not None:
                asked = self.model.quantities.find(symbol)
                jet, scale = asked.jet(self), self.model.units.scale(asked.own.kind)
                found[symbol] = Jet(jet.v, jet.d1 / scale, jet.d2 / scale)
        return found

    def _in_file_units(self, jet: Jet, kind: Kind) -> Jet:
        scale = 1.0 / self.model.units.scale(kind)
        return Jet(jet.v * scale, jet.d1 * scale, jet.d2 * scale)


def term_jet(c: Any, length: Jet, turn: Jet | None) -> Jet:
    """c s e^{iψ} with both derivatives, for numbers of any kind.

    Parameters
    ----------
    c : complex
    length : Jet
        s, or the constant 1.
    turn : Jet, optional
        ψ; ``None`` for a fixed direction.
    """
    angle = Jet.constant(0.0) if turn is None else turn
    if turn is not None:
        c = c * (np.cos(angle.v) + 1j * np.sin(angle.v))  # eq. (1)
    first = length.d1 + 1j * (length.v * angle.d1)  # derivative of eq. (1)
    # eq. (3) with a = b
    second = length.d2 - length.v * (angle.d1 * angle.d1)
    second = second + 1j * (2.0 * (length.d1 * angle.d1) + length.v * angle.d2)
    return Jet(c * length.v, c * first, c * second)
