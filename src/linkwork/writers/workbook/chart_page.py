"""The sheet with charts of unknowns and outputs over the input."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from linkwork.core.equations.writing import EquationSheet
from linkwork.core.foundation.statuses import Certification
from linkwork.core.results.quantity import Kind
from linkwork.writers.workbook.book import CYCLE, FIRST, Book, chart_text, column_name
from linkwork.writers.workbook.cycle_page import statement
from linkwork.writers.workbook.layout import PRINTED, add_curve, print_on_one_page, print_table
from linkwork.writers.workbook.load_cells import force_problem

_CHART_PAGE_WIDTH, _HEIGHT, _ROWS = 1100, 400, 21
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
    curves = [
        (v.symbol, book.shown(v))
        for v in book.model.equations.unknowns
        if v.kind == kind.value and v.name in book.motion.unknowns
    ]
    outputs = (quantity for quantity in book.closure.quantities if quantity.of == "output")
    return curves + [(output.key, output.shown) for output in outputs if output.kind is kind]


def _chart(book: Book, kind: Kind, curves: list[tuple[str, str]], columns: dict[str, int]) -> Any:
    chart = book.workbook.add_chart({"type": "scatter", "subtype": "straight"})
    leading, rows = book.leading, (FIRST, book.last - 1)
    for key, name in curves:
        look = {"name": name, "line": {"width": 1.75}}
        add_curve(chart, CYCLE, rows, (columns[leading.symbol], columns[key]), look)
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
    chart.set_size({"width": _CHART_PAGE_WIDTH, "height": _HEIGHT})
    return chart


def _right_angles(span: float) -> float:
    """Degrees between gridlines."""
    return next((d for d in (5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0) if span / d <= 13), 360.0)


# ----------------------------------------------------------------------
# The sheet of Linkwork's results, for comparison.


_WIDEST, _STATEMENT = 24, 40  # width of columns


def write_linkwork(book: Book, sheet: Any) -> None:
    """Write all columns of the motion's table and further quantities at full precision."""
    motion, style = book.motion, book.style
    table = motion.table()
    further = motion.table(*book.further) if book.further else table
    said = {"statement": np.array([statement(book, row) for row in range(len(motion))])}
    columns = {**table.columns, **said, **further.columns}
    units = {**table.units, "statement": "", **further.units}
    book.title(sheet, "values by Linkwork")
    sheet.write(
        1, 0,
        "Numbers only: this sheet does not recalculate. Its statements hold for the inputs in the "
        "same row and the dimensions that Linkwork solved.", style["note"],
    )  # fmt: skip
    widths = [
        _STATEMENT if name == "statement" else min(max(12, len(name) + 2), _WIDEST)
        for name in columns
    ]
    last = min(len(motion), PRINTED)
    repeated = len(book.model.equations.inputs)
    print_table(sheet, widths, repeated, FIRST + last - 1)
    if len(motion) > last:
        sheet.write(2, 0, f"Printed: the first {last} rows.", style["note"])
    for column, (name, values) in enumerate(columns.items()):
        numeric = values.dtype.kind in "fiu"
        sheet.write_string(FIRST - 2, column, name, style["head" if numeric else "head_left"])
        sheet.write_string(FIRST - 1, column, units[name], style["unit"])
        look = style["small"] if name in ("residual", "condition") else style["general"]
        write = sheet.write_number if numeric else sheet.write
        for k, value in enumerate(values.tolist()):
            if not isinstance(value, float) or math.isfinite(value):
                write(FIRST + k, column, value, look)
    sheet.freeze_panes(FIRST, 1)


# ----------------------------------------------------------------------
# The first sheet of a workbook: instructions, units, evidence, equations.


_ONE_PAGE = 70  # rows
_ABOUT_PAGE_WIDTH = 110  # characters per line of equations
_LINE, _LINE_LENGTH = 15.0, 95  # height of a text line, and its characters


def write_about(book: Book, sheet: Any, columns: dict[str, int], version: str) -> None:
    """Write title, instructions, parts that do not recalculate, Linkwork's evidence, equations."""
    style, description = book.style, book.model.description
    sheet.hide_gridlines(2)
    sheet.set_column(0, 0, 30)
    sheet.set_column(1, 1, 100)
    sheet.write(0, 0, description.name, style["title"])
    row = 2
    for head, text in _facts(book, version):
        sheet.write(row, 0, head, style["head_left"])
        _wrapped(sheet, row, text, style["wrapped"])
        row += 1
    row = _checks(book, sheet, columns, row + 1)
    row = _listed(book, sheet, row + 1, "To note", list(notices(book)), "warning")
    limits = [book.motion.message] if book.motion.limits or not book.motion.found.all() else []
    row = _listed(book, sheet, row, "Limits of the motion", limits, "wrapped")
    row += 1
    sheet.write(row, 0, "Equations", style["heading"])
    sheet.write(row, 1, "", style["heading"])
    for line in EquationSheet(book.model.equations).text(_ABOUT_PAGE_WIDTH).splitlines():
        row += 1
        sheet.write_string(row, 0, line, style["code"])
    print_on_one_page(sheet, tall=1 if row < _ONE_PAGE else 0)


def _facts(book: Book, version: str) -> list[tuple[str, str]]:
    description, count = book.model.description, book.count
    statuses = ", ".join(f"{s.name} {n}" for s, n in book.motion.counts.items())
    proved = sum(c is Certification.CERTIFIED for c in book.motion.certification)
    source = [("Source", description.source)] if description.source else []
    use = (
        "Edit a yellow cell of the sheet Dimensions: the formulas of the sheet Newton solve all "
        "rows of Cycle again, and Velocities follows. Drawing shows the row whose number you enter "
        "there."
    )
    units = f"in {description.length}, angles in {book.unit('angle')}, counter-clockwise"
    names = (
        "A name that looks like a cell gets an underscore: a2 becomes a2_. Names of unknowns and "
        "points refer to the row of the formula."
    )
    solved = int(book.iterations.found.sum())
    evidence = (
        f"{statuses}; {proved} of {len(book.motion)} rows proved, for the dimensions and inputs of "
        "the file. The lines below and the statuses of Cycle follow the cells."
    )
    return [
        ("How to use it", use),
        *source,
        ("Written by", f"Linkwork {version}; the sheet Linkwork contains its results"),
        ("Units", f"lengths {units}"),
        ("Names", names),
        ("Rows", f"{count} values of the input, {solved} with a position"),
        ("By Linkwork", evidence),
        ("Iterations in every row", str(book.iterations.count)),
    ]


def _checks(book: Book, sheet: Any, columns: dict[str, int], row: int) -> int:
    """Checks of the cells, as formulas."""
    style = book.style
    rows = f"{FIRST + 1}", f"{book.last}"

    def whole(key: str) -> str:
        letter = column_name(columns[key])
        return f"{CYCLE}!{letter}{rows[0]}:{letter}{rows[1]}"

    solved = int(book.iterations.found.sum())
    lines: list[tuple[str, str, float, str]] = []
    if solved:
        largest = f"=MAX({whole('difference')})"
        lines.append(("Largest relative difference", largest, 0.0, "result"))
    closing = f'=COUNTIF({whole("closes")},"yes")'
    lines.append(("Rows with a position", closing, solved, "result_count"))
    proved = f'=COUNTIF({whole("status")},"proved for*")'
    certified = sum(statement(book, int(k)).startswith("proved for") for k in book.iterations.rows)
    lines.append(("Rows still proved", proved, certified, "result_count"))
    lines.append(("Changed cells", "=changes", 0, "result_count"))
    for head, formula, value, look in lines:
        sheet.write(row, 0, head, style["head_left"])
        sheet.write_formula(row, 1, formula, style[look], value)
        row += 1
    return row


def _listed(book: Book, sheet: Any, row: int, title: str, lines: list[str], look: str) -> int:
    if not lines:
        return row
    sheet.write(row, 0, title, book.style["head_left"])
    for line in lines:
        _wrapped(sheet, row, line, book.style[look])
        row += 1
    return row + 1


def _wrapped(sheet: Any, row: int, text: str, look: Any) -> None:
    """A long text broken into lines."""
    sheet.write(row, 1, text, look)
    sheet.set_row(row, _LINE * -(-len(text) // _LINE_LENGTH))


def notices(book: Book) -> Iterator[str]:
    """The parts that do not follow the yellow cells, with reasons, and special rows."""
    unknowns = book.model.equations.unknowns
    for block in book.closure.blocks:
        if block.reason:
            listed = ", ".join(book.shown(unknowns[k]) for k in block.unknowns)
            yield f"{listed}: {block.reason}; the column contains Linkwork's values"
    fixed = [d.name for d in book.dimensions if not d.live]
    if fixed:
        yield (
            f"{', '.join(fixed)}: no formula connects these with the equations; they keep the "
            "values of the file"
        )
    names = {d.key: d.name for d in book.dimensions}
    settled = [names.get(key, key) for key in book.traced.settled]
    if settled:
        yield f"{', '.join(settled)}: gear ratios keep the values of the file"
    keys = {quantity.key for quantity in book.closure.quantities}
    outputs = [name for name in book.motion.outputs if f"output {name}" not in keys]
    if outputs:
        yield f"{', '.join(outputs)}: values on the sheet Linkwork only"
    held = int((book.iterations.found & ~book.iterations.live).sum())
    if held:
        yield (
            f"{held} rows: Newton-Raphson does not converge there, as at a change point; they "
            "contain Linkwork's values until something changes"
        )
    problem = force_problem(book)
    if problem:
        yield f"no sheets of forces: {problem}"
    lost = book.count - int(book.iterations.found.sum())
    if lost:
        yield f"rows without a position, with Linkwork's reason in their status: {lost}"
    done = book.iterations
    apart = int((done.live & (done.above < 0)).sum()) - 1
    if apart > 0:
        yield f"rows that start from separate estimates, yellow cells of Newton: {apart}"
    added = int(np.count_nonzero(book.motion.added))
    if added:
        yield (
            f"{added} rows in addition to the table, at limits and on further branches, are on "
            "the sheet Linkwork only"
        )
