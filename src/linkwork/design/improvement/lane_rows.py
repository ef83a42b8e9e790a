"""Rows of many designs, each with its own numbers, unknowns and inputs.

F(v, u; p) = 0 holds in each row. Its loops are sums of terms, whose derivatives by variables and
coefficients are known; the other equations and all quantities are written on a tape.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Any, Self

import numpy as np

from linkwork.design.derivatives.differentiated_rows import DifferentiatedRows
from linkwork.design.derivatives.tape import Tape, TapedNumber
from linkwork.design.improvement.written_designs import WrittenDesigns
from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import AnyArray, Array

__all__ = ["LaneEquations", "LaneRows"]

_ZERO = np.zeros(())


class LaneRows(DifferentiatedRows):
    """Quantities of the rows of D designs, design by design.

    Parameters
    ----------
    designs : WrittenDesigns
    v : (B, N)
        Unknowns, then inputs, internal units; NaN where there is no position.
    slopes : (B, N, K)
        Their derivatives by parameters, of which the first P are the designs' numbers.
    """

    def __init__(self, designs: WrittenDesigns, v: Array, slopes: Array) -> None:
        self.tape, self.solution, self.order = Tape(len(v)), v, 0
        self.designs = designs
        self._given: dict[int, AnyArray] = {}
        self._rows_of: dict[int, Any] = {}
        self._shape = slopes.shape[2], len(v)
        self.taped = designs.writer.equations.mapped(self._spread)
        self._take_quantities(designs.writer.model, np.logical_not(np.isfinite(v).all(axis=1)))
        self.__dict__["speed"] = self._spread(designs.writer.speed)
        numbers = [self._number(v[:, k], slopes[:, k].T) for k in range(v.shape[1])]
        parts = zip(self._symbols, numbers, strict=True)
        self.__dict__["variables"] = {name: Jet(x, _ZERO, _ZERO) for name, x in parts}

    def _number(self, values: AnyArray, rates: AnyArray) -> Any:
        """A number on the tape of the rows."""
        found: Any = self.tape.number(values)
        self._given[found.node] = rates
        return found

    def _spread(self, number: Any) -> Any:
        """A number of the designs in their rows."""
        if not isinstance(number, TapedNumber):
            return number
        if number.node not in self._rows_of:
            value, rate = self.designs.known[number.node]
            each = self._shape[1] // len(value)
            rates = np.zeros(self._shape, dtype=rate.dtype)
            rates[: len(rate)] = np.repeat(rate, each, axis=1)
            self._rows_of[number.node] = self._number(np.repeat(value, each), rates)
        return self._rows_of[number.node]

    def slopes(self, results: Sequence[Any]) -> tuple[Array, Array]:
        """Real results (B, m), and their derivatives by the parameters, (B, m, K)."""
        rates = self.tape.forward(results, self._given)
        values = [np.broadcast_to(getattr(x, "values", x), self._shape[1]) for x in results]
        slopes = [np.broadcast_to(np.real(rate), self._shape) for rate in rates]
        return (
            np.array(values).reshape(len(results), self._shape[1]).T,
            np.array(slopes).reshape(len(results), *self._shape).transpose(2, 0, 1),
        )

    def further(self) -> tuple[Array, Array]:
        """All equations but loops, (B, m), and their derivatives by the parameters."""
        return self.slopes([row.v for row in self._further(self.variables)])

    def rated(self, inverse: Array, first: Array, order: int) -> Self:
        """The same rows with derivatives by the leading input, eq. (120).

        Parameters
        ----------
        inverse : (B, n, n)
            Of the Jacobians.
        first : (B, N)
            The derivatives of all variables by the leading input.
        order : int
            1 or 2.
        """
        second = np.zeros_like(first)
        if order > 1:
            parts = (self.solution, first, second)
            jets = [Jet(*(part[:, k] for part in parts)) for k in range(first.shape[1])]
            bent = [row.d2 for row in self._residuals(dict(zip(self._symbols, jets, strict=True)))]
            rows = [np.broadcast_to(getattr(x, "values", x), len(first)) for x in bent]
            # J q'' = -(all other terms of F'')
            right = np.array(rows).reshape(len(rows), len(first)).T
            second[:, : self.count] = -(inverse @ right[:, :, None])[:, :, 0]
        moved = copy(self)
        moved._points, moved.order = {}, order
        moved.__dict__.update(_inverse=inverse, _rates=(first, second))
        values = [self.variables[symbol].v for symbol in self._symbols]
        moved.__dict__["variables"] = moved._differentiated(values)
        return moved


class LaneEquations:
    """F(v, u; p) of D designs in N rows each.

    Parameters
    ----------
    designs : WrittenDesigns
    rows : int
        N.
    """

    def __init__(self, designs: WrittenDesigns, rows: int) -> None:
        self.designs, self.rows = designs, rows
        self.loops, coefficients = designs.writer.loops, designs.writer.coefficients
        own = np.tile(self.loops.coefficient, (len(designs.x), 1))
        self._by_numbers = np.zeros((*own.shape, designs.x.shape[1]), dtype=complex)
        for k, number in enumerate(coefficients):
            if isinstance(number, TapedNumber):
                own[:, k], rate = designs.known[number.node]
                self._by_numbers[:, k] = rate.T
        self._coefficients = np.repeat(own, rows, axis=0)

    @np.errstate(all="ignore")  # rows without a position are no numbers
    def at(self, v: Array) -> tuple[Array, Array]:
        """F (B, m) at variables (B, N), and by them, (B, m, N)."""
        value, slope = self.loops.value_and_jacobian(v, self._coefficients)
        further, slopes = self._further(v)
        return (
            np.concatenate([value.real, value.imag, further], axis=1),
            np.concatenate([slope.real, slope.imag, slopes[:, :, -v.shape[1] :]], axis=1),
        )

    @np.errstate(all="ignore")
    def by_numbers(self, v: Array) -> Array:
        """F by the numbers, (B, m, P)."""
        designs, terms, numbers = self._by_numbers.shape
        bare = self.loops.by_coefficients(v).reshape(designs, self.rows, terms)
        found = np.empty((len(v), self.loops.rows, numbers), dtype=complex)
        for row in range(self.loops.rows):
            own = self.loops.row == row
            found[:, row] = (bare[:, :, own] @ self._by_numbers[:, own]).reshape(len(v), numbers)
        _, slopes = self._further(v)
        return np.concatenate([found.real, found.imag, slopes[:, :, :numbers]], axis=1)

    def _further(self, v: Array) -> tuple[Array, Array]:
        """All equations but loops, by the numbers and by the variables."""
        numbers, variables = self._by_numbers.shape[2], v.shape[1]
        equations = self.designs.writer.equations
        if not (equations.linear or equations.real or equations.laws):
            return np.zeros((len(v), 0)), np.zeros((len(v), 0, numbers + variables))
        slopes = np.zeros((len(v), variables, numbers + variables))
        slopes[:, :, numbers:] = np.eye(variables)
        return LaneRows(self.designs, v, slopes).further()
