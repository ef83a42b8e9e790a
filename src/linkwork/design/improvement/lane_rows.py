"""Rows of many designs on one tape, each with its own numbers, unknowns and inputs.

F(v, u; p) = 0 holds in each row; its derivatives by the unknowns v, the inputs u and the numbers p
come from one tape, and those of a quantity g(v, u; p) by the implicit function theorem, eq. (156).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.batch.building import write_equations
from linkwork.design.differentiated_rows import DifferentiatedRows
from linkwork.design.tape import Tape
from linkwork.expression.jets import Jet
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.mechanism.varied_number import VariedNumber, with_numbers
from linkwork.motion.model import Model
from linkwork.motion.quantity_values import QuantityValues

__all__ = ["LaneRows", "RatedRows", "WrittenDesigns"]

_ZERO = np.zeros(())


class _Column:
    """Numbers that are asked for as the last axis of an array."""

    def __init__(self, numbers: Sequence[Any]) -> None:
        self.numbers = numbers

    def __getitem__(self, index: tuple[Any, int]) -> Any:
        return self.numbers[index[-1]]


class WrittenDesigns:
    """The equations of B rows with numbers of their own.

    Parameters
    ----------
    model : Model
    numbers : sequence of VariedNumber
    values : (B, P)
        File units.

    Attributes
    ----------
    fine : (B,) bool
        Rows whose equations have the form of the mechanism's own.
    """

    def __init__(self, model: Model, numbers: Sequence[VariedNumber], values: Array) -> None:
        self.model, self.tape = model, Tape(1 + len(values))
        # the mechanism itself leads: its equations can be written, whatever the other rows hold
        own = [float(q.of(model.description)) for q in numbers]
        taped = {
            q: self.tape.number(np.append(own[k], values[:, k])) for k, q in enumerate(numbers)
        }
        self.numbers = list(self.tape.inputs)
        self.tape.writing = True
        with np.errstate(all="ignore"):
            self.description = with_numbers(model.description, taped)
            self.taped = write_equations(self.description)
        agreeing: BoolArray = self.tape.agreeing & ~self.tape.apart
        self.fine = agreeing[1:]
        self.tape.writing = False


class LaneRows(DifferentiatedRows):
    """Quantities of B rows on the tape of their designs.

    Parameters
    ----------
    written : WrittenDesigns
    v : (B, N)
        Unknowns, then inputs, internal units; NaN where there is no position.
    """

    def __init__(self, written: WrittenDesigns, v: Array) -> None:
        model, self.tape = written.model, written.tape
        self.description, self.taped = written.description, written.taped
        # the row of the mechanism itself, which has no position here, leads
        led = _led(v)
        lost: BoolArray = np.logical_not(np.isfinite(led).all(axis=1))
        links: Any = _Column([angle.constant for angle in self.taped.links.values()])
        dimensions: Any = _Column(list(self.taped.dimensions.values()))
        QuantityValues.__init__(self, model, lost, np.where(lost, np.nan, 0.0), links, dimensions)
        self.count, self.order = len(self.equations.unknowns), 0
        self.solution = v
        self._symbols = [x.symbol for x in self.equations.variables]
        self._points: dict[str, Jet] = {}
        first = len(self.tape.inputs)
        columns: list[Any] = [self.tape.number(led[:, k]) for k in range(v.shape[1])]
        #: Nodes of the variables on the tape.
        self.nodes = self.tape.inputs[first:]
        del self.tape.inputs[first:]
        parts = zip(self._symbols, columns, strict=True)
        self.__dict__["variables"] = {name: Jet(x, _ZERO, _ZERO) for name, x in parts}

    def equations_and_slopes(self, by: Sequence[int]) -> tuple[Array, Array]:
        """F (B, m), and its derivatives by inputs of the tape, (B, m, len(by))."""
        with np.errstate(all="ignore"):
            return self.slopes([row.v for row in self._residuals(self.variables)], by)

    def slopes(self, results: Sequence[Any], by: Sequence[int]) -> tuple[Array, Array]:
        """Real results (B, m), and their derivatives by inputs of the tape, (B, m, len(by))."""
        return self._slopes(results, by, 1 + len(self.solution))

    def _slopes(self, results: Sequence[Any], by: Sequence[int], rows: int) -> tuple[Array, Array]:
        kept, self.tape.inputs = self.tape.inputs, list(by)
        rates = self.tape.forward(results)
        self.tape.inputs = kept
        values = [np.broadcast_to(getattr(x, "values", x), rows) for x in results]
        slopes = [np.broadcast_to(np.real(rate), (len(by), rows)) for rate in rates]
        return (
            np.stack(values, axis=1)[1:],
            np.stack(slopes, axis=0).transpose(2, 0, 1)[1:],
        )


class RatedRows(LaneRows):
    """Solved rows whose derivatives by the leading input are on the tape too, eq. (120).

    Parameters
    ----------
    rows : LaneRows
    numbers : sequence of int
        Nodes of the numbers.
    inverse : (B, n, n)
        Of the Jacobians.
    first : (B, N)
        The derivatives of all variables by the leading input.
    order : int
        1 or 2.
    """

    def __init__(
        self, rows: LaneRows, numbers: Sequence[int], inverse: Array, first: Array, order: int
    ) -> None:
        self.__dict__.update(rows.__dict__)
        del self.__dict__["variables"]
        self.__dict__.pop("speed", None)
        self._points, self.order = {}, order
        self.solution, self._inverse = _led(rows.solution), _led(inverse)
        self.__dict__["_rates"] = self._led_rates(first)

    def _led_rates(self, first: Array) -> tuple[Array, Array]:
        """First and second derivatives of the variables, the latter only if asked for."""
        rates, second = _led(first), np.zeros_like(_led(first))
        if self.order > 1:
            parts = (self.solution, rates, second)
            jets = [Jet(*(part[:, k] for part in parts)) for k in range(rates.shape[1])]
            bent = [row.d2 for row in self._residuals(dict(zip(self._symbols, jets, strict=True)))]
            rows = [np.broadcast_to(getattr(x, "values", x), len(rates)) for x in bent]
            # J q'' = -(all other terms of F'')
            solved = self._inverse @ np.stack(rows, axis=1)[:, :, None]
            second[:, : self.count] = -solved[:, :, 0]
        return rates, second

    @cached_property
    def variables(self) -> dict[str, Jet]:
        """All variables by symbol, see :class:`DifferentiatedRows`."""
        return self._differentiated()

    def slopes(self, results: Sequence[Any], by: Sequence[int]) -> tuple[Array, Array]:
        """As of :class:`LaneRows`."""
        return self._slopes(results, by, len(self.solution))


def _led(values: Array) -> Array:
    """Values with a row of the mechanism itself, which has none, before them."""
    return np.concatenate([np.full((1, *values.shape[1:]), np.nan), values])
