"""The sheet of the editable cells: dimensions, the input's table, the first estimates."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import text
from linkwork.core.foundation.arrays import Array
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.formulas.closure_formulas import cell_number, of_radians
from linkwork.writers.formulas.rate_formulas import dimension_kinds, rate_key
from linkwork.writers.formulas.traced import Dimension
from linkwork.writers.workbook.book import (
    CYCLE,
    DIMENSIONS,
    FIRST,
    Book,
    add_curve,
    cached,
    chart_text,
    column_name,
    print_on_one_page,
)

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
    page = _DimensionPage(book, sheet)
    page.write()
    page.count_changes()
    sheet.freeze_panes(_TOP, 0)


@dataclass
class _DimensionPage:
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


# ----------------------------------------------------------------------
# The sheet that draws the mechanism in a selected row.


SHEET = "Drawing"
_SIDE = 640  # size of the chart [pixels]
_ROUND = 36  # points of a circle
_CHART, _CHART_ROWS, _CHART_COLUMNS = "E2", 32, 14  # corner, last row and column
_COLOURS = (
    "#1f6fb4", "#c8553d", "#3a8f5d", "#7d5ba6", "#b8860b", "#2a9d9d", "#a23b72", "#5f6c7b",
)  # fmt: skip
_ROW = 16.0  # height of a row, points
_TABLE = 60  # rows above the tables of the picture


def has_drawing(book: Book) -> bool:
    """Whether the mechanism can be drawn."""
    return bool(book.closure.points) and bool(book.iterations.found.any())


def write_drawing(book: Book, sheet: Any, columns: dict[str, int]) -> None:
    """Write row number, points and picture; ``columns`` are those of the positions."""
    _DrawingPage(book, sheet, columns).write()


@dataclass(frozen=True)
class _Line:
    """A drawn line: name, points and style."""

    name: str
    points: tuple[str, ...]
    look: dict[str, Any]


@dataclass
class _DrawingPage:
    book: Book
    sheet: Any
    columns: dict[str, int]

    def write(self) -> None:
        """Write the row number, its input, its points and the lines of the picture."""
        book, sheet, style = self.book, self.sheet, self.book.style
        sheet.set_default_row(_ROW)  # explicit row height, since other defaults distort the chart
        sheet.set_column(0, 0, 18)
        sheet.set_column(1, 2, 14)
        sheet.write(0, 0, f"{book.model.description.name}: drawing", style["title"])
        sheet.write(2, 0, "row shown", style["head_left"])
        sheet.write_number(2, 1, book.row_shown + 1, style["input"])
        limits = {"validate": "integer", "criteria": "between", "minimum": 1}
        message = {"error_title": "No such row", "error_message": f"Rows are 1 to {book.count}."}
        sheet.data_validation(2, 1, 2, 1, {**limits, "maximum": book.count, **message})
        book.names.claim("row shown", "row_shown")
        book.define("row shown", SHEET, "$B$3")
        row = 3
        for variable in book.model.equations.inputs:
            sheet.write(row, 0, f"{book.shown(variable)} [{book.unit(variable.kind)}]")
            self._picked(row, 1, variable.symbol)
            row += 1
        self._points(row + 1)
        self._chart()
        print_on_one_page(sheet, 0, 0, max(_CHART_ROWS, row + 2 + len(self.place)), _CHART_COLUMNS)

    def _picked(self, row: int, column: int, key: str) -> None:
        """A cell with a column's value in the displayed row."""
        letter = column_name(self.columns[key])
        source = f"INDEX({CYCLE}!${letter}${FIRST + 1}:${letter}${self.book.last},row_shown)"
        formula = f"=IF(ISNUMBER({source}),{source},NA())"
        value = float(self.book.over_rows(self.book.values[key])[self.book.row_shown])
        self.sheet.write_formula(row, column, formula, self.book.style["number"], cached(value))

    def _points(self, row: int) -> None:
        style = self.book.style
        for column, head in enumerate(("point", "x", "y")):
            self.sheet.write(row, column, head, style["head" if column else "head_left"])
        self.place: dict[str, int] = {}
        for point in self.book.closure.points:
            row += 1
            self.place[point] = row
            self.sheet.write(row, 0, point)
            for column, axis in enumerate("xy", 1):
                self._picked(row, column, coordinate_name(point, axis))
        self.bottom = max(row + 2, _TABLE)

    def _chart(self) -> None:
        book = self.book
        chart = book.workbook.add_chart({"type": "scatter", "subtype": "straight"})
        for point in book.model.description.trace:
            self._trace(chart, point)
        self.sheet.write(self.bottom - 1, 0, "lines of the picture", book.style["heading"])
        for line in self._lines():
            if sum(point in self.place for point in line.points) > 1:
                self._placed(chart, line.name, line.points, line.look)
        for circle in book.model_circles:
            self._circle(chart, *circle)
        self._ground(chart)
        low_x, low_y, span, step = self._box()
        axis = {
            "major_gridlines": {"visible": True, "line": {"color": "#e4e7eb", "width": 0.5}},
            "major_unit": step, "num_format": "General", "label_position": "low",
            "line": {"color": "#9aa5b1"},
        }  # fmt: skip
        unit = chart_text(book.unit("length"))
        chart.set_x_axis({**axis, "min": low_x, "max": low_x + span, "name": f"x [{unit}]"})
        chart.set_y_axis({**axis, "min": low_y, "max": low_y + span, "name": f"y [{unit}]"})
        chart.set_title(
            {"name": chart_text(book.model.description.name), "name_font": {"size": 13}}
        )
        chart.set_legend({"none": True})
        chart.set_size({"width": _SIDE, "height": _SIDE})
        layout = {"x": 0.11, "y": 0.09, "width": 0.80, "height": 0.80}
        chart.set_plotarea({"layout": layout})
        self.sheet.insert_chart(_CHART, chart)

    def _lines(self) -> Iterator[_Line]:
        skeleton = self.book.model.skeleton
        rail = {"line": {"color": "#9aa5b1", "width": 1.25, "dash_type": "dash"}}
        for guide in skeleton.guides:
            yield _Line(f"line of {guide.name}", guide.line, rail)
        for k, bar in enumerate(skeleton.bars):
            colour = {"color": _COLOURS[k % len(_COLOURS)]}
            pin = {"type": "circle", "size": 7, "fill": {"color": "#ffffff"}, "border": colour}
            look = {"line": {**colour, "width": 2.75}, "marker": pin}
            points = bar.points + bar.points[:1] if len(bar.points) > 2 else bar.points
            yield _Line(bar.name, points, look)
        for strut in skeleton.struts:
            look = {"line": {"color": "#5f6c7b", "width": 4.5}}
            yield _Line(strut.name, strut.between, look)

    def _placed(self, chart: Any, name: str, points: Sequence[str], look: dict[str, Any]) -> None:
        """A curve through those of the points that are on the sheet."""
        known = [point for point in points if point in self.place]
        corners = [[(f"={self._cell(p, k)}", self._value(p, k)) for k in (0, 1)] for p in known]
        self._curve(chart, name, corners, look)

    def _cell(self, point: str, k: int) -> str:
        """The cell of a coordinate of a point."""
        return f"{column_name(k + 1)}{self.place[point] + 1}"

    def _value(self, point: str, k: int) -> float:
        key = coordinate_name(point, "xy"[k])
        return float(self.book.over_rows(self.book.values[key])[self.book.row_shown])

    def _curve(
        self, chart: Any, name: str, corners: list[list[tuple[str, float]]], look: dict[str, Any]
    ) -> None:
        """A curve through points given by formulas and values, listed below each other."""
        if not corners:
            return
        first = self.bottom
        for corner in corners:
            self.sheet.write(self.bottom, 0, name)
            for column, (formula, value) in enumerate(corner, 1):
                at = self.bottom, column
                number = self.book.style["number"]
                self.sheet.write_formula(*at, formula, number, cached(value))
            self.bottom += 1
        add_curve(chart, SHEET, (first, self.bottom - 1), (1, 2), {"name": name, **look})
        self.bottom += 1

    def _circle(self, chart: Any, name: str, center: str, radius: float) -> None:
        """The rim of a wheel, by points about its centre."""
        corners = []
        for angle in range(0, 361, 360 // _ROUND):
            turned = math.cos(math.radians(angle)), math.sin(math.radians(angle))
            corner = []
            for k, function in enumerate(("COS", "SIN")):
                formula = f"={self._cell(center, k)}+{radius!r}*{function}(RADIANS({angle}))"
                corner.append((formula, self._value(center, k) + radius * turned[k]))
            corners.append(corner)
        self._curve(chart, name, corners, {"line": {"color": "#7b8794", "width": 1.25}})

    def _ground(self, chart: Any) -> None:
        """The fixed points as dark squares."""
        dark = {"color": "#1f2933"}
        marker = {"type": "square", "size": 8, "fill": dark, "border": dark}
        look = {"line": {"none": True}, "marker": marker}
        self._placed(chart, "ground", self.book.model.skeleton.fixed, look)

    def _trace(self, chart: Any, point: str) -> None:
        x, y = (self.columns[coordinate_name(point, axis)] for axis in "xy")
        look = {"name": f"path of {point}", "line": {"color": "#d64545", "width": 1}}
        add_curve(chart, CYCLE, (FIRST, self.book.last - 1), (x, y), look)

    def _box(self) -> tuple[float, float, float, float]:
        """A square around all rows: its corner, side and gridlines."""
        book = self.book
        lows, highs = [], []
        for axis in "xy":
            columns = [
                book.over_rows(book.values[coordinate_name(p, axis)]) for p in book.closure.points
            ]
            low, high = np.nanmin(columns), np.nanmax(columns)
            for _, center, radius in book.model_circles:
                series = book.over_rows(book.values[coordinate_name(center, axis)])
                low = min(low, np.nanmin(series) - radius)
                high = max(high, np.nanmax(series) + radius)
            lows.append(float(low))
            highs.append(float(high))
        widest = 1.16 * max(high - low for low, high in zip(lows, highs, strict=True)) or 1.0
        step = _nice(widest / 10)
        corners = [
            math.floor(((low + high) / 2 - widest / 2) / step) * step
            for low, high in zip(lows, highs, strict=True)
        ]
        return corners[0], corners[1], math.ceil(widest / step + 1) * step, step


def _nice(size: float) -> float:
    """The next larger 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(size))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= size)
