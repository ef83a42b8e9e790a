"""The sheet of velocities and accelerations, solved with the Jacobian of the last iteration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import Name, Node
from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.names import canonical
from linkwork.core.numerics.newton import corrections
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.formulas.closure_formulas import value_of
from linkwork.writers.formulas.rate_formulas import rate_key
from linkwork.writers.workbook.book import FIRST, LINKWORK, NEWTON, VELOCITIES, Book, column_name
from linkwork.writers.workbook.layout import print_table
from linkwork.writers.workbook.newton_page import NewtonColumns, correction

_WIDTH = 14
_WORDS = {1: "velocity", 2: "acceleration"}


@dataclass
class VelocityColumns:
    """Column numbers by key; ``side[block, order]``: the first right-hand side of a block."""

    of: dict[str, int] = field(default_factory=dict)
    side: dict[tuple[int, int], int] = field(default_factory=dict)
    groups: list[tuple[str, int, int]] = field(default_factory=list)
    end: int = 1


def planned_velocities(book: Book) -> VelocityColumns:
    """Number the columns and name their cells: ``theta13.velocity``."""
    inputs = len(book.model.equations.inputs)
    columns = VelocityColumns(groups=[("Input", 1, inputs)], end=1 + inputs)
    for order, word in _WORDS.items():
        for b, sides in enumerate(book.rates.sides):
            columns.side[b, order] = columns.end
            _group(columns, f"Right sides of {word}", len(sides))
        first = columns.end
        for key, _, _ in _quantities(book):
            columns.of[rate_key(key, order)] = columns.end
            book.names.claim(rate_key(key, order), f"{book.names.cells[key].rstrip('_')}.{word}")
            book.define(rate_key(key, order), VELOCITIES, f"${column_name(columns.end)}1")
            columns.end += 1
        title = {1: "Velocities", 2: "Accelerations"}[order]
        columns.groups.append((title, first, columns.end - 1))
    return columns


def _group(columns: VelocityColumns, title: str, count: int) -> None:
    """A group of columns, joined to one of the same title before it."""
    if not count:
        return
    if columns.groups and columns.groups[-1][0] == title:
        _, first, _ = columns.groups.pop()
    else:
        first = columns.end
    columns.end += count
    columns.groups.append((title, first, columns.end - 1))


def _quantities(book: Book) -> Iterator[tuple[str, str, Kind]]:
    """Key, shown name and kind of all quantities with rates, each after those it is made of."""
    rates = book.rates.of
    for variable in book.model.equations.unknowns:
        yield variable.symbol, book.shown(variable), Kind(variable.kind)
    for link in book.closure.links:
        if canonical(link) in rates:
            yield canonical(link), link, Kind.ANGLE
    for point in book.closure.points:
        for axis in "xy":
            if coordinate_name(point, axis) in rates:
                yield coordinate_name(point, axis), f"{point}.{axis}", Kind.LENGTH
    for name in book.closure.outputs:
        if f"output {name}" in rates:
            yield f"output {name}", name, Kind(book.model.equations.outputs[name].kind)


def write_velocities(
    book: Book, sheet: Any, columns: VelocityColumns, newton: NewtonColumns
) -> None:
    """Write the rates of all rows."""
    _VelocityPagePage(book, sheet, columns, newton).write()


@dataclass
class _VelocityPagePage:
    book: Book
    sheet: Any
    columns: VelocityColumns
    newton: NewtonColumns

    def write(self) -> None:
        """Write right-hand sides and rates, velocities first."""
        book, sheet = self.book, self.sheet
        widths = [6, *[_WIDTH] * (self.columns.end - 1)]
        repeated = 1 + len(book.model.equations.inputs)
        print_table(sheet, widths, repeated, book.last - 1)
        book.title(sheet, "velocities and accelerations")
        lead = book.leading
        sheet.write(
            1, 0,
            f"J q\u0307 = -∂F/∂{book.shown(lead)} · speed, and the same once more for the "
            f"accelerations. J is that of the last iteration; the speed of {book.shown(lead)} is "
            "on the sheet Dimensions.", book.style["note"],
        )  # fmt: skip
        book.group_heads(sheet, self.columns.groups)
        book.row_numbers(sheet)
        for column, variable in enumerate(book.model.equations.inputs, 1):
            book.head(sheet, column, book.shown(variable), book.unit(variable.kind))
            book.column(sheet, column, Name(variable.symbol), "number")
        for order in (1, 2):
            for b in range(len(book.closure.blocks)):
                self._block(b, order)
            self._others(order)
        sheet.freeze_panes(FIRST, repeated)

    def _head(self, key: str, shown: str, kind: Kind, order: int) -> int:
        column = self.columns.of[rate_key(key, order)]
        rate = Rate.VELOCITY if order == 1 else Rate.ACCELERATION
        unit = rate.unit(kind, self.book.model.units, "")
        self.book.head(self.sheet, column, shown, unit)
        return column

    def _block(self, b: int, order: int) -> None:
        """The rates of a block's unknowns."""
        book, block = self.book, self.book.closure.blocks[b]
        sides = book.rates.sides[b]
        for r, pair in enumerate(sides):
            column = self.columns.side[b, order] + r
            book.head(self.sheet, column, block.rows[r].name, "")
            self._formulas(column, pair[order - 1])
        rates = self._solved(b, order)
        for c, k in enumerate(block.unknowns):
            variable = book.model.equations.unknowns[k]
            column = self._head(variable.symbol, book.shown(variable), Kind(variable.kind), order)
            book.values[rate_key(variable.symbol, order)] = rates[:, c]
            for row, value in enumerate(rates[:, c].tolist()):
                formula = f"={self._rate(b, order, c, row)}"
                book.put(self.sheet, row, column, formula, "number" if sides else "value", value)

    def _solved(self, b: int, order: int) -> AnyArray:
        """The values of a block's rates, (R, n); those of Linkwork where cells do not solve."""
        book, block = self.book, self.book.closure.blocks[b]
        rates = np.full((book.count, len(block.unknowns)), np.nan)
        for c, k in enumerate(block.unknowns):
            series = book.motion.unknowns.get(book.model.equations.unknowns[k].name)
            if series is not None:
                derivative = series.first if order == 1 else series.second
                rates[:, c] = derivative[book.iterations.rows] * book.speed**order
        live = book.iterations.live
        if book.rates.sides[b] and live.any():
            sides = [value_of(pair[order - 1], book.values) for pair in book.rates.sides[b]]
            rates[live] = rates_of_block(book, b, sides)[live]
        return rates

    def _rate(self, b: int, order: int, c: int, row: int) -> str:
        """The formula of one rate in one row, without equals sign."""
        book, block = self.book, self.book.closure.blocks[b]
        done = book.iterations
        variable = book.model.equations.unknowns[block.unknowns[c]]
        place = FIRST + row + 1
        solved_rate = "NA()"
        if done.found[row] and variable.name in book.motion.unknowns:
            source = book.linkwork_columns[f"{variable.name}.d{order}"]
            power = "" if order == 1 else "^2"
            speed = book.names.cells[rate_key(book.leading.symbol, 1)]
            solved_rate = (
                f"{LINKWORK}!{column_name(source)}{int(done.rows[row]) + FIRST + 1}*{speed}{power}"
            )
        if not book.rates.sides[b]:
            return f'IF(as_solved="yes",{solved_rate},NA())'
        side = self.columns.side[b, order]
        solved = correction(
            self.newton.last_jacobian[b], side, len(block.rows), c, place, f"{NEWTON}!"
        )
        if done.live[row]:
            return solved
        return f'IF(as_solved="yes",{solved_rate},{solved})'

    def _others(self, order: int) -> None:
        """The rates of links, points and outputs."""
        book = self.book
        unknowns = {v.symbol for v in book.model.equations.unknowns}
        for key, shown, kind in _quantities(book):
            if key not in unknowns:
                column = self._head(key, shown, kind, order)
                values = self._formulas(column, book.rates.of[key][order - 1])
                book.values[rate_key(key, order)] = values

    def _formulas(self, column: int, formula: Node) -> Any:
        return self.book.column(self.sheet, column, formula, "number")


def rates_of_block(book: Book, b: int, sides: Sequence[Any]) -> AnyArray:
    """The rates of a block's unknowns by its right-hand sides, (R, n); NaN where no cells solve."""
    block, live, before = book.closure.blocks[b], book.iterations.live, dict(book.values)
    for k in block.unknowns:  # of the last iteration's Jacobian
        symbol = book.model.equations.unknowns[k].symbol
        before[symbol] = book.iterations.values[-2][:, k]
    slopes = [[book.over_rows(value_of(part, before)) for part in row.slopes] for row in block.rows]
    jacobian = np.moveaxis(np.array(slopes), 2, 0)
    right = np.stack([book.over_rows(side) for side in sides], axis=1)
    rates = np.full((book.count, len(block.unknowns)), np.nan)
    if live.any():
        rates[live], _ = corrections(jacobian[live], right[live])
    return rates


# ----------------------------------------------------------------------
# The sheet of rates by each of several inputs alone, for their virtual work.


PARTIALS = "Partials"


def partial_key(key: str, which: Variable) -> str:
    """The key of a rate by one input alone; ``key`` is that of the rate by all inputs."""
    return f"{key} by {which.symbol}"


def write_partials(book: Book, sheet: Any, newton: NewtonColumns) -> None:
    """Write the rates of all rows by every input."""
    _PartialPagePage(book, sheet, newton).write()


@dataclass
class _PartialPagePage:
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
        note = "As on the sheet Velocities, with a speed of 1 of one input while all others rest."
        sheet.write(1, 0, note, book.style["note"])
        book.row_numbers(sheet)
        for variable in inputs:
            book.head(sheet, self.end, book.shown(variable), book.unit(variable.kind))
            book.column(sheet, self.end, Name(variable.symbol), "number")
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
        # by the names of rates by all inputs in the formulas of velocities
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
            rates = rates_of_block(
                book, b, [value_of(formula, {**book.values, **values}) for formula in formulas]
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
                    variable.symbol, book.shown(variable), which, cells, values, rates[:, c], texts
                )
            self._group(f"Rates by {shown}", begin)
        begin = self.end
        for key, name in self._others():
            formula = book.rates.of[key][0]
            column = np.array(book.over_rows(value_of(formula, {**book.values, **values})))
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

    def _column(self, formula: Node, cells: dict[str, str], values: dict[str, Any]) -> None:
        book = self.book
        column = book.over_rows(value_of(formula, {**book.values, **values}))
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
        book, rate = self.book, rate_key(quantity, 1)
        key = partial_key(rate, which)
        name = book.names.claim(key, f"{book.names.cells[quantity].rstrip('_')}.by.{which.shown}")
        book.define(key, PARTIALS, f"${column_name(self.end)}1")
        book.head(self.sheet, self.end, shown, "")
        for row, value in enumerate(column.tolist()):
            if texts:
                book.put(self.sheet, row, self.end, texts[row], "number", value)
            else:
                self.sheet.write_number(FIRST + row, self.end, value, book.style["number"])
        cells[rate], values[rate], book.values[key] = name, column, column
        self.end += 1

    def _group(self, title: str, first: int) -> None:
        """A group of the columns since the first one, joined to one of the same title before it."""
        if first == self.end:
            return
        if self.groups[-1][0] == title:
            first = self.groups.pop()[1]
        self.groups.append((title, first, self.end - 1))
