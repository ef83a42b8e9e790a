"""The sheet with charts of unknowns and outputs over the input."""

from __future__ import annotations

from typing import Any

from linkwork.export.workbook.book import CYCLE, FIRST, Book
from linkwork.export.workbook.cell_names import chart_text
from linkwork.results.quantity import Kind

__all__ = ["write_charts"]

_WIDTH, _HEIGHT, _ROWS = 1100, 400, 21
_PRINTED = 72  # percent: two charts on a page


def write_charts(book: Book, sheet: Any, columns: dict[str, int]) -> None:
    """Write one chart for each unit; ``columns`` are those of the positions."""
    sheet.write(0, 0, f"{book.model.description.name}: charts", book.style["title"])
    sheet.hide_gridlines(2)
    sheet.set_print_scale(_PRINTED)
    row = 2
    for kind in Kind:
        curves = _curves(book, kind)
        if curves:
            chart = _chart(book, kind, curves, columns)
            sheet.insert_chart(row, 0, chart)
            row += _ROWS
    sheet.set_h_pagebreaks(list(range(2 + 2 * _ROWS, row, 2 * _ROWS)))


def _curves(book: Book, kind: Kind) -> list[tuple[str, str]]:
    """Keys and names of all quantities of one kind."""
    equations = book.model.equations
    named = book.motion.unknowns
    found = [
        (v.symbol, book.shown(v))
        for v in equations.unknowns
        if v.kind == kind.value and v.name in named
    ]
    outputs = {name: equations.outputs[name].kind for name in book.closure.outputs}
    found += [(f"output {name}", name) for name, own in outputs.items() if own == kind.value]
    return found


def _chart(book: Book, kind: Kind, curves: list[tuple[str, str]], columns: dict[str, int]) -> Any:
    chart = book.workbook.add_chart({"type": "scatter", "subtype": "straight"})
    leading = next(
        (v for v in book.model.equations.inputs if _moves(book, v.name)),
        book.model.equations.inputs[0],
    )
    x = columns[leading.symbol]
    for key, name in curves:
        column = columns[key]
        chart.add_series(
            {
                "name": name,
                "categories": [CYCLE, FIRST, x, book.last - 1, x],
                "values": [CYCLE, FIRST, column, book.last - 1, column],
                "line": {"width": 1.75},
                "marker": {"type": "none"},
            }
        )
    values = book.motion.inputs[leading.name][book.iterations.rows]
    grid = {"visible": True, "line": {"color": "#e4e7eb", "width": 0.5}}
    axis: dict[str, Any] = {
        "name": f"{book.shown(leading)} [{chart_text(book.unit(leading.kind))}]",
        "min": float(values.min()), "max": float(values.max()),
        "major_gridlines": grid, "label_position": "low", "num_format": "General",
    }  # fmt: skip
    if leading.kind == "angle" and book.unit("angle") == "deg":
        axis["major_unit"] = _right_angles(float(values.max() - values.min()))
    chart.set_x_axis(axis)
    unit = chart_text(book.unit(kind.value))
    title = {"angle": "angles", "length": "lengths", "number": "numbers"}[kind.value]
    chart.set_y_axis({"name": f"{title} [{unit}]" if unit else title, "major_gridlines": grid})
    heading = f"{title.capitalize()} over {book.shown(leading)}"
    chart.set_title({"name": heading, "name_font": {"size": 13}})
    chart.set_legend({"position": "right"})
    chart.show_na_as_empty_cell()  # a gap where there is no position, not a line across
    chart.set_size({"width": _WIDTH, "height": _HEIGHT})
    return chart


def _moves(book: Book, name: str) -> bool:
    values = book.motion.inputs[name]
    return bool((values != values[0]).any())


def _right_angles(span: float) -> float:
    """Degrees between gridlines."""
    return next((d for d in (5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0) if span / d <= 13), 360.0)
