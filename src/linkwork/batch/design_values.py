"""The quantities of many designs over many rows, from their variables."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.batch.rates import DesignRates
from linkwork.expression.jets import Jet
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, TurnArray
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.motion.quantity_values import QuantityValues

__all__ = ["DesignValues"]


_NONE = np.zeros(())  # rates of a quantity whose value only is requested


class DesignValues(QuantityValues):
    """Computes quantities from the variables of D designs over R rows, (R, D) each.

    Parameters
    ----------
    designs : Designs
    inputs : (R, p) or (R, p, D)
        Requested inputs, file units.
    v : (n, R, D)
        Unknowns, internal units; NaN where there is no position.
    turns : (R, D)
        Whole turns from the requested to the actual first input of a position.
    rates : DesignRates, optional
        If omitted, only values are available.
    """

    def __init__(
        self,
        designs: Designs,
        inputs: Array,
        v: Array,
        turns: TurnArray,
        rates: DesignRates | None = None,
    ) -> None:
        lost: BoolArray = np.zeros(v.shape[1:], dtype=bool)
        lost |= np.isnan(v).any(axis=0)
        still = _NONE if rates is None else np.where(lost, np.nan, 0.0)
        super().__init__(designs.base, lost, still, designs.link_angles, designs.numbers)
        self.designs, self.inputs, self.v, self.turns = designs, inputs, v, turns
        self.rates = rates
        self.number = {x.symbol: k for k, x in enumerate(self.equations.variables)}

    @cached_property
    def _blanks(self) -> tuple[Array, Array]:
        """0, or NaN where a variable has no first or second derivative, (R, D)."""
        if self.rates is None:
            return _NONE, _NONE
        first = np.isnan(self.rates.first).any(axis=0) | self.lost
        second = np.isnan(self.rates.second).any(axis=0) | first
        return np.where(first, np.nan, 0.0), np.where(second, np.nan, 0.0)

    def variable(self, symbol: str) -> Jet:
        """A variable by its symbol, internal units."""
        k = self.number[symbol]
        n, rates = len(self.equations.unknowns), self.rates
        if k < n:
            if rates is None:
                return Jet(self.v[k], _NONE, _NONE)
            return Jet(self.v[k], rates.first[k], rates.second[k])
        column = self.inputs[:, k - n] * self.model.input_scale[k - n]
        value = np.where(self.lost, np.nan, column if column.ndim > 1 else column[:, None])
        # a row found whole turns away has other outputs, where angles enter without a sine
        if k == n and self.turns.any():
            value = value + self.turns * FULL_TURN
        if rates is None:
            return Jet(value, _NONE, _NONE)
        rate = leading_input(self.model.rows)[1][k - n]
        first, second = (
            np.where(self.lost | ~driven, np.nan, own)
            for driven, own in zip(rates.driven, (rate, 0.0), strict=True)
        )
        return Jet(value, first, second)

    def apart(self) -> Iterator[DesignColumn | None]:
        """Every design by itself, (R,), with a model of its own numbers; ``None`` without rows."""
        for k in range(len(self.designs)):
            if self.lost[:, k].all():
                yield None
                continue
            if len(self.equations.inputs) > 1:  # partial derivatives need its own equations
                yield DesignColumn(self, self.designs.design(k), k)
            else:
                description = self.designs.description(k)
                yield DesignColumn(self, replace(self.model, description=description), k)

    def place(self, point: str) -> Jet:
        """A point by its exact name: its parent's position plus its own terms."""
        table = self.model.compiled.points
        number = {own: k for k, own in enumerate(table.names)}
        parent = self.equations.points[point].parent
        if parent is None:
            blanks = (np.where(self.lost, np.nan, 0.0), *self._blanks)
            place = Jet(*(_as_complex(blank) for blank in blanks))
        else:
            place = self.place(parent)
        for term in np.flatnonzero(table.rows.row == number[point]):
            place = place + self._term(int(term))
        return place

    def _term(self, term: int) -> Jet:
        """c s e^{iψ} with both derivatives."""
        rows = self.model.compiled.points.rows
        symbols = [x.symbol for x in self.equations.variables]
        value: ComplexArray = self.designs.points[:, term][None, :]
        mine = rows.phase_term == term
        turn = Jet.constant(0.0)
        for k, weight in zip(rows.phase_variable[mine], rows.phase_weight[mine], strict=True):
            angle = self.variable(symbols[k])
            turn = turn + Jet(weight * angle.v, weight * angle.d1, weight * angle.d2)
        if mine.any():
            value = value * np.exp(1j * np.asarray(turn.v))
        length = int(rows.length[term])
        if self.rates is None:
            value = value if length < 0 else value * self.variable(symbols[length]).v
            return Jet(value, _NONE, _NONE)
        s = Jet.constant(1.0) if length < 0 else self.variable(symbols[length])
        first = value * (s.d1 + 1j * s.v * turn.d1)  # derivative of eq. (1)
        # eq. (3) with a = b
        second = s.d2 - s.v * turn.d1**2 + 1j * (2.0 * s.d1 * turn.d1 + s.v * turn.d2)
        return Jet(value * s.v, first, value * second)


@dataclass(frozen=True, eq=False)
class DesignColumn:
    """The values of one design, (R,)."""

    values: DesignValues
    model: Model
    number: int

    def own(self, name: str) -> Jet:
        """A variable or output by its exact name."""
        return self._column(self.values.own(name))

    def place(self, point: str) -> Jet:
        """A point by its exact name."""
        return self._column(self.values.place(point))

    def _column(self, jet: Jet) -> Jet:
        shape = self.values.lost.shape
        parts = (np.broadcast_to(part, shape)[:, self.number] for part in (jet.v, jet.d1, jet.d2))
        return Jet(*parts)


def _as_complex(blank: Array) -> ComplexArray:
    """0, or NaN in both parts."""
    both: ComplexArray = np.asarray(blank * (1.0 + 1.0j), dtype=complex)
    return both
