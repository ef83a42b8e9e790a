"""The sheet of rates by each of several inputs alone, for their virtual work."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.equations.model import Variable
from linkwork.export.formulas.cell_formula import CellFormula
from linkwork.export.formulas.rate_formulas import rate_key
from linkwork.export.workbook.book import FIRST, NEWTON, Book, column_name
from linkwork.export.workbook.newton_page import NewtonColumns, correction
from linkwork.export.workbook.page_layout import print_table
from linkwork.export.workbook.velocity_page import rates_of_block
from linkwork.expression.tree import Name
from linkwork.foundation.names import canonical

__all__ = ["PARTIALS", "partial_key", "write_partials"]

PARTIALS = "Partials"
_WIDTH = 14


def partial_key(key: str, which: Variable) -> str:
    """The key of a rate by one input alone; ``key`` is that of the rate by all inputs."""
    return f"{key} by {which.symbol}"


def write_partials(book: Book, sheet: Any, newton: NewtonColumns) -> None:
    """Write the rates of all rows by every input."""
    _Page(book, sheet, newton).write()


@dataclass
class _Page:
    book: Book
    sheet: Any
    newton: NewtonColumns
    end: int = 1
    groups: list[tuple[str, int, int]] = field(default_factory=list)

    def write(self) -> None:
        """Write the rates, input by input."""
        book, sheet = self.book, self.sheet
        inputs = book.model.equations.inputs
        book.title(sheet, "rates by each input alone")
        note = "As on the sheet Velocities, with a speed of 1 of one input while the others rest."
        sheet.write(1, 0, note, book.style["note"])
        book.row_numbers(sheet)
        for variable in inputs:
            book.head(sheet, self.end, book.shown(variable), book.unit(variable.kind))
            book.column(sheet, self.end, CellFormula(Name(variable.symbol)), "number")
            self.end += 1
        self.groups.append(("Input", 1, self.end - 1))
        for variable in inputs:
            self._rates(variable)
        book.group_heads(sheet, self.groups)
        print_table(sheet, [6, *[_WIDTH] * (self.end - 1)], 1 + len(inputs), book.last - 1)
        sheet.freeze_panes(FIRST, 1 + len(inputs))

    def _rates(self, which: Variable) -> None:
        """The rates of unknowns, links and points by one input."""
        book = self.book
        # by what the formulas of velocities call the rates by all inputs
        cells: dict[str, str] = {}
        values: dict[str, Any] = {}
        shown, begin = book.shown(which), self.end
        for variable in book.model.equations.inputs:
            rate = np.full(book.count, float(variable is which))
            self._named(variable.symbol, book.shown(variable), which, cells, values, rate, [])
        self._group(f"Rates by {shown}", begin)
        for b, block in enumerate(book.closure.blocks):
            first = self.end
            formulas = [pair[0] for pair in book.rates.sides[b]]
            for row, formula in zip(block.rows, formulas, strict=True):
                book.head(self.sheet, self.end, row.name, "")
                self._column(formula, cells, values)
            self._group(f"Right sides by {shown}", first)
            found = rates_of_block(
                book, b, [formula.value({**book.values, **values}) for formula in formulas]
            )
            begin = self.end
            for c, k in enumerate(block.unknowns):
                variable = book.model.equations.unknowns[k]
                texts = [
                    "=" + correction(
                        self.newton.last_jacobian[b], first, len(block.rows), c, FIRST + row + 1,
                        f"{NEWTON}!",
                    )
                    for row in range(book.count)
                ]  # fmt: skip
                self._named(
                    variable.symbol, book.shown(variable), which, cells, values, found[:, c], texts
                )
            self._group(f"Rates by {shown}", begin)
        begin = self.end
        for key, name in self._others():
            formula = book.rates.of[key][0]
            column = np.array(book.over_rows(formula.value({**book.values, **values})))
            texts = [book.text(formula, **cells)] * book.count
            self._named(key, name, which, cells, values, column, texts)
        self._group(f"Rates by {shown}", begin)

    def _others(self) -> Iterator[tuple[str, str]]:
        """Key and shown name of all links and points that move."""
        rates = self.book.rates.of
        for link in self.book.closure.links:
            if canonical(link) in rates:
                yield canonical(link), link
        for point in self.book.closure.points:
            for axis in "xy":
                if coordinate_name(point, axis) in rates:
                    yield coordinate_name(point, axis), f"{point}.{axis}"

    def _column(self, formula: CellFormula, cells: dict[str, str], values: dict[str, Any]) -> None:
        book = self.book
        column = book.over_rows(formula.value({**book.values, **values}))
        for row, value in enumerate(column.tolist()):
            book.put(self.sheet, row, self.end, book.text(formula, **cells), "number", value)
        self.end += 1

    def _named(
        self, quantity: str, shown: str, which: Variable, cells: dict[str, str],
        values: dict[str, Any], column: Any, texts: list[str],
    ) -> None:  # fmt: skip
        """A rate with a name: formulas of this input's rates use it for the rate by all inputs.

        Without texts it is constant.
        """
        book, own = self.book, rate_key(quantity, 1)
        key = partial_key(own, which)
        name = book.names.claim(key, f"{book.names.cells[quantity].rstrip('_')}.by.{which.shown}")
        book.define(key, PARTIALS, f"${column_name(self.end)}1")
        book.head(self.sheet, self.end, shown, "")
        for row, value in enumerate(column.tolist()):
            if texts:
                book.put(self.sheet, row, self.end, texts[row], "number", value)
            else:
                self.sheet.write_number(FIRST + row, self.end, value, book.style["number"])
        cells[own], values[own], book.values[key] = name, column, column
        self.end += 1

    def _group(self, title: str, first: int) -> None:
        """A group of the columns since the first one, joined to one of the same title before it."""
        if first == self.end:
            return
        if self.groups[-1][0] == title:
            first = self.groups.pop()[1]
        self.groups.append((title, first, self.end - 1))
