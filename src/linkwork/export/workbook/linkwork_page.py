"""The sheet of Linkwork's own results, for comparison."""

from __future__ import annotations

import math
from typing import Any

from linkwork.export.workbook.book import FIRST, Book

__all__ = ["write_linkwork"]

_WIDEST = 24


def write_linkwork(book: Book, sheet: Any) -> None:
    """Write all columns of the motion's table and further quantities at full precision."""
    motion, style = book.motion, book.style
    table = motion.table()
    further = motion.table(*book.further) if book.further else table
    columns = {**table.columns, **further.columns}
    units = {**table.units, **further.units}
    sheet.write(0, 0, f"{book.model.description.name}: values by Linkwork", style["title"])
    sheet.write(1, 0, "Numbers only; this sheet does not recalculate.", style["note"])
    for column, (name, values) in enumerate(columns.items()):
        numeric = values.dtype.kind in "fiu"
        sheet.set_column(column, column, min(max(12, len(name) + 2), _WIDEST))
        sheet.write(FIRST - 2, column, name, style["head" if numeric else "head_left"])
        sheet.write(FIRST - 1, column, units[name], style["unit"])
        look = style["small"] if name in ("residual", "condition") else style["general"]
        for k, value in enumerate(values.tolist()):
            if isinstance(value, float) and not math.isfinite(value):
                continue
            sheet.write(FIRST + k, column, value, look)
    sheet.freeze_panes(FIRST, 1)
