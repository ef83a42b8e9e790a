"""Tables as CSV: UTF-8, ``%.17g``, lower-case true and false, empty cells for missing numbers.

Texts that a spreadsheet would calculate begin with an apostrophe.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator
from typing import Any

from linkwork.results.table import Table

__all__ = ["csv_lines", "csv_text"]


#: What formulas of spreadsheets begin with.
_FORMULAS = ("=", "+", "-", "@", "\t", "\r")


def csv_lines(table: Table) -> Iterator[str]:
    """The lines of the table, header first, each with a newline."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")

    def line(cells: list[str]) -> str:
        buffer.seek(0)
        buffer.truncate()
        writer.writerow(cells)
        return buffer.getvalue()

    yield line(list(table.columns))
    for row in table.rows():
        yield line([_cell(value) for value in row])


def csv_text(table: Table) -> str:
    """The whole table as text."""
    return "".join(csv_lines(table))


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        # a zero has no sign in a table
        return "" if math.isnan(value) else f"{value + 0.0:.17g}"
    text = str(value)
    formula = isinstance(value, str) and text.startswith(_FORMULAS)
    return f"'{text}" if formula else text
