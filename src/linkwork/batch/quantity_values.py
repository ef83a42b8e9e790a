"""Named quantities of many designs over many rows, from their variables."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.equations.compiling import coordinate_name
from linkwork.expression.jets import Jet, evaluate
from linkwork.expression.tree import names_in
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.errors import UnknownNameError, choices
from linkwork.foundation.names import canonical, spelled
from linkwork.results.quantity import Kind

__all__ = ["QuantityValues"]


class QuantityValues:
    """Reads quantities off the variables of D designs over R rows.

    Parameters
    ----------
    designs : Designs
    inputs : (R, p)
        As asked, everyday units.
    v : (n, R, D)
        Unknowns, internal units; NaN where there is no position.
    """

    def __init__(self, designs: Designs, inputs: Array, v: Array) -> None:
        self.designs, self.inputs, self.v = designs, inputs, v
        self.model = designs.base
        self.equations = designs.base.equations
        self._number = {x.symbol: k for k, x in enumerate(self.equations.variables)}
        self._lost = np.isnan(v).any(axis=0) if len(v) else np.zeros(v.shape[1:], dtype=bool)

    def names(self) -> list[str]:
        """All names that :meth:`of` knows."""
        equations = self.equations
        named = [x.name for x in (*equations.inputs, *equations.unknowns)]
        named += [*equations.links, *equations.sliders, *equations.outputs]
        places = [f"{point}.{axis}" for point in equations.points for axis in "xy"]
        return [*dict.fromkeys(named), *places]

    def of(self, name: str) -> Array:
        """A quantity by name, (D, R), everyday units.

        Raises
        ------
        UnknownNameError
            With the names that exist.
        """
        kind, own, what = self._found(name)
        match what:
            case "input":
                k = [x.name for x in self.equations.inputs].index(own)
                return np.broadcast_to(self.inputs[:, k], (len(self.designs), len(self.inputs)))
            case "unknown":
                symbol = {x.name: x.symbol for x in self.equations.unknowns}[own]
                return self._shown(self._variable(symbol), kind)
            case "link":
                return self._shown(self._link(own), kind)
            case "slider":
                return self._shown(self._slider(own), kind)
            case "output":
                return self._output(own).T
            case axis:
                place = self._point(own)
                coordinates: Array = place.real.T if axis == "x" else place.imag.T
                return coordinates

    def unit(self, name: str) -> str:
        """The everyday unit of a quantity, "" for none."""
        return self.model.units.of(self._found(name)[0])

    def _found(self, name: str) -> tuple[Kind, str, str]:
        """Kind and own spelling of what is named, and where it stands; ``x``, ``y`` of points."""
        equations = self.equations
        variables = (("input", equations.inputs), ("unknown", equations.unknowns))
        for what, several in variables:
            kinds = {x.name: Kind(x.kind) for x in several}
            own = spelled(name, kinds)
            if own in kinds:
                return kinds[own], own, what
        outputs = {own: Kind(output.kind) for own, output in equations.outputs.items()}
        for what, table in (
            ("link", dict.fromkeys(equations.links, Kind.ANGLE)),
            ("slider", dict.fromkeys(equations.sliders, Kind.LENGTH)),
            ("output", outputs),
        ):
            own = spelled(name, table)
            if own in table:
                return table[own], own, what
        point, _, axis = name.rpartition(".")
        point = spelled(point, equations.points)
        if point in equations.points and axis in ("x", "y"):
            return Kind.LENGTH, point, axis
        raise UnknownNameError(f'there is no "{name}" {choices("names", self.names(), name)}')

    def trace(self, point: str) -> ComplexArray:
        """Positions of a point as x + iy, (D, R)."""
        own = spelled(point, self.equations.points)
        if own not in self.equations.points:
            raise UnknownNameError(
                f'there is no point "{point}" {choices("points", self.equations.points, point)}'
            )
        places: ComplexArray = self._point(own).T
        return places

    def _shown(self, value: Array, kind: Kind) -> Array:
        shown: Array = value.T / self.model.units.scale(kind)
        return shown

    def _variable(self, symbol: str) -> Array:
        """A variable by symbol, (R, D), internal units."""
        k = self._number[symbol]
        unknowns = len(self.equations.unknowns)
        if k < unknowns:
            own: Array = self.v[k]
            return own
        column = self.inputs[:, k - unknowns] * self.model.input_scale[k - unknowns]
        found: Array = np.where(self._lost, np.nan, column[:, None])
        return found

    def _link(self, name: str) -> Array:
        number = list(self.equations.links).index(name)
        constant = self.designs.link_angles[:, number]
        variable = self.equations.links[name].variable
        if variable is None:
            return np.where(self._lost, np.nan, constant)
        return self._variable(canonical(variable)) + constant

    def _slider(self, name: str) -> Array:
        return self._variable(canonical(self.equations.sliders[name]))

    def _point(self, name: str) -> ComplexArray:
        """(R, D)."""
        table = self.model.compiled.points
        number = {own: k for k, own in enumerate(table.names)}
        parent = self.equations.points[name].parent
        place: ComplexArray = np.where(self._lost, complex(np.nan, np.nan), 0j)
        for term in np.flatnonzero(table.rows.row == number[name]):
            place = place + self._term(int(term))
        return place if parent is None else place + self._point(parent)

    def _term(self, term: int) -> ComplexArray:
        rows = self.model.compiled.points.rows
        symbols = [x.symbol for x in self.equations.variables]
        value: ComplexArray = self.designs.points[:, term][None, :]
        mine = rows.phase_term == term
        phase: Array | float = 0.0
        for k, weight in zip(rows.phase_variable[mine], rows.phase_weight[mine], strict=True):
            phase = phase + weight * self._variable(symbols[k])
        if mine.any():
            value = value * np.exp(1j * np.asarray(phase))
        length = int(rows.length[term])
        return value if length < 0 else value * self._variable(symbols[length])

    def _output(self, name: str) -> Array:
        """(R, D)."""
        output = self.equations.outputs[name]
        known = self._known(name)
        with np.errstate(all="ignore"):
            value = evaluate(output.formula, known, self.equations.angle).v
        found: Array = np.where(self._lost, np.nan, np.broadcast_to(value, self._lost.shape))
        return found

    def _known(self, name: str) -> Mapping[str, Jet]:
        """What the formula of an output needs: dimensions, variables, links, coordinates."""
        equations = self.equations
        used = {node.name for node in names_in(equations.outputs[name].formula)}
        columns = dict(zip(equations.dimensions, self.designs.numbers.T, strict=True))
        found = {symbol: values for symbol, values in columns.items() if symbol in used}
        scale = self.model.units.scale
        for variable in equations.variables:
            if variable.symbol in used:
                own = self._variable(variable.symbol)
                found[variable.symbol] = own / scale(Kind(variable.kind))
        for link in equations.links:
            if canonical(link) in used and canonical(link) not in found:
                found[canonical(link)] = self._link(link) / scale(Kind.ANGLE)
        for point in equations.points:
            for axis in "xy":
                symbol = coordinate_name(point, axis)
                if symbol in used:
                    place = self._point(point)
                    found[symbol] = place.real if axis == "x" else place.imag
        zero = np.zeros(())
        return {symbol: Jet(values, zero, zero) for symbol, values in found.items()}
