"""The sheet of positions: a row for every value of the input."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.equations.model import Variable
from linkwork.export.formulas.cell_formula import cell_number
from linkwork.export.workbook.book import (
    FIRST,
    LINKWORK,
    NEWTON,
    Book,
    apart,
    column_name,
)
from linkwork.export.workbook.cycle_columns import CycleColumns
from linkwork.export.workbook.dimension_page import input_table
from linkwork.export.workbook.newton_page import NewtonColumns
from linkwork.export.workbook.page_layout import print_table
from linkwork.export.workbook.status_formulas import StatusFormulas, statement
from linkwork.foundation.names import canonical
from linkwork.results.quantity import Kind

__all__ = ["write_cycle"]

_WIDTH, _STATUS = 13, 60


def write_cycle(book: Book, sheet: Any, columns: CycleColumns, newton: NewtonColumns) -> None:
    """Write all positions."""
    _Page(book, sheet, columns, newton).write()


@dataclass
class _Page:
    book: Book
    sheet: Any
    columns: CycleColumns
    newton: NewtonColumns

    def write(self) -> None:
        """Write the headings, then column by column."""
        book, sheet = self.book, self.sheet
        self.status = StatusFormulas(book, self.columns)
        said = (statement(book, int(row)) for row in book.iterations.rows)
        widths = [6, *[_WIDTH] * self.columns.closes, min(max(map(len, said), default=0), _STATUS)]
        repeated = 1 + len(book.model.equations.inputs)
        print_table(sheet, widths, repeated, book.last - 1)
        book.title(sheet, "positions")
        sheet.write(
            1, 0, "After a change, statuses follow: Linkwork's proofs are shown only for rows as "
            "Linkwork solved them.", book.style["note"],
        )  # fmt: skip
        book.group_heads(sheet, self.columns.groups)
        book.row_numbers(sheet)
        self._inputs()
        self._unknowns()
        self._equations()
        self._rest()
        self._check()
        sheet.freeze_panes(FIRST, repeated)

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
            look = "number" if number in self.newton.last else "value"
            for k, value in enumerate(done.values[-1][:, number].tolist()):
                formula = apart(f"={self._unknown(number, variable, k)}", FIRST + k)
                book.put(self.sheet, k, column, formula, look, value)

    def _unknown(self, number: int, variable: Variable, k: int) -> str:
        """The formula of an unknown in one row: the last iterate, or Linkwork's value, or #N/A."""
        book, done, row = self.book, self.book.iterations, FIRST + k + 1
        own = "NA()"
        if done.found[k] and variable.name in book.motion.unknowns:
            letter = column_name(book.linkwork_columns[variable.name])
            own = f"{LINKWORK}!{letter}{self.status.source(k)}"
        elif done.found[k]:
            own = cell_number(float(done.values[-1][k, number]))
        last = self.newton.last.get(number)
        if last is None:
            # its cells do not solve: right for the inputs of the file only
            return f"IF(AND({self.status.same_input(k)}),{own},NA())"
        iterate = f'IF(converged="yes",{NEWTON}!{column_name(last)}{row},NA())'
        return iterate if done.live[k] else f'IF(as_solved="yes",{own},{iterate})'

    def _equations(self) -> None:
        book = self.book
        squares: Any = np.zeros(book.count)
        for block in book.closure.blocks:
            for row in block.rows:
                column = self.columns.of[f"row {row.name}"]
                book.head(self.sheet, column, row.name, "")
                values = book.column(self.sheet, column, row.formula, "small")
                squares = squares + values**2
        if not self.columns.equations:
            return
        book.head(self.sheet, self.columns.squares, "ΣF²", "")
        first = column_name(self.columns.equations[0])
        last = column_name(self.columns.equations[-1])
        for k, value in enumerate(squares.tolist()):
            row_number = FIRST + k + 1
            formula = f"=SUMSQ({first}{row_number}:{last}{row_number})"
            book.put(self.sheet, k, self.columns.squares, formula, "small", value)

    def _rest(self) -> None:
        """Write points, links and outputs, each from preceding ones."""
        book, closure = self.book, self.book.closure
        for point, pair in closure.points.items():
            for axis, formula in zip("xy", pair, strict=True):
                key = coordinate_name(point, axis)
                column = self.columns.of[key]
                book.head(self.sheet, column, f"{point}.{axis}", book.unit("length"))
                book.values[key] = book.column(self.sheet, column, formula, "number")
        for link, formula in closure.links.items():
            column = self.columns.of[canonical(link)]
            book.head(self.sheet, column, link, book.unit("angle"))
            book.values[canonical(link)] = book.column(self.sheet, column, formula, "number")
        kinds = {name: output.kind for name, output in book.model.equations.outputs.items()}
        for name, formula in closure.outputs.items():
            column = self.columns.of[f"output {name}"]
            book.head(self.sheet, column, name, book.model.units.of(Kind(kinds[name])))
            book.values[f"output {name}"] = book.column(self.sheet, column, formula, "number")

    def _check(self) -> None:
        book, columns = self.book, self.columns
        book.head(self.sheet, columns.as_solved, "as solved", "by Linkwork")
        book.head(self.sheet, columns.largest, "difference", "relative")
        book.head(self.sheet, columns.closes, "closes", "")
        self.sheet.write(FIRST - 2, columns.status, "status", book.style["head_indented"])
        self.sheet.write(FIRST - 1, columns.status, "", book.style["unit"])
        status = self.status
        for k, found in enumerate(book.iterations.found.tolist()):
            closes = "yes" if found else "NO"
            said = statement(book, int(book.iterations.rows[k]))
            for column, formula, value, look in (
                (columns.as_solved, status.as_solved(k), "yes", "right"),
                (columns.largest, status.difference(k), 0.0 if found else "-", "relative"),
                (columns.closes, status.closes(k), closes, "right"),
                (columns.status, status.status(k), said, "status"),
            ):
                own = book.style[look]
                self.sheet.write_formula(FIRST + k, column, f"={formula}", own, value)
        self._highlight()

    def _highlight(self) -> None:
        """Colour the statuses, and fade cells without a value."""
        book, columns = self.book, self.columns
        last = book.last - 1
        no = {"type": "cell", "criteria": "==", "value": '"NO"', "format": book.style["wrong"]}
        self.sheet.conditional_format(FIRST, columns.closes, last, columns.closes, no)
        for text, look in (("proved for", "good"), ("not proved", "doubtful"), ("no ", "lost")):
            rule = {
                "type": "text", "criteria": "begins with" if look != "doubtful" else "containing",
                "value": text, "format": book.style[look],
            }  # fmt: skip
            self.sheet.conditional_format(FIRST, columns.status, last, columns.status, rule)
        faded = {"type": "errors", "format": book.style["faded"]}
        self.sheet.conditional_format(FIRST, 1, last, columns.closes, faded)
