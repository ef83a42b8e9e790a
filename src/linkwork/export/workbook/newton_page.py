"""The sheet of the Newton-Raphson iterations, from left to right."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.equations.model import Variable
from linkwork.export.workbook.book import CYCLE, FIRST, NEWTON, Book, apart, cached, column_name
from linkwork.export.workbook.closure_formulas import BlockFormulas

__all__ = ["NewtonColumns", "planned_newton", "write_newton"]


@dataclass
class NewtonColumns:
    """Columns of one block after the other.

    ``x[k, i]``: unknown i after k iterations; ``last[i]`` its last one. ``start[b, k]``: first
    column of iteration k of block b, where the equations stand.
    """

    x: dict[tuple[int, int], int] = field(default_factory=dict)
    last: dict[int, int] = field(default_factory=dict)
    start: dict[tuple[int, int], int] = field(default_factory=dict)
    end: int = 0


def planned_newton(book: Book) -> NewtonColumns:
    """Number the columns and name every iterate: ``theta14_0``, ``theta14_1``, …"""
    found, place = NewtonColumns(), 1
    count = book.iterations.count
    for b, block in enumerate(book.closure.blocks):
        if not block.rows:
            continue
        n = len(block.unknowns)
        for k in range(count + 1):
            if k:
                found.start[b, k - 1] = place
                place += 2 * n + n * n
            for i in block.unknowns:
                found.x[k, i] = place
                variable = book.model.equations.unknowns[i]
                key = f"iterate {k} {variable.symbol}"
                book.names.claim(key, f"{variable.shown}_{k}")
                book.define(key, NEWTON, f"${column_name(place)}1")
                place += 1
        found.last |= {i: found.x[count, i] for i in block.unknowns}
    found.end = place
    return found


def write_newton(book: Book, sheet: Any, columns: NewtonColumns, cycle: dict[str, int]) -> None:
    """Write all iterations of all rows; ``cycle`` numbers the columns of the positions."""
    style = book.style
    sheet.set_column(0, 0, 6)
    sheet.set_column(1, max(columns.end, 1), 11)
    name = book.model.description.name
    sheet.write(0, 0, f"{name}: Newton-Raphson", style["title"])
    sheet.write(
        1, 0, "J δ = -F, x + δ; every row starts from the row above. δ of angles is in radians.",
        style["note"],
    )  # fmt: skip
    book.head(sheet, 0, "row", "")
    for k in range(book.count):
        sheet.write_number(FIRST + k, 0, k + 1, style["count"])
    for b, block in enumerate(book.closure.blocks):
        if block.rows:
            _Block(book, sheet, columns, b, block, cycle).write()
    sheet.freeze_panes(FIRST, 1)


@dataclass
class _Block:
    book: Book
    sheet: Any
    columns: NewtonColumns
    number: int
    block: BlockFormulas
    cycle: dict[str, int]

    def write(self) -> None:
        """The start, then one iteration beside the other."""
        self.live = [int(k) for k in np.flatnonzero(self.book.iterations.live)]
        self._start()
        for k in range(self.book.iterations.count):
            self._iteration(k)

    @property
    def _variables(self) -> list[Variable]:
        return [self.book.model.equations.unknowns[i] for i in self.block.unknowns]

    def _title(self, first: int, last: int, title: str) -> None:
        style = self.book.style["group"]
        if first == last:
            self.sheet.write(FIRST - 3, first, title, style)
        else:
            self.sheet.merge_range(FIRST - 3, first, FIRST - 3, last, title, style)

    def _start(self) -> None:
        book = self.book
        first = self.columns.x[0, self.block.unknowns[0]]
        several = sum(1 for block in book.closure.blocks if block.rows) > 1
        title = f"Block {self.number + 1}: start" if several else "Start"
        self._title(first, first + len(self.block.unknowns) - 1, title)
        for i, variable in zip(self.block.unknowns, self._variables, strict=True):
            column = self.columns.x[0, i]
            book.head(self.sheet, column, f"{book.shown(variable)} 0", book.unit(variable.kind))
            source = column_name(self.cycle[variable.symbol])
            for k in self.live:
                value = float(book.iterations.values[0][k, i])
                above = int(book.iterations.above[k])
                # the first iterate is the solution of the row above
                if above >= 0:
                    self._cell(k, column, f"={CYCLE}!{source}{FIRST + above + 1}", "start", value)
                elif k == self.live[0]:
                    estimate = book.names.cells[f"start {variable.symbol}"]
                    self._cell(k, column, f"={estimate}", "start", value)
                else:
                    look = book.style["input_number"]
                    self.sheet.write_number(FIRST + k, column, value, look)

    def _cell(self, k: int, column: int, formula: str, look: str, value: float) -> None:
        """One formula of one row."""
        own = apart(formula, FIRST + k)
        self.sheet.write_formula(FIRST + k, column, own, self.book.style[look], cached(value))

    def _iteration(self, k: int) -> None:
        book, block, n = self.book, self.block, len(self.block.unknowns)
        place = self.columns.start[self.number, k]
        self._title(place, place + 2 * n + n * n + n - 1, f"Iteration {k + 1}")
        cells = {v.symbol: book.names.cells[f"iterate {k} {v.symbol}"] for v in self._variables}
        here = {
            v.symbol: book.iterations.values[k][:, i]
            for i, v in zip(block.unknowns, self._variables, strict=True)
        }
        values = {**book.values, **here}
        for r, row in enumerate(block.rows):
            book.head(self.sheet, place + r, row.name, "")
            self._cells(place + r, book.text(row.formula, **cells), row.formula, values, "small")
            for c, slope in enumerate(row.slopes):
                column = place + n + n * r + c
                book.head(self.sheet, column, f"∂{row.name}/∂{book.shown(self._variables[c])}", "")
                self._cells(column, book.text(slope, **cells), slope, values, "slope")
        self._corrections(k, place)
        self._next(k, place + n + n * n)

    def _cells(
        self, column: int, shown: str, formula: Any, values: dict[str, Any], look: str
    ) -> None:
        found = self.book.over_rows(formula.value(values))
        for k in self.live:
            self._cell(k, column, shown, look, found[k])

    def _corrections(self, k: int, place: int) -> None:
        """δ = -J⁻¹ F of every row."""
        book, n = self.book, len(self.block.unknowns)
        first = place + n + n * n
        done = book.iterations.values
        # cached values of δ in radians; the iterates are in file units
        changes = [
            (done[k + 1][:, i] - done[k][:, i]) * book.scale(v)
            for i, v in zip(self.block.unknowns, self._variables, strict=True)
        ]
        for c, variable in enumerate(self._variables):
            unit = "rad" if variable.kind == "angle" else book.unit(variable.kind)
            book.head(self.sheet, first + c, f"δ{book.shown(variable)}", unit)
        for row in self.live:
            for c, change in enumerate(changes):
                formula = _correction(place, n, c, FIRST + row + 1)
                self._cell(row, first + c, formula, "small", float(change[row]))

    def _next(self, k: int, corrections: int) -> None:
        """x + δ."""
        book = self.book
        for c, (i, variable) in enumerate(zip(self.block.unknowns, self._variables, strict=True)):
            column = self.columns.x[k + 1, i]
            book.head(
                self.sheet, column, f"{book.shown(variable)} {k + 1}", book.unit(variable.kind)
            )
            old = book.names.cells[f"iterate {k} {variable.symbol}"]
            change = column_name(corrections + c)
            for row in self.live:
                delta = f"{change}{FIRST + row + 1}"
                if book.scale(variable) != 1.0:
                    delta = f"DEGREES({delta})"
                value = float(book.iterations.values[k + 1][row, i])
                self._cell(row, column, f"={old}+{delta}", "number", value)


def _correction(place: int, n: int, c: int, row: int) -> str:
    """Entry c of -J⁻¹ F of one row: its Jacobian stands line after line beside the equations.

    A plain formula, no array formula: MMULT, MINVERSE and SUMPRODUCT take arrays as they are.
    """

    def span(first: int, count: int) -> str:
        return f"{column_name(first)}{row}:{column_name(first + count - 1)}{row}"

    if n == 1:
        return f"=-{column_name(place)}{row}/{column_name(place + 1)}{row}"
    # the rows of J lie side by side in one row of cells: outer products stack them to a matrix
    lines = [f"{{{_unit(r, n, ';')}}}*{span(place + n + n * r, n)}" for r in range(n)]
    entry = f"MMULT({{{_unit(c, n, ',')}}},MINVERSE({'+'.join(lines)}))"
    return f"=-SUMPRODUCT({entry},{span(place, n)})"


def _unit(one: int, n: int, between: str) -> str:
    """A unit vector."""
    return between.join("1" if k == one else "0" for k in range(n))
