"""The sheet of velocities and accelerations, solved with the Jacobian of the last iteration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import Node, NumberNode
from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.numerics.newton import corrections
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.formulas.closure_formulas import value_of
from linkwork.writers.formulas.rate_formulas import rate_key
from linkwork.writers.workbook.book import FIRST, LINKWORK, NEWTON, VELOCITIES, Book, column_name
from linkwork.writers.workbook.layout import Table
from linkwork.writers.workbook.newton_page import NewtonColumns, correction

PARTIALS = "Partials"


def partial_key(key: str, which: Variable) -> str:
    """The key of a rate by one input alone; ``key`` is that of the rate by all inputs."""
    return f"{key} by {which.symbol}"


def write_velocities(book: Book, sheet: Any, newton: NewtonColumns) -> None:
    """Write velocities and accelerations of all rows."""
    table = Table(book, VELOCITIES, sheet)
    table.inputs()
    for order in (1, 2):
        _Rates(table, newton, order).write()
    lead = book.shown(book.leading)
    note = (
        f"J q\u0307 = -∂F/∂{lead} · speed, and the same once more for the accelerations. J is that "
        f"of the last iteration; the speed of {lead} is on the sheet Dimensions."
    )
    table.finish("velocities and accelerations", note, 1 + len(book.model.equations.inputs))


def write_partials(book: Book, sheet: Any, newton: NewtonColumns) -> None:
    """Write the rates of all rows by each of several inputs alone, for their virtual work."""
    table, inputs = Table(book, PARTIALS, sheet), book.model.equations.inputs
    table.inputs()
    for variable in inputs:
        _Rates(table, newton, 1, variable).write()
    note = "As on the sheet Velocities, with a speed of 1 of one input while all others rest."
    table.finish("rates by each input alone", note, 1 + len(inputs))


@dataclass
class _Rates:
    """The rates of one order, ``by`` one input alone or by all.

    ``names`` are the keys of rates by one input that formulas use for those by all.
    """

    table: Table
    newton: NewtonColumns
    order: int
    by: Variable | None = None
    names: dict[str, str] = field(default_factory=dict)

    def write(self) -> None:
        """Write right-hand sides and rates of the blocks, then those of other quantities."""
        book, table, equations = self.table.book, self.table, self.table.book.model.equations
        word = ("velocity", "acceleration")[self.order - 1]
        rates, sides_of = ("Velocities", "Accelerations")[self.order - 1], f"of {word}"
        if self.by is not None:
            rates, sides_of = f"Rates by {book.shown(self.by)}", f"by {book.shown(self.by)}"
            table.group = rates
            for variable in equations.inputs:
                value = NumberNode(float(variable is self.by))
                self._formula(variable.symbol, book.shown(variable), Kind(variable.kind), value)
        for b, block in enumerate(book.closure.blocks):
            table.group, first = f"Right sides {sides_of}", table.end
            sides = [
                table.formula(row.name, "", pair[self.order - 1], names=self.names)
                for row, pair in zip(block.rows, book.rates.sides[b], strict=False)
            ]
            solved, table.group = self._solved(b, sides), rates
            for c, k in enumerate(block.unknowns):
                variable, values = equations.unknowns[k], solved[:, c]
                shown, kind = book.shown(variable), Kind(variable.kind)
                column = table.add(shown, self._unit(kind), self._key(variable.symbol))
                book.values[self._key(variable.symbol)] = values
                text = self._text(b, c, first, variable)
                table.cells(column, text, values, "number" if sides else "value")
        table.group = rates
        for quantity in book.closure.quantities:
            formulas = book.rates.of.get(quantity.key)
            if formulas and (self.by is None or quantity.of != "output"):
                formula = formulas[self.order - 1]
                self._formula(quantity.key, quantity.shown, quantity.kind, formula)

    def _unit(self, kind: Kind) -> str:
        rate = Rate.VELOCITY if self.order == 1 else Rate.ACCELERATION
        return rate.unit(kind, self.table.book.model.units, "") if self.by is None else ""

    def _key(self, quantity: str) -> str:
        """The key of a rate; of one by one input, formulas use it for the rate by all inputs."""
        book, key = self.table.book, rate_key(quantity, self.order)
        if self.by is None:
            return key
        partial = self.names[key] = partial_key(key, self.by)
        if partial not in book.names.of:
            stem = book.names.of[quantity].rstrip("_")
            book.names.claim(partial, f"{stem}.by.{self.by.shown}")
        return partial

    def _formula(self, quantity: str, shown: str, kind: Kind, formula: Node) -> None:
        names = dict(self.names)
        key = self._key(quantity)
        self.table.formula(shown, self._unit(kind), formula, key=key, names=names)

    def _solved(self, b: int, sides: Sequence[Any]) -> AnyArray:
        """The values of a block's rates, (R, n); those of Linkwork where cells do not solve."""
        book, block = self.table.book, self.table.book.closure.blocks[b]
        if self.by is not None:
            return _rates_of_block(book, b, sides)
        rates = np.full((book.count, len(block.unknowns)), np.nan)
        for c, k in enumerate(block.unknowns):
            series = book.motion.unknowns.get(book.model.equations.unknowns[k].name)
            if series is not None:
                derivative = series.first if self.order == 1 else series.second
                rates[:, c] = derivative[book.iterations.rows] * book.speed**self.order
        live = book.iterations.live
        if sides and live.any():
            rates[live] = _rates_of_block(book, b, sides)[live]
        return rates

    def _text(self, b: int, c: int, side: int, variable: Variable) -> Callable[[int], str]:
        """The formulas of an unknown's rate; ``side`` is the first column of right-hand sides."""
        book, newton = self.table.book, self.newton
        block, done = book.closure.blocks[b], book.iterations
        speed = book.names.of[rate_key(book.leading.symbol, 1)]
        power = "" if self.order == 1 else "^2"
        source = book.linkwork_columns.get(f"{variable.name}.d{self.order}", 0)

        def text(row: int) -> str:
            if book.rates.sides[b]:
                jacobian, place = newton.last_jacobian[b], FIRST + row + 1
                solved = correction(jacobian, side, len(block.rows), c, place, f"{NEWTON}!")
                if self.by is not None or done.live[row]:
                    return f"={solved}"
            else:
                solved = "NA()"
            known = "NA()"
            if done.found[row] and variable.name in book.motion.unknowns:
                place = int(done.rows[row]) + FIRST + 1
                known = f"{LINKWORK}!{column_name(source)}{place}*{speed}{power}"
            return f'=IF(as_solved="yes",{known},{solved})'

        return text


def _rates_of_block(book: Book, b: int, sides: Sequence[Any]) -> AnyArray:
    """The rates of a block's unknowns by its right-hand sides, (R, n); NaN where no cells solve."""
    block, live, before = book.closure.blocks[b], book.iterations.live, dict(book.values)
    for k in block.unknowns:  # of the last iteration's Jacobian
        symbol = book.model.equations.unknowns[k].symbol
        before[symbol] = book.iterations.values[-2][:, k]
    slopes = [[book.over_rows(value_of(part, before)) for part in row.slopes] for row in block.rows]
    rates = np.full((book.count, len(block.unknowns)), np.nan)
    if live.any():
        jacobian = np.moveaxis(np.array(slopes), 2, 0)
        rates[live], _ = corrections(jacobian[live], np.stack(sides, axis=1)[live])
    return rates
