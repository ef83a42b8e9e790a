"""The sheet of velocities and accelerations, solved with the Jacobian of the last iteration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.export.formulas.cell_formula import CellFormula
from linkwork.export.formulas.rate_formulas import rate_key
from linkwork.export.workbook.book import (
    FIRST,
    LINKWORK,
    NEWTON,
    VELOCITIES,
    Book,
    column_name,
)
from linkwork.export.workbook.newton_page import NewtonColumns, correction
from linkwork.export.workbook.page_layout import print_table
from linkwork.expression.tree import Name
from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.names import canonical
from linkwork.numerics.newton import corrections
from linkwork.results.quantity import Kind, Rate

__all__ = ["VelocityColumns", "planned_velocities", "rates_of_block", "write_velocities"]

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
    _Page(book, sheet, columns, newton).write()


@dataclass
class _Page:
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
            book.column(sheet, column, CellFormula(Name(variable.symbol)), "number")
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
        found = np.full((book.count, len(block.unknowns)), np.nan)
        for c, k in enumerate(block.unknowns):
            series = book.motion.unknowns.get(book.model.equations.unknowns[k].name)
            if series is not None:
                own = series.first if order == 1 else series.second
                found[:, c] = own[book.iterations.rows] * book.speed**order
        live = book.iterations.live
        if book.rates.sides[b] and live.any():
            sides = [pair[order - 1].value(book.values) for pair in book.rates.sides[b]]
            found[live] = rates_of_block(book, b, sides)[live]
        return found

    def _rate(self, b: int, order: int, c: int, row: int) -> str:
        """The formula of one rate in one row, without equals sign."""
        book, block = self.book, self.book.closure.blocks[b]
        done = book.iterations
        variable = book.model.equations.unknowns[block.unknowns[c]]
        place = FIRST + row + 1
        own = "NA()"
        if done.found[row] and variable.name in book.motion.unknowns:
            source = book.linkwork_columns[f"{variable.name}.d{order}"]
            power = "" if order == 1 else "^2"
            speed = book.names.cells[rate_key(book.leading.symbol, 1)]
            own = (
                f"{LINKWORK}!{column_name(source)}{int(done.rows[row]) + FIRST + 1}*{speed}{power}"
            )
        if not book.rates.sides[b]:
            return f'IF(as_solved="yes",{own},NA())'
        side = self.columns.side[b, order]
        solved = correction(
            self.newton.last_jacobian[b], side, len(block.rows), c, place, f"{NEWTON}!"
        )
        if done.live[row]:
            return solved
        return f'IF(as_solved="yes",{own},{solved})'

    def _others(self, order: int) -> None:
        """The rates of links, points and outputs."""
        book = self.book
        unknowns = {v.symbol for v in book.model.equations.unknowns}
        for key, shown, kind in _quantities(book):
            if key not in unknowns:
                column = self._head(key, shown, kind, order)
                values = self._formulas(column, book.rates.of[key][order - 1])
                book.values[rate_key(key, order)] = values

    def _formulas(self, column: int, formula: CellFormula) -> Any:
        return self.book.column(self.sheet, column, formula, "number")


def rates_of_block(book: Book, b: int, sides: Sequence[Any]) -> AnyArray:
    """The rates of a block's unknowns by its right-hand sides, (R, n); NaN where no cells solve."""
    block, live, before = book.closure.blocks[b], book.iterations.live, dict(book.values)
    for k in block.unknowns:  # of the last iteration's Jacobian
        symbol = book.model.equations.unknowns[k].symbol
        before[symbol] = book.iterations.values[-2][:, k]
    slopes = [[book.over_rows(part.value(before)) for part in row.slopes] for row in block.rows]
    jacobian = np.moveaxis(np.array(slopes), 2, 0)
    right = np.stack([book.over_rows(side) for side in sides], axis=1)
    found = np.full((book.count, len(block.unknowns)), np.nan)
    if live.any():
        found[live], _ = corrections(jacobian[live], right[live])
    return found
