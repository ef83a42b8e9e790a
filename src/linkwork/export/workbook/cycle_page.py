"""The sheet of positions: a row for every value of the input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.export.workbook.book import (
    CYCLE,
    FIRST,
    LINKWORK,
    NEWTON,
    Book,
    apart,
    cached,
    column_name,
)
from linkwork.export.workbook.cell_formula import CellFormula
from linkwork.export.workbook.dimension_page import input_table
from linkwork.export.workbook.newton_page import NewtonColumns
from linkwork.foundation.names import canonical
from linkwork.results.quantity import Kind

__all__ = ["CycleColumns", "planned_cycle", "write_cycle"]

_WIDTH = 13


@dataclass(frozen=True, kw_only=True)
class CycleColumns:
    """Where the sheet has what; ``largest`` is the column of differences."""

    of: dict[str, int]
    equations: tuple[int, ...]
    squares: int
    largest: int
    closes: int
    status: int
    groups: tuple[tuple[str, int, int], ...]


def planned_cycle(book: Book) -> CycleColumns:
    """Number the columns and name them."""
    of: dict[str, int] = {}
    groups: list[tuple[str, int, int]] = []
    place = 1

    def group(title: str, keys: list[str]) -> None:
        nonlocal place
        for key in keys:
            of[key] = place
            place += 1
        if keys:
            groups.append((title, place - len(keys), place - 1))

    equations = book.model.equations
    group("Input", [v.symbol for v in equations.inputs])
    group("Unknowns", [v.symbol for v in equations.unknowns])
    rows = sorted(
        (row.name for block in book.closure.blocks for row in block.rows),
        key=lambda name: int(name[1:]),
    )
    group("Equations, 0 where they close", [f"row {name}" for name in rows])
    squares, place = place, place + (1 if rows else 0)
    group("Links that turn with another link", [canonical(link) for link in book.closure.links])
    group("Outputs", [f"output {name}" for name in book.closure.outputs])
    points = book.closure.points
    group("Points", [coordinate_name(point, axis) for point in points for axis in "xy"])
    groups.append(("Check", place, place + 2))
    for key, column in of.items():
        if key in book.names.cells:
            book.define(key, CYCLE, f"${column_name(column)}1")
    return CycleColumns(
        of=of,
        equations=tuple(of[f"row {name}"] for name in rows),
        squares=squares if rows else -1,
        largest=place,
        closes=place + 1,
        status=place + 2,
        groups=tuple(groups),
    )


def write_cycle(book: Book, sheet: Any, columns: CycleColumns, newton: NewtonColumns) -> None:
    """Write every position."""
    _Page(book, sheet, columns, newton).write()


@dataclass
class _Page:
    book: Book
    sheet: Any
    columns: CycleColumns
    newton: NewtonColumns

    def write(self) -> None:
        """Headings, then column by column."""
        book, sheet, style = self.book, self.sheet, self.book.style
        sheet.set_column(0, 0, 6)
        sheet.set_column(1, self.columns.closes, _WIDTH)
        sheet.set_column(self.columns.status, self.columns.status, 34)
        sheet.write(0, 0, f"{book.model.description.name}: positions", style["title"])
        for title, first, last in self.columns.groups:
            if first == last:
                sheet.write(FIRST - 3, first, title, style["group"])
            else:
                sheet.merge_range(FIRST - 3, first, FIRST - 3, last, title, style["group"])
        book.head(self.sheet, 0, "row", "")
        for k in range(book.count):
            sheet.write_number(FIRST + k, 0, k + 1, style["count"])
        self._inputs()
        self._unknowns()
        self._equations()
        self._rest()
        self._check()
        sheet.freeze_panes(FIRST, 1 + len(book.model.equations.inputs))

    def _inputs(self) -> None:
        book = self.book
        for variable in book.model.equations.inputs:
            column = self.columns.of[variable.symbol]
            book.head(self.sheet, column, book.shown(variable), book.unit(variable.kind))
            values = book.motion.inputs[variable.name][book.iterations.rows]
            # an even table is first + step·k in cells, so that both can be changed
            even = input_table(values) is not None
            for k, value in enumerate(values):
                at = FIRST + k, column
                if not even:
                    self.sheet.write_number(*at, value, book.style["input_number"])
                    continue
                first, step = (
                    book.names.cells[f"{word} {variable.symbol}"] for word in ("from", "step")
                )
                formula = f"={first}+{step}*($A{FIRST + k + 1}-1)"
                self.sheet.write_formula(*at, formula, book.style["number"], value)

    def _unknowns(self) -> None:
        book, done = self.book, self.book.iterations
        for number, variable in enumerate(book.model.equations.unknowns):
            column = self.columns.of[variable.symbol]
            book.head(self.sheet, column, book.shown(variable), book.unit(variable.kind))
            last = self.newton.last.get(number)
            for k in np.flatnonzero(done.found).tolist():
                value = float(done.values[-1][k, number])
                if last is None or not done.live[k]:
                    self.sheet.write_number(FIRST + k, column, value, book.style["value"])
                    continue
                formula = apart(f"={NEWTON}!{column_name(last)}{FIRST + k + 1}", FIRST + k)
                self.sheet.write_formula(FIRST + k, column, formula, book.style["number"], value)

    def _formulas(self, column: int, formula: CellFormula, look: str) -> Any:
        """One formula in every row that has a position; its values (R,)."""
        book = self.book
        shown = book.text(formula)
        values = book.over_rows(formula.value(book.values))
        for k in np.flatnonzero(book.iterations.found).tolist():
            self.sheet.write_formula(FIRST + k, column, shown, book.style[look], cached(values[k]))
        return values

    def _equations(self) -> None:
        book = self.book
        squares: Any = np.zeros(book.count)
        for block in book.closure.blocks:
            for row in block.rows:
                column = self.columns.of[f"row {row.name}"]
                book.head(self.sheet, column, row.name, "")
                squares = squares + self._formulas(column, row.formula, "small") ** 2
        if not self.columns.equations:
            return
        book.head(self.sheet, self.columns.squares, "ΣF²", "")
        first = column_name(self.columns.equations[0])
        last = column_name(self.columns.equations[-1])
        self._written(
            self.columns.squares,
            lambda row: f"=SUMSQ({first}{row}:{last}{row})",
            squares,
            "small",
        )

    def _written(self, column: int, formula: Callable[[int], str], values: Any, look: str) -> None:
        """A formula of its own row's cells in every row that has a position."""
        book = self.book
        for k in np.flatnonzero(book.iterations.found).tolist():
            value = values[k] if isinstance(values[k], str) else cached(values[k])
            self.sheet.write_formula(
                FIRST + k, column, formula(FIRST + k + 1), book.style[look], value
            )

    def _rest(self) -> None:
        """Points, links and outputs, each from those before it."""
        book, closure = self.book, self.book.closure
        for point, pair in closure.points.items():
            for axis, formula in zip("xy", pair, strict=True):
                key = coordinate_name(point, axis)
                column = self.columns.of[key]
                book.head(self.sheet, column, f"{point}.{axis}", book.unit("length"))
                book.values[key] = self._formulas(column, formula, "number")
        for link, formula in closure.links.items():
            column = self.columns.of[canonical(link)]
            book.head(self.sheet, column, link, book.unit("angle"))
            book.values[canonical(link)] = self._formulas(column, formula, "number")
        kinds = {name: output.kind for name, output in book.model.equations.outputs.items()}
        for name, formula in closure.outputs.items():
            column = self.columns.of[f"output {name}"]
            book.head(self.sheet, column, name, book.model.units.of(Kind(kinds[name])))
            book.values[f"output {name}"] = self._formulas(column, formula, "number")

    def _check(self) -> None:
        book, columns = self.book, self.columns
        book.head(self.sheet, columns.largest, "difference", "from Linkwork")
        book.head(self.sheet, columns.closes, "closes", "")
        self.sheet.write(FIRST - 2, columns.status, "Linkwork's status", book.style["head_left"])
        self.sheet.write(FIRST - 1, columns.status, "", book.style["unit"])
        if columns.equations:
            square = column_name(columns.squares)
            self._written(
                columns.closes,
                lambda row: (
                    f'=IF(ISNUMBER({square}{row}),IF({square}{row}<tolerance,"yes","NO"),"NO")'
                ),
                ["yes"] * book.count,
                "general",
            )
            area = FIRST, columns.closes, FIRST + book.count - 1, columns.closes
            look = {
                "type": "cell",
                "criteria": "==",
                "value": '"NO"',
                "format": book.style["wrong"],
            }
            self.sheet.conditional_format(*area, look)
        self._written(columns.largest, self._difference, np.zeros(book.count), "small")
        for k, row in enumerate(book.iterations.rows):
            self.sheet.write(FIRST + k, columns.status, self._said(int(row), k))

    def _difference(self, row: int) -> str:
        """The largest difference of a row's unknowns from Linkwork's own."""
        book = self.book
        parts = []
        source = int(book.iterations.rows[row - FIRST - 1]) + FIRST + 1
        for variable in book.model.equations.unknowns:
            if variable.name in book.motion.unknowns:
                own = column_name(self.columns.of[variable.symbol])
                other = column_name(book.linkwork_columns[variable.name])
                parts.append(f"ABS({own}{row}-{LINKWORK}!{other}{source})")
        return f"=MAX({','.join(parts)})"

    def _said(self, row: int, k: int) -> str:
        motion, done = self.book.motion, self.book.iterations
        status = motion.status[row]
        if not status.ok:
            return f"{status.name}: {status.value}"
        said = motion.certification[row].name.lower().replace("_", " ")
        if not done.live[k]:
            return f"found, {said}; does not recalculate: Newton-Raphson does not converge here"
        if done.above[k] < 0 and k > 0:
            return f"found, {said}; starts from a separate estimate"
        return f"found, {said}"
