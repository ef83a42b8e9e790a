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

    def _line(
        self, key: str, shown: str, unit: str, look: str, value: float | str, formula: str = "",
        *, name: str = "", note: str = "",
    ) -> int:  # fmt: skip
        """Write a number or formula in a cell, which gets a new name if there is one; its row."""
        row, style = self.row, self.book.style
        if name:
            self.book.names.claim(key, name)
        self.sheet.write(row, 0, shown)
        if formula:
            self.sheet.write_formula(row, 1, formula, style[look], value)
        else:
            self.sheet.write_number(row, 1, value, style[look])
        self.sheet.write(row, 2, unit, style["unit_right"])
        self.sheet.write(row, 3, self.book.names.of[key], style["code"])
        self.sheet.write(row, _NOTE, note, style["note"])
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
        look, formula = "input" if dimension.live else "fixed", ""
        if dimension.formula is not None and dimension.live:
            look = "derived"
            formula = book.text(of_radians(dimension.formula, book.model.equations.angle))
        key, note, value = dimension.key, self._note(dimension), dimension.value
        row = self._line(key, dimension.name, unit, look, value, formula, note=note)
        used = dimension.live and dimension.key in book.rates.used - set(book.traced.settled)
        self._watch(row, value, used=used, computed=bool(formula))

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
            table, shown = input_table(values), book.shown(variable)
            if table is None:
                note = f"{shown}: its values are in the rows"
                self.sheet.write(self.row, 0, note, book.style["note"])
                self.row += 1
                continue
            for word, value in zip(("from", "step"), table, strict=True):
                key, unit = f"{word} {variable.symbol}", book.unit(variable.kind)
                name = f"{variable.shown}_{word}"
                row = self._line(key, f"{shown} {word}", unit, "input", value, name=name)
                self.sheet.write_number(row, 4, value, book.style["solved"])

    def _speeds(self) -> None:
        """Write the speeds of the leading input and of the inputs that move with it."""
        book = self.book
        number, rates = book.lead
        lead = book.leading
        self._section("Speed of the input, for the sheet Velocities")
        for k, variable in enumerate(book.model.equations.inputs):
            key = rate_key(variable.symbol, 1)
            unit = Rate.VELOCITY.unit(Kind(variable.kind), book.model.units, "")
            by = f"the derivatives by {book.shown(lead)}"
            note = "" if book.motion.speed else f"the file gives no speed: at 1 velocities are {by}"
            leads = k == number
            look, formula = ("input", "") if leads else ("derived", f"={self._ratio(variable)}")
            value = book.values[key] = book.speed * float(rates[k])
            name, note = f"{variable.shown}.velocity", note if leads else ""
            shown = book.shown(variable)
            self._line(key, shown, unit, look, value, formula, name=name, note=note)

    def _ratio(self, variable: Variable) -> str:
        """The speed of an input that moves with the leading one."""
        book = self.book
        changes = []
        for driven in (variable, book.leading):
            step = book.names.of.get(f"step {driven.symbol}")
            if step is None:
                letter = column_name(1 + book.model.equations.inputs.index(driven))
                step = f"({CYCLE}!{letter}{book.last}-{CYCLE}!{letter}{FIRST + 1})"
            changes.append(f"RADIANS({step})" if book.scale(driven) != 1.0 else step)
        speed = book.names.of[rate_key(book.leading.symbol, 1)]
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
            value = float(book.model.equations.start[k] / book.scales[k])
            if len(live):
                value = float(book.iterations.values[0][live[0], k])
            key, name = f"start {variable.symbol}", f"{variable.shown}_start"
            unit = book.unit(variable.kind)
            self._line(key, book.shown(variable), unit, "input", value, name=name)

    def _coefficients(self) -> None:
        book = self.book
        parts = book.closure.coefficients.values()
        if not parts:
            return
        self._section("Coefficients computed from them")
        for part in parts:
            value, formula = cached(book.values[part.key]), book.text(part.formula)
            row = self._line(part.key, part.wanted, "", "derived", value, formula)
            if isinstance(value, float):
                self._watch(row, value, computed=True)

    def _tolerance(self) -> None:
        self._section("When a row counts as closed")
        note = "largest sum of squares of the equations of a closed row"
        size = (_CLOSED * self.book.model.equations.length_scale) ** 2
        self._line("tolerance", "tolerance", "", "input", size, name="tolerance", note=note)
