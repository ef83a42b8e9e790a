"""Writes the cells of a sheet five times as fast as XlsxWriter does."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from linkwork.writers.workbook.book import FIRST, NO_VALUE, column_name

_OFTEN = 100  # rows between two calls of the progress function


class FastCells:
    """Overrides private methods of XlsxWriter's ``Worksheet``; without them cells are the same."""

    _progress: Callable[[float], None] | None = None
    _from, _per_row = 0.0, 0.0

    def follow(self, progress: Callable[[float], None], start: float, per_row: float) -> None:
        """Call ``progress`` with ``start`` + ``per_row`` · row while the sheet is written."""
        self._progress, self._from, self._per_row = progress, start, per_row

    def _prepare_formula(self, formula: str, *_: bool) -> str:
        """The formula without equals sign.

        XlsxWriter marks functions newer than the file format, by thirty regular expressions for
        every cell; no formula here has one.
        """
        return formula.removeprefix("=")

    def _write_cell(self: Any, row: int, column: int, cell: Any) -> None:
        """Write the element of a formula or number; other cells by XlsxWriter."""
        if column == 0 and row % _OFTEN == 0 and self._progress is not None:
            self._progress(self._from + self._per_row * row)
        kind = type(cell).__name__
        if cell.format is None or kind not in ("Formula", "Number"):
            super()._write_cell(row, column, cell)  # type: ignore[misc]
            return
        start = f'<c r="{column_name(column)}{row + 1}" s="{cell.format._get_xf_index()}"'
        if kind == "Number":
            self.fh.write(f"{start}><v>{float(cell.number)!r}</v></c>")
            return
        value = cell.value
        if isinstance(value, str):
            kept = "" if value == "" else ' t="e"' if value == NO_VALUE else ' t="str"'
            value = _escaped(value)
        else:
            kept = ""
        self.fh.write(f"{start}{kept}><f>{_escaped(cell.formula)}</f><v>{value}</v></c>")


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


# ----------------------------------------------------------------------
# How the sheets are printed: A4 landscape, headings on every page.


PRINTED = 30  # rows of tables of which only the first are printed
_A4 = 9
_MARGIN, _TOP = 0.4, 0.6  # inches
_ACROSS = 1020  # pixels at full size between the margins, with some to spare
_PER_LETTER, _PER_COLUMN = 7, 5  # pixels of a column's width
_SMALLEST = 45  # percent: 11 points become 5


def set_up_page(sheet: Any, name: str, mechanism: str) -> None:
    """Set paper, margins, header and footer."""
    sheet.set_landscape()
    sheet.set_paper(_A4)
    sheet.set_margins(left=_MARGIN, right=_MARGIN, top=_TOP, bottom=_TOP)
    shown = mechanism[:100].replace("&", "&&")
    sheet.set_header(f"&L&8{shown}&R&8{name}", {"margin": 0.3})
    sheet.set_footer("&R&8&P / &N", {"margin": 0.3})


def print_on_one_page(sheet: Any, *area: int, tall: int = 1) -> None:
    """Scale a sheet, or a part of it, to one page across and ``tall`` down, 0 for any number."""
    if area:
        sheet.print_area(*area)
    sheet.fit_to_pages(1, tall)


def print_table(sheet: Any, widths: Sequence[float], repeated: int, last: int) -> None:
    """Set the columns of a table of positions, to print on as few pages across as is readable.

    Parameters
    ----------
    widths : sequence of float
        Widths of all columns in letters.
    repeated : int
        The number of first columns that every page repeats.
    last : int
        The last row that is printed, from 0.
    """
    for column, width in enumerate(widths):
        sheet.set_column(column, column, width)
    pixels = [_PER_LETTER * width + _PER_COLUMN for width in widths]
    room = _ACROSS * 100 / _SMALLEST - sum(pixels[:repeated])
    across = max(math.ceil(sum(pixels[repeated:]) / room), 1)
    sheet.fit_to_pages(across, 0)
    sheet.repeat_rows(FIRST - 3, FIRST - 1)
    sheet.repeat_columns(0, repeated - 1)
    sheet.print_area(0, 0, last, len(widths) - 1)
