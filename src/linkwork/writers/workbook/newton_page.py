"""The sheet of the Newton-Raphson iterations, from left to right."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.writers.formulas.closure_formulas import BlockFormulas, cell_number
from linkwork.writers.workbook.book import CYCLE, FIRST, NEWTON, Book, column_name
from linkwork.writers.workbook.layout import PRINTED, Table

_MOST_COLUMNS = 16_384
_MOST_CELLS = 2_000_000
_SMALL = 1e-14  # sum of squares of weighted corrections below which a row has converged


@dataclass
class NewtonColumns:
    """Columns by number: the last iterates, by unknown; the last Jacobians, by block."""

    last: dict[int, int] = field(default_factory=dict)
    last_jacobian: dict[int, int] = field(default_factory=dict)


def check_size(book: Book) -> None:
    """Check that the iterations, positions and rates fit into a workbook.

    Raises
    ------
    InputError
        If they have too many cells.
    """
    columns, count, rows = 3, book.iterations.count, 0
    for block in book.closure.blocks:
        n, rows = len(block.unknowns) if block.rows else 0, rows + len(block.rows)
        columns += n + count * (3 * n + n * n)
    if columns > _MOST_COLUMNS:
        raise InputError(
            f"{columns} columns of iterations are too many for a workbook (at most "
            f"{_MOST_COLUMNS}): write CSV"
        )
    equations = book.model.equations
    columns += 2 * len(equations.inputs) + 3 * len(equations.unknowns) + 3 * rows
    columns += len(book.closure.quantities) + 2 * len(book.rates.of)
    if book.count * columns > _MOST_CELLS:
        raise InputError(
            f"{book.count} rows of {columns} columns are too many cells for a workbook with "
            f"formulas (at most {_MOST_CELLS}): take a larger step, or write CSV"
        )


def write_newton(book: Book, sheet: Any, progress: Callable[[float], None]) -> NewtonColumns:
    """Write all iterations of all rows."""
    table, columns = Table(book, NEWTON, sheet, 11, chained=True), NewtonColumns()
    blocks = [(b, block) for b, block in enumerate(book.closure.blocks) if block.rows]
    squares: list[tuple[str, Array]] = []
    for done, (b, block) in enumerate(blocks):
        page = _Block(table, columns, b, block, f"Block {b + 1}: start" if blocks[1:] else "Start")
        for part in page.write():
            progress((done + part) / len(blocks))
        squares += page.changes
    table.group = "Last δ"
    total = sum((values for _, values in squares), np.zeros(book.count))

    def squared(k: int) -> str:
        return "=" + ("+".join(text.format(FIRST + k + 1) for text, _ in squares) or "0")

    place = table.add("Σδ²", "weighted")
    table.cells(place, squared, total, "small")
    book.names.claim("converged", "converged")
    verdict = table.add("converged", "", "converged")
    small = f"<{cell_number(_SMALL)}"
    for k, live in enumerate(book.iterations.live.tolist()):
        cell = f"{column_name(place)}{FIRST + k + 1}"
        formula = f'=IF(ISNUMBER({cell}),IF({cell}{small},"yes","no"),"no")'
        table.put(k, verdict, formula, "right", "yes" if live else "")
    note = (
        "J δ = -F, x + δ; every row starts from the nearest row above with a position. δ of angles "
        "is in radians."
    )
    if book.count > PRINTED:
        sheet.write(2, 0, f"Printed: the first {PRINTED} rows.", book.style["note"])
    table.finish("Newton-Raphson", note, 1, min(book.count, PRINTED))
    return columns


@dataclass
class _Block:
    """The iterations of a block; ``changes`` are formulas and values of its last δ, squared."""

    table: Table
    columns: NewtonColumns
    number: int
    block: BlockFormulas
    title: str
    changes: list[tuple[str, Array]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.book = self.table.book
        unknowns = self.book.model.equations.unknowns
        self.variables = [(i, unknowns[i]) for i in self.block.unknowns]

    def write(self) -> Iterator[float]:
        """Write the start, then the iterations from left to right; yields the finished part."""
        self.table.group = self.title
        for i, variable in self.variables:
            self._start(i, variable)
        count = self.book.iterations.count
        for k in range(count):
            self.table.group = f"Iteration {k + 1}"
            self._iteration(k)
            yield (k + 1) / count

    def _iterate(self, k: int, i: int, variable: Variable) -> int:
        """A named column of an unknown after k iterations: ``theta14_0``, ``theta14_1``, …"""
        book, key = self.book, f"iterate {k} {variable.symbol}"
        book.names.claim(key, f"{variable.shown}_{k}")
        self.columns.last[i] = self.table.add(
            f"{book.shown(variable)} {k}", book.unit(variable.kind), key
        )
        return self.columns.last[i]

    def _start(self, i: int, variable: Variable) -> None:
        book, done = self.book, self.book.iterations
        live = np.flatnonzero(done.live)
        first_live = int(live[0]) if len(live) else book.count
        column = self._iterate(0, i, variable)
        # the unknowns follow the inputs on the sheet of positions
        source = column_name(1 + len(book.model.equations.inputs) + i)
        estimate = book.names.of[f"start {variable.symbol}"]
        for k, value in enumerate(done.values[0][:, i].tolist()):
            if k <= first_live:
                self.table.put(k, column, f"={estimate}", "start", value)
            elif done.live[k] and done.above[k] < 0:
                look = book.style["input_number"]
                self.table.sheet.write_number(FIRST + k, column, value, look)
            else:
                above = f"{CYCLE}!{source}{FIRST + k}"
                before = f"{column_name(column)}{FIRST + k}"
                carried = f"=IF(ISNUMBER({above}),{above},{before})"
                self.table.put(k, column, carried, "start", value)

    def _iteration(self, k: int) -> None:
        book, table, n = self.book, self.table, len(self.variables)
        values, count = book.iterations.values, book.iterations.count
        # earlier blocks by their last iterates: positions depend on the verdict about all blocks
        names = {
            v.symbol: f"iterate {count} {v.symbol}"
            for i, v in enumerate(book.model.equations.unknowns)
            if i in self.columns.last
        }
        names |= {v.symbol: f"iterate {k} {v.symbol}" for _, v in self.variables}
        here = {v.symbol: values[k][:, i] for i, v in self.variables}
        first = table.end
        for row in self.block.rows:
            table.formula(row.name, "", row.formula, "small", names=names, values=here)
        jacobian = table.end
        self.columns.last_jacobian[self.number] = jacobian
        for row in self.block.rows:
            for (_, variable), slope in zip(self.variables, row.slopes, strict=True):
                title = f"∂{row.name}/∂{book.shown(variable)}"
                table.formula(title, "", slope, "slope", names=names, values=here)
        self.changes = []
        for c, (i, variable) in enumerate(self.variables):
            unit = "rad" if variable.kind == "angle" else book.unit(variable.kind)
            column = table.add(f"δ{book.shown(variable)}", unit)
            # δ is in radians; the iterates are in file units
            change = (values[k + 1][:, i] - values[k][:, i]) * book.scale(variable)

            def text(row: int, c: int = c) -> str:
                return f"={correction(jacobian, first, n, c, FIRST + row + 1)}"

            table.cells(column, text, change, "small")
            size = float(book.model.compiled.solver.variable_scale[i])
            per = "" if size == 1.0 else f"/{cell_number(size)}"
            self.changes.append((f"({column_name(column)}{{}}{per})^2", (change / size) ** 2))
        for c, (i, variable) in enumerate(self.variables):
            old, new = names[variable.symbol], self._iterate(k + 1, i, variable)
            form = "={}+{}{}" if book.scale(variable) == 1.0 else "={}+DEGREES({}{})"
            letter = column_name(jacobian + n * n + c)

            def moved(row: int, form: str = form, old: str = old, letter: str = letter) -> str:
                return form.format(book.names.of[old], letter, FIRST + row + 1)

            table.cells(new, moved, values[k + 1][:, i], "number")


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
