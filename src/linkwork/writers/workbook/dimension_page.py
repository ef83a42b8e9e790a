"""The sheet of the editable cells: dimensions, the input's table, the first estimates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import text
from linkwork.core.foundation.arrays import Array
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.formulas.closure_formulas import cell_number, of_radians
from linkwork.writers.formulas.rate_formulas import dimension_kinds, rate_key
from linkwork.writers.formulas.traced import Dimension
from linkwork.writers.workbook.book import CYCLE, DIMENSIONS, FIRST, Book, cached, column_name
from linkwork.writers.workbook.layout import print_on_one_page

_CLOSED = 1e-9  # of the longest link: a row with larger equation errors does not close
_TOP = 4  # rows above the sections
_EVEN = 1e-12  # of the largest value: rounding of an evenly spaced table
_HEADS = ("name", "value", "unit", "cell name", "by Linkwork", "", "note")
_WIDTHS = 24, 18, 8, 22, 18, 17, 60
_HEAD_LOOKS = {"value": "head", "by Linkwork": "head", "unit": "head_indented"}
_FLAG, _NOTE = 5, 6  # columns
_CHANGED, _UNUSED = "changed", "changed, not used"
_ROUNDED = 1e-13  # relative, also to the longest link: rounding of a computed cell


def input_table(values: Array) -> tuple[float, float] | None:
    """First value and step of evenly spaced values; ``None`` if they are not."""
    if len(values) == 1:
        return float(values[0]), 0.0
    step = float(f"{(values[-1] - values[0]) / (len(values) - 1):.14g}")
    first = float(values[0])
    even = first + step * np.arange(len(values))
    size = max(np.abs(values).max(), abs(step))
    return (first, step) if np.abs(even - values).max() <= _EVEN * size else None


def write_dimensions(book: Book, sheet: Any) -> None:
    """Write the sheet and name its cells."""
    for column, width in enumerate(_WIDTHS):
        sheet.set_column(column, column, width)
    sheet.repeat_rows(0, _TOP - 2)
    print_on_one_page(sheet, tall=0)
    book.title(sheet, "dimensions")
    about = 'Edit a yellow cell: all sheets recalculate. "By Linkwork" are the values it solved.'
    sheet.write(1, 0, about, book.style["note"])
    page = _Page(book, sheet)
    page.write()
    page.count_changes()
    sheet.freeze_panes(_TOP, 0)


@dataclass
class _Page:
    book: Book
    sheet: Any
    row: int = _TOP - 1

    def write(self) -> None:
        """Write all sections, one below the other."""
        self._dimensions()
        self._inputs()
        self._speeds()
        self._coefficients()
        self._estimates()
        self._tolerance()

    def count_changes(self) -> None:
        """Count the changed cells above the sections; other sheets use the counts."""
        flags = f"${column_name(_FLAG)}${_TOP + 1}:${column_name(_FLAG)}${self.row + 1}"
        for k, (key, shown, counted) in enumerate(
            (("changes", "changed cells", f"{_CHANGED}*"), ("unused_changes", "not used", _UNUSED))
        ):
            self.book.names.claim(key, key)
            self.sheet.write(2, 4 * k, shown, self.book.style["head_left"])
            formula = f'=COUNTIF({flags},"{counted}")'
            self.sheet.write_formula(2, 4 * k + 1, formula, self.book.style["result_count"], 0)
            place = f"${column_name(4 * k + 1)}$3"
            self.book.define(key, DIMENSIONS, place)
        area = _TOP, _FLAG, self.row, _FLAG
        rule = {"type": "text", "criteria": "begins with", "value": _CHANGED}
        self.sheet.conditional_format(*area, {**rule, "format": self.book.style["changed"]})

    def _watch(self, row: int, value: float, *, used: bool = True, computed: bool = False) -> None:
        """Write the value that Linkwork solved, and a mark if the cell differs from it."""
        cell, saved = f"B{row + 1}", f"E{row + 1}"
        same = f"{cell}={saved}"
        if computed:
            size = self.book.model.equations.length_scale
            near = cell_number(float(f"{_ROUNDED * max(abs(value), size):.1e}"))
            same = f"ABS({cell}-{saved})<={near}"
        self.sheet.write_number(row, 4, value, self.book.style["solved"])
        mark = _CHANGED if used else _UNUSED
        formula = f'=IF(ISNUMBER({cell}),IF({same},"","{mark}"),"{mark}")'
        self.sheet.write_formula(row, _FLAG, formula, self.book.style["text"], "")

    def _section(self, title: str) -> None:
        self.row += 1
        for column in range(len(_HEADS)):
            self.sheet.write(self.row, column, "", self.book.style["heading"])
        self.sheet.write(self.row, 0, title, self.book.style["heading"])
        self.row += 1
        for column, head in enumerate(_HEADS):
            look = _HEAD_LOOKS.get(head, "head_left")
            self.sheet.write(self.row, column, head, self.book.style[look])
        self.row += 1

    def _line(self, shown: str, unit: str, key: str, note: str) -> int:
        """Write a line without its value; returns its row."""
        row, name = self.row, self.book.names.cells[key]
        self.sheet.write(row, 0, shown)
        self.sheet.write(row, 2, unit, self.book.style["unit_right"])
        self.sheet.write(row, 3, name, self.book.style["code"])
        self.sheet.write(row, _NOTE, note, self.book.style["note"])
        self.book.define(key, DIMENSIONS, f"$B${row + 1}")
        self.row += 1
        return row

    def _dimensions(self) -> None:
        titles = {
            "dimensions": "Dimensions", "lengths": "Lengths", "angles": "Angles",
            "points": "Points", "sliders": "Offsets",
        }  # fmt: skip
        self._kinds = dimension_kinds(self.book.traced)
        for kind, title in titles.items():
            listed = [d for d in self.book.dimensions if d.kind == kind]
            if listed:
                self._section(title)
            for dimension in listed:
                self._dimension(dimension)

    def _dimension(self, dimension: Dimension) -> None:
        book = self.book
        kind = self._kinds.get(dimension.key, Kind.NUMBER)
        unit = {"dimensions": book.model.units.of(kind), "angles": book.unit("angle")}.get(
            dimension.kind, book.unit("length")
        )
        row = self._line(dimension.name, unit, dimension.key, self._note(dimension))
        if not dimension.live:
            self.sheet.write_number(row, 1, dimension.value, book.style["fixed"])
        elif dimension.formula is None:
            self.sheet.write_number(row, 1, dimension.value, book.style["input"])
        else:
            formula = of_radians(dimension.formula, book.model.equations.angle)
            shown = book.text(formula)
            self.sheet.write_formula(row, 1, shown, book.style["derived"], dimension.value)
        used = dimension.live and dimension.key in book.rates.used - set(book.traced.settled)
        computed = dimension.formula is not None and dimension.live
        self._watch(row, dimension.value, used=used, computed=computed)

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
            values = book.motion.inputs[variable.name][book.iterations.rows]
            table = input_table(values)
            for part, word in enumerate(("from", "step")):
                key = f"{word} {variable.symbol}"
                if table is None:
                    continue
                book.names.claim(key, f"{variable.shown}_{word}")
                row = self._line(
                    f"{book.shown(variable)} {word}", book.unit(variable.kind), key, ""
                )
                self.sheet.write_number(row, 1, table[part], book.style["input"])
                self.sheet.write_number(row, 4, table[part], book.style["solved"])
            if table is None:
                note = f"{book.shown(variable)}: its values are in the rows"
                self.sheet.write(self.row, 0, note, book.style["note"])
                self.row += 1

    def _speeds(self) -> None:
        """Write the speeds of the leading input and of the inputs that move with it."""
        book = self.book
        number, rates = book.lead
        lead = book.leading
        self._section("Speed of the input, for the sheet Velocities")
        for k, variable in enumerate(book.model.equations.inputs):
            key = rate_key(variable.symbol, 1)
            book.names.claim(key, f"{variable.shown}.velocity")
            unit = Rate.VELOCITY.unit(Kind(variable.kind), book.model.units, "")
            by = f"the derivatives by {book.shown(lead)}"
            note = "" if book.motion.speed else f"the file gives no speed: at 1 velocities are {by}"
            row = self._line(book.shown(variable), unit, key, "" if k != number else note)
            book.values[key] = book.speed * float(rates[k])
            if k == number:
                self.sheet.write_number(row, 1, book.speed, book.style["input"])
            else:
                formula = f"={self._ratio(variable)}"
                self.sheet.write_formula(row, 1, formula, book.style["derived"], book.values[key])

    def _ratio(self, variable: Variable) -> str:
        """The speed of an input that moves with the leading one."""
        book = self.book
        changes = []
        for driven in (variable, book.leading):
            step = book.names.cells.get(f"step {driven.symbol}")
            if step is None:
                letter = column_name(1 + book.model.equations.inputs.index(driven))
                step = f"({CYCLE}!{letter}{book.last}-{CYCLE}!{letter}{FIRST + 1})"
            changes.append(f"RADIANS({step})" if book.scale(driven) != 1.0 else step)
        speed = book.names.cells[rate_key(book.leading.symbol, 1)]
        return f"IF({changes[1]}=0,0,{speed}*{changes[0]}/{changes[1]})"

    def _estimates(self) -> None:
        """Write the estimates for the first row with a position."""
        book = self.book
        if not any(book.solved(k) for k in range(len(book.model.equations.unknowns))):
            return
        live = np.flatnonzero(book.iterations.live)
        self._section("Estimates for the first row")
        for k, variable in enumerate(book.model.equations.unknowns):
            if not book.solved(k):
                continue
            key = f"start {variable.symbol}"
            book.names.claim(key, f"{variable.shown}_start")
            row = self._line(book.shown(variable), book.unit(variable.kind), key, "")
            value = float(book.model.equations.start[k] / book.scales[k])
            if len(live):
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
            if isinstance(value, float):
                self._watch(row, value, computed=True)

    def _tolerance(self) -> None:
        book = self.book
        self._section("When a row counts as closed")
        book.names.claim("tolerance", "tolerance")
        note = "largest sum of squares of the equations of a closed row"
        row = self._line("tolerance", "", "tolerance", note)
        size = (_CLOSED * book.model.equations.length_scale) ** 2
        self.sheet.write_number(row, 1, size, book.style["input"])
