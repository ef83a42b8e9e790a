"""The sheet of Linkwork's own results, for comparison."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from linkwork.export.workbook.book import FIRST, Book
from linkwork.export.workbook.page_layout import PRINTED, print_table
from linkwork.export.workbook.status_formulas import statement

__all__ = ["write_linkwork"]

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
