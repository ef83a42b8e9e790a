"""The sheet of the Newton-Raphson iterations, from left to right."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import Node, NumberNode
from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.numerics.newton import corrections
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.formulas.closure_formulas import BlockFormulas, cell_number, value_of
from linkwork.writers.formulas.rate_formulas import rate_key
from linkwork.writers.workbook.book import (
    CYCLE,
    FIRST,
    LINKWORK,
    NEWTON,
    PRINTED,
    VELOCITIES,
    Book,
    Table,
    column_name,
)

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


# ----------------------------------------------------------------------
# The sheet of velocities and accelerations, solved with the Jacobian of the last iteration.


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
