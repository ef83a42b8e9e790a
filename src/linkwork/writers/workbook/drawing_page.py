"""The sheet that draws the mechanism in a selected row."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.writers.workbook.book import CYCLE, FIRST, Book, cached, chart_text, column_name
from linkwork.writers.workbook.layout import add_curve, print_on_one_page

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
    _Page(book, sheet, columns).write()


@dataclass(frozen=True)
class _Line:
    """A drawn line: name, points and style."""

    name: str
    points: tuple[str, ...]
    look: dict[str, Any]


@dataclass
class _Page:
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
