"""The first sheet of a workbook: instructions, units, evidence, equations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from linkwork.equations.writing import EquationSheet
from linkwork.export.workbook.book import CYCLE, FIRST, Book, column_name
from linkwork.export.workbook.cycle_columns import CycleColumns
from linkwork.export.workbook.load_cells import force_problem
from linkwork.export.workbook.page_layout import print_on_one_page
from linkwork.export.workbook.status_formulas import statement
from linkwork.foundation.certification import Certification

__all__ = ["notices", "write_about"]

_ONE_PAGE = 70  # rows
_WIDTH = 110  # characters per line of equations
_LINE, _LINE_LENGTH = 15.0, 95  # height of a text line, and its characters


def write_about(book: Book, sheet: Any, columns: CycleColumns, version: str) -> None:
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
    for line in EquationSheet(book.model.equations).text(_WIDTH).splitlines():
        row += 1
        sheet.write_string(row, 0, line, style["code"])
    print_on_one_page(sheet, tall=1 if row < _ONE_PAGE else 0)


def _facts(book: Book, version: str) -> Iterator[tuple[str, str]]:
    description, count = book.model.description, book.count
    yield (
        "How to use it",
        (
            "Edit a yellow cell of the sheet Dimensions: the formulas of the sheet Newton solve "
            "all rows of Cycle again, and Velocities follows. Drawing shows the row whose number "
            "you enter there."
        ),
    )
    if description.source:
        yield "Source", description.source
    yield "Written by", f"Linkwork {version}; the sheet Linkwork contains its results"
    unit = book.unit("angle")
    yield "Units", f"lengths in {description.length}, angles in {unit}, counter-clockwise"
    yield (
        "Names",
        (
            "A name that looks like a cell gets an underscore: a2 becomes a2_. Names of unknowns "
            "and points refer to the row of the formula."
        ),
    )
    yield "Rows", f"{count} values of the input, {int(book.iterations.found.sum())} with a position"
    statuses = ", ".join(f"{s.name} {n}" for s, n in book.motion.counts.items())
    proved = sum(c is Certification.CERTIFIED for c in book.motion.certification)
    yield (
        "By Linkwork",
        (
            f"{statuses}; {proved} of {len(book.motion)} rows proved, for the dimensions and "
            "inputs of the file. The lines below and the statuses of Cycle follow the cells."
        ),
    )
    yield "Iterations in every row", str(book.iterations.count)


def _checks(book: Book, sheet: Any, columns: CycleColumns, row: int) -> int:
    """Checks of the cells, as formulas."""
    style = book.style
    rows = f"{FIRST + 1}", f"{book.last}"

    def whole(column: int) -> str:
        letter = column_name(column)
        return f"{CYCLE}!{letter}{rows[0]}:{letter}{rows[1]}"

    found = int(book.iterations.found.sum())
    lines: list[tuple[str, str, float, str]] = []
    if found:
        largest = f"=MAX({whole(columns.largest)})"
        lines.append(("Largest relative difference", largest, 0.0, "result"))
    closing = f'=COUNTIF({whole(columns.closes)},"yes")'
    lines.append(("Rows with a position", closing, found, "result_count"))
    proved = f'=COUNTIF({whole(columns.status)},"proved for*")'
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
            own = ", ".join(book.shown(unknowns[k]) for k in block.unknowns)
            yield f"{own}: {block.reason}; the column contains Linkwork's values"
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
    outputs = [name for name in book.motion.outputs if name not in book.closure.outputs]
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
        yield f"rows that start from estimates of their own, yellow cells of Newton: {apart}"
    added = int(np.count_nonzero(book.motion.added))
    if added:
        yield (
            f"{added} rows in addition to the table, at limits and on further branches, are on "
            "the sheet Linkwork only"
        )
