"""The sheet of the editable cells: dimensions, the input's table, the first estimates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.export.workbook.book import DIMENSIONS, Book, cached
from linkwork.export.workbook.cell_formula import CellFormula
from linkwork.export.workbook.traced_equations import Dimension
from linkwork.expression.writing import text
from linkwork.foundation.arrays import Array

__all__ = ["input_table", "write_dimensions"]

_CLOSED = 1e-9  # of the longest link: a row with larger equation errors does not close
_EVEN = 1e-12  # of the largest value: rounding of an evenly spaced table
_HEADS = ("name", "value", "unit", "cell name", "note")


def input_table(values: Array) -> tuple[float, float] | None:
    """First value and step of evenly spaced values; ``None`` if they are not."""
    if len(values) == 1:
        return float(values[0]), 0.0
    step = float(f"{(values[-1] - values[0]) / (len(values) - 1):.12g}")
    first = float(values[0])
    even = first + step * np.arange(len(values))
    size = max(np.abs(values).max(), abs(step))
    return (first, step) if np.abs(even - values).max() <= _EVEN * size else None


def write_dimensions(book: Book) -> None:
    """Write the sheet and name its cells."""
    sheet = book.workbook.add_worksheet(DIMENSIONS)
    sheet.set_column(0, 0, 24)
    sheet.set_column(1, 1, 18)
    sheet.set_column(2, 2, 8)
    sheet.set_column(3, 3, 22)
    sheet.set_column(4, 4, 78)
    sheet.write(0, 0, f"{book.model.description.name}: dimensions", book.style["title"])
    sheet.write(1, 0, "Edit a yellow cell: all sheets recalculate.", book.style["note"])
    _Page(book, sheet).write()
    sheet.freeze_panes(2, 0)


@dataclass
class _Page:
    book: Book
    sheet: Any
    row: int = 2

    def write(self) -> None:
        """Write all sections, one below the other."""
        self._dimensions()
        self._inputs()
        self._estimates()
        self._coefficients()
        self._tolerance()

    def _section(self, title: str) -> None:
        self.row += 1
        for column in range(len(_HEADS)):
            self.sheet.write(self.row, column, "", self.book.style["heading"])
        self.sheet.write(self.row, 0, title, self.book.style["heading"])
        self.row += 1
        for column, head in enumerate(_HEADS):
            look = "head" if head == "value" else "head_left"
            self.sheet.write(self.row, column, head, self.book.style[look])
        self.row += 1

    def _line(self, shown: str, unit: str, key: str, note: str) -> int:
        """Write a line without its value; returns its row."""
        row, name = self.row, self.book.names.cells[key]
        self.sheet.write(row, 0, shown)
        self.sheet.write(row, 2, unit, self.book.style["unit_right"])
        self.sheet.write(row, 3, name, self.book.style["code"])
        self.sheet.write(row, 4, note, self.book.style["note"])
        self.book.define(key, DIMENSIONS, f"$B${row + 1}")
        self.row += 1
        return row

    def _dimensions(self) -> None:
        titles = {
            "dimensions": "Dimensions", "lengths": "Lengths", "angles": "Angles",
            "points": "Points", "sliders": "Offsets",
        }  # fmt: skip
        for kind, title in titles.items():
            found = [d for d in self.book.dimensions if d.kind == kind]
            if found:
                self._section(title)
            for dimension in found:
                self._dimension(dimension)

    def _dimension(self, dimension: Dimension) -> None:
        book = self.book
        unit = {"dimensions": "", "angles": book.unit("angle")}.get(
            dimension.kind, book.unit("length")
        )
        row = self._line(dimension.name, unit, dimension.key, self._note(dimension))
        if not dimension.live:
            self.sheet.write_number(row, 1, dimension.value, book.style["fixed"])
        elif dimension.formula is None:
            self.sheet.write_number(row, 1, dimension.value, book.style["input"])
        else:
            formula = CellFormula(dimension.formula, book.model.equations.angle)
            shown = book.text(formula)
            self.sheet.write_formula(row, 1, shown, book.style["derived"], dimension.value)

    def _note(self, dimension: Dimension) -> str:
        if not dimension.live:
            return "does not recalculate: the equations do not use this cell"
        parts = []
        if dimension.formula is not None:
            parts.append(f"= {text(dimension.formula)}")
        if dimension.key in self.book.traced.settled:
            parts.append("gear ratios in the equations keep the value above")
        if dimension.kind == "points" and self._sketched(dimension):
            parts.append("of the sketch: a dimension is measured from it")
        return "; ".join(parts)

    def _sketched(self, dimension: Dimension) -> bool:
        return dimension.name.rpartition(".")[0] not in self.book.model.equations.fixed

    def _inputs(self) -> None:
        book = self.book
        inputs = book.model.equations.inputs
        self._section("Input: first value and step of the rows")
        for variable in inputs:
            own = book.motion.inputs[variable.name][book.iterations.rows]
            table = input_table(own)
            for part, word in enumerate(("from", "step")):
                key = f"{word} {variable.symbol}"
                if table is None:
                    continue
                book.names.claim(key, f"{variable.shown}_{word}")
                row = self._line(
                    f"{book.shown(variable)} {word}", book.unit(variable.kind), key, ""
                )
                self.sheet.write_number(row, 1, table[part], book.style["input"])
            if table is None:
                note = f"{book.shown(variable)}: its values are in the rows"
                self.sheet.write(self.row, 0, note, book.style["note"])
                self.row += 1

    def _estimates(self) -> None:
        """Write the estimates for the first row with a position."""
        book = self.book
        live = np.flatnonzero(book.iterations.live)
        if not len(live):
            return
        self._section("Estimates for the first row")
        for k, variable in enumerate(book.model.equations.unknowns):
            if not book.solved(k):
                continue
            key = f"start {variable.symbol}"
            book.names.claim(key, f"{variable.shown}_start")
            row = self._line(book.shown(variable), book.unit(variable.kind), key, "")
            value = float(book.iterations.values[0][live[0], k])
            self.sheet.write_number(row, 1, value, book.style["input"])

    def _coefficients(self) -> None:
        book = self.book
        parts = book.closure.coefficients.values()
        if not parts:
            return
        self._section("Coefficients computed from them")
        for part in parts:
            row = self._line(part.wanted, "", part.key, "")
            value = cached(book.values[part.key])
            self.sheet.write_formula(row, 1, book.text(part.formula), book.style["derived"], value)

    def _tolerance(self) -> None:
        book = self.book
        self._section("When a row counts as closed")
        book.names.claim("tolerance", "tolerance")
        note = "largest sum of squares of the equations of a closed row"
        row = self._line("tolerance", "", "tolerance", note)
        size = (_CLOSED * book.model.equations.length_scale) ** 2
        self.sheet.write_number(row, 1, size, book.style["input"])
