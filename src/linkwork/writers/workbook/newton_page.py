"""The sheet of the Newton-Raphson iterations, from left to right."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import Node, names_in
from linkwork.core.foundation.errors import InputError
from linkwork.writers.formulas.closure_formulas import BlockFormulas, cell_number, value_of
from linkwork.writers.workbook.book import CYCLE, FIRST, NEWTON, Book, apart, cached, column_name
from linkwork.writers.workbook.layout import PRINTED, print_table

_MOST_COLUMNS = 16_384
_SMALL = 1e-14  # sum of squares of weighted corrections below which a row has converged


@dataclass
class NewtonColumns:
    """Column numbers, block by block.

    ``x[k, i]``: unknown i after k iterations; ``last[i]``: its last iterate. ``start[b, k]``: first
    column of iteration k of block b, that of the equations. ``last_jacobian[b]``: that of the
    Jacobian of a block's last iteration.
    """

    x: dict[tuple[int, int], int] = field(default_factory=dict)
    last: dict[int, int] = field(default_factory=dict)
    start: dict[tuple[int, int], int] = field(default_factory=dict)
    last_jacobian: dict[int, int] = field(default_factory=dict)
    end: int = 0

    @property
    def corrections(self) -> int:
        """The column of the size of the last corrections; that of their verdict follows."""
        return self.end


def planned_newton(book: Book) -> NewtonColumns:
    """Number the columns and name every iterate: ``theta14_0``, ``theta14_1``, …"""
    columns, place = NewtonColumns(), 1
    count = book.iterations.count
    for b, block in enumerate(book.closure.blocks):
        if not block.rows:
            continue
        n = len(block.unknowns)
        for k in range(count + 1):
            if k:
                columns.start[b, k - 1] = place
                place += 2 * n + n * n
            for i in block.unknowns:
                columns.x[k, i] = place
                variable = book.model.equations.unknowns[i]
                key = f"iterate {k} {variable.symbol}"
                book.names.claim(key, f"{variable.shown}_{k}")
                book.define(key, NEWTON, f"${column_name(place)}1")
                place += 1
        columns.last |= {i: columns.x[count, i] for i in block.unknowns}
        columns.last_jacobian[b] = columns.start[b, count - 1] + n
    columns.end = place
    if place + 2 > _MOST_COLUMNS:
        raise InputError(
            f"{place + 2} columns of iterations are too many for a workbook (at most "
            f"{_MOST_COLUMNS}): write CSV"
        )
    book.names.claim("converged", "converged")
    book.define("converged", NEWTON, f"${column_name(place + 1)}1")
    return columns


def write_newton(
    book: Book,
    sheet: Any,
    columns: NewtonColumns,
    cycle: dict[str, int],
    progress: Callable[[float], None],
) -> None:
    """Write all iterations of all rows; ``cycle`` numbers the columns of the positions."""
    widths = [6, *[11] * (columns.end + 1)]
    print_table(sheet, widths, 1, min(book.last, FIRST + PRINTED) - 1)
    if book.count > PRINTED:
        sheet.write(2, 0, f"Printed: the first {PRINTED} rows.", book.style["note"])
    book.title(sheet, "Newton-Raphson")
    sheet.write(
        1, 0,
        "J δ = -F, x + δ; every row starts from the nearest row above with a position. δ of angles "
        "is in radians.", book.style["note"],
    )  # fmt: skip
    book.row_numbers(sheet)
    count = len(book.closure.blocks)
    for b, block in enumerate(book.closure.blocks):
        if block.rows:
            for done in _Block(book, sheet, columns, b, block, cycle).write():
                progress((b + done) / count)
    _write_verdicts(book, sheet, columns)
    sheet.freeze_panes(FIRST, 1)


def _write_verdicts(book: Book, sheet: Any, columns: NewtonColumns) -> None:
    """Write the size of the last corrections, and whether they are small enough."""
    place, done = columns.corrections, book.iterations
    parts, squares = [], np.zeros(book.count)
    for b, block in enumerate(book.closure.blocks):
        n = len(block.unknowns)
        for c, k in enumerate(block.unknowns if block.rows else ()):
            size = float(book.model.compiled.solver.variable_scale[k])
            letter = column_name(columns.last_jacobian[b] + n * n + c)
            parts.append((letter, "" if size == 1.0 else f"/{cell_number(size)}"))
            change = (done.values[-1] - done.values[-2])[:, k] * book.scales[k] / size
            squares = squares + change**2
    book.head(sheet, place, "Σδ²", "weighted")
    book.head(sheet, place + 1, "converged", "")
    book.group_heads(sheet, [("Last δ", place, place + 1)])
    for k in range(book.count):
        row = FIRST + k + 1
        total = "+".join(f"({letter}{row}{size})^2" for letter, size in parts)
        known = bool(done.live[k])
        look = book.style["small"]
        value = cached(squares[k]) if known else ""
        sheet.write_formula(FIRST + k, place, f"={total or 0}", look, value)
        cell = f"{column_name(place)}{row}"
        small = f'=IF(ISNUMBER({cell}),IF({cell}<{cell_number(_SMALL)},"yes","no"),"no")'
        sheet.write_formula(
            FIRST + k, place + 1, small, book.style["right"], "yes" if known else ""
        )


@dataclass
class _Block:
    book: Book
    sheet: Any
    columns: NewtonColumns
    number: int
    block: BlockFormulas
    cycle: dict[str, int]

    def write(self) -> Iterator[float]:
        """Write the start, then the iterations from left to right; yields the finished part."""
        self._start()
        for k in range(self.book.iterations.count):
            self._iteration(k)
            yield (k + 1) / self.book.iterations.count

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
        live = np.flatnonzero(book.iterations.live)
        first_live = int(live[0]) if len(live) else book.count
        for i, variable in zip(self.block.unknowns, self._variables, strict=True):
            column = self.columns.x[0, i]
            book.head(self.sheet, column, f"{book.shown(variable)} 0", book.unit(variable.kind))
            source = column_name(self.cycle[variable.symbol])
            estimate = book.names.cells[f"start {variable.symbol}"]
            for k, value in enumerate(book.iterations.values[0][:, i].tolist()):
                if k <= first_live:
                    self._cell(k, column, f"={estimate}", "start", value)
                elif book.iterations.live[k] and book.iterations.above[k] < 0:
                    look = book.style["input_number"]
                    self.sheet.write_number(FIRST + k, column, value, look)
                else:
                    above = f"{CYCLE}!{source}{FIRST + k}"
                    before = f"{column_name(column)}{FIRST + k}"
                    carried = f"=IF(ISNUMBER({above}),{above},{before})"
                    self._cell(k, column, carried, "start", value)

    def _cell(self, k: int, column: int, formula: str, look: str, value: float) -> None:
        """Write a formula of one row; its value is unknown where the cells do not solve."""
        text = apart(formula, FIRST + k)
        shown = cached(value) if self.book.iterations.live[k] else ""
        self.sheet.write_formula(FIRST + k, column, text, self.book.style[look], shown)

    def _iteration(self, k: int) -> None:
        book, block, n = self.book, self.block, len(self.block.unknowns)
        place = self.columns.start[self.number, k]
        self._title(place, place + 2 * n + n * n + n - 1, f"Iteration {k + 1}")
        # earlier blocks by their last iterates: positions depend on the verdict about all blocks
        cells = {
            v.symbol: book.names.cells[f"iterate {book.iterations.count} {v.symbol}"]
            for i, v in enumerate(book.model.equations.unknowns)
            if i in self.columns.last
        }
        iterate = {v.symbol: book.names.cells[f"iterate {k} {v.symbol}"] for v in self._variables}
        cells |= iterate
        here = {
            v.symbol: book.iterations.values[k][:, i]
            for i, v in zip(block.unknowns, self._variables, strict=True)
        }
        values = {**book.values, **here}
        for r, row in enumerate(block.rows):
            book.head(self.sheet, place + r, row.name, "")
            self._cells(place + r, row.formula, cells, values, "small")
            for c, slope in enumerate(row.slopes):
                column = place + n + n * r + c
                book.head(self.sheet, column, f"∂{row.name}/∂{book.shown(self._variables[c])}", "")
                self._cells(column, slope, cells, values, "slope")
        self._corrections(k, place)
        self._next(k, place + n + n * n)

    def _cells(
        self,
        column: int,
        formula: Node,
        cells: dict[str, str],
        values: dict[str, Any],
        look: str,
    ) -> None:
        results = self.book.over_rows(value_of(formula, values)).tolist()
        if not any(True for _ in names_in(formula)):
            for k, value in enumerate(results):
                self.sheet.write_number(FIRST + k, column, value, self.book.style[look])
            return
        shown = self.book.text(formula, **cells)
        for k, value in enumerate(results):
            self._cell(k, column, shown, look, value)

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
        for c, change in enumerate(changes):
            for row, value in enumerate(change.tolist()):
                formula = f"={correction(place + n, place, n, c, FIRST + row + 1)}"
                self._cell(row, first + c, formula, "small", value)

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
            for row, value in enumerate(book.iterations.values[k + 1][:, i].tolist()):
                delta = f"{change}{FIRST + row + 1}"
                if book.scale(variable) != 1.0:
                    delta = f"DEGREES({delta})"
                self._cell(row, column, f"={old}+{delta}", "number", value)


def correction(jacobian: int, sides: int, n: int, c: int, row: int, sheet: str = "") -> str:
    """Entry c of -J⁻¹ F of one row, by the first columns of J, line by line, and of F.

    ``sheet`` is ``Newton!`` on another sheet.

    A plain formula, not an array formula: MMULT, MINVERSE and SUMPRODUCT accept arrays directly.
    """
    if n == 1:
        return f"-{column_name(sides)}{row}/{sheet}{column_name(jacobian)}{row}"
    inverse, span = _inverse_line(jacobian, n, c, sheet), _span(sides, n)
    return f"-SUMPRODUCT({inverse.replace('#', str(row))},{span.replace('#', str(row))})"


@cache
def _inverse_line(jacobian: int, n: int, c: int, sheet: str) -> str:
    """Line c of J⁻¹ in row #."""
    # the rows of J lie side by side in one row of cells: outer products stack them to a matrix
    lines = [f"{{{_unit(r, n, ';')}}}*{sheet}{_span(jacobian + n * r, n)}" for r in range(n)]
    return f"MMULT({{{_unit(c, n, ',')}}},MINVERSE({'+'.join(lines)}))"


@cache
def _span(first: int, count: int) -> str:
    return f"{column_name(first)}#:{column_name(first + count - 1)}#"


def _unit(one: int, n: int, between: str) -> str:
    """A unit vector."""
    return between.join("1" if k == one else "0" for k in range(n))
