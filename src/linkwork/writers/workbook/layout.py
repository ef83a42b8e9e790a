"""Sheets: cells written fast, the print, and tables with a row for every position."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from linkwork.core.expression.tree import Name, Node, names_in
from linkwork.core.foundation.arrays import Array
from linkwork.writers.formulas.closure_formulas import value_of
from linkwork.writers.workbook.book import FIRST, NO_VALUE, Book, apart, cached, column_name

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


def add_curve(
    chart: Any, sheet: str, rows: tuple[int, int], columns: tuple[int, int], look: dict[str, Any]
) -> None:
    """Draw a curve through points in the rows from the first to the last, x and y in columns."""
    x, y = ([sheet, rows[0], column, rows[1], column] for column in columns)
    chart.add_series({"categories": x, "values": y, "marker": {"type": "none"}, **look})


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


# ----------------------------------------------------------------------
# A sheet with a row for every position, written column by column from left to right.


class Table:
    """The columns of a sheet.

    Columns belong to the present ``group``, whose title stands above them; ``of`` has their
    numbers by key.

    Parameters
    ----------
    book : Book
    name : str
        Of the sheet.
    sheet : Worksheet
    width : float
        Of a column in letters.
    chained : bool
        Whether rows start from the row above: their values are known only where cells solve.
    """

    def __init__(
        self, book: Book, name: str, sheet: Any, width: float = 14, *, chained: bool = False
    ) -> None:
        self.book, self.name, self.sheet, self.width = book, name, sheet, width
        self.chained = chained
        self.group = ""
        self.of: dict[str, int] = {}
        self.end = 0
        self._groups: list[tuple[str, int, int]] = []
        rows = self.add("row", "")
        for k in range(book.count):
            sheet.write_number(FIRST + k, rows, k + 1, book.style["count"])

    def add(self, title: str, unit: str, key: str = "", look: str = "head") -> int:
        """A new column with a heading; its cells have a name if there is one for the key."""
        column, book = self.end, self.book
        self.sheet.write(FIRST - 2, column, title, book.style[look])
        self.sheet.write(FIRST - 1, column, unit, book.style["unit"])
        if key in book.names.of:
            book.define(key, self.name, f"${column_name(column)}1")
        if self._groups and self._groups[-1][0] == self.group:
            self._groups[-1] = (self.group, self._groups[-1][1], column)
        else:
            self._groups.append((self.group, column, column))
        self.of[key] = column
        self.end += 1
        return column

    def put(self, k: int, column: int, formula: str, look: str, value: float | str) -> None:
        """Write a formula in the row of position k, with its value, unless that is not known."""
        done = self.book.iterations
        if self.chained:
            formula = apart(formula, FIRST + k)
            value = value if done.live[k] else ""
        if not isinstance(value, str):
            known = math.isfinite(value) or done.found[k] or self.chained
            value = cached(value) if known else NO_VALUE
        self.sheet.write_formula(FIRST + k, column, formula, self.book.style[look], value)

    def cells(self, column: int, text: Callable[[int], str], values: Array, look: str) -> None:
        """Write the formulas of all rows with their values."""
        for k, value in enumerate(values.tolist()):
            self.put(k, column, text(k), look, value)

    def formula(
        self,
        title: str,
        unit: str,
        formula: Node,
        look: str = "number",
        key: str = "",
        names: Mapping[str, str] | None = None,
        values: Mapping[str, Any] | None = None,
    ) -> Array:
        """Write a column of one formula; returns its values (R,).

        Parameters
        ----------
        names : Mapping[str, str], optional
            Keys of cells by names of the formula that are no keys.
        values : Mapping[str, Any], optional
            Other values of such names.
        """
        book, instead = self.book, names or {}
        column = self.add(title, unit, key)
        known = {name: book.values[of] for name, of in instead.items() if of in book.values}
        found = book.over_rows(value_of(formula, {**book.values, **known, **(values or {})}))
        if any(True for _ in names_in(formula)):
            cells = {name: book.names.of[of] for name, of in instead.items()}
            text = book.text(formula, **cells)
            self.cells(column, lambda k: text, found, look)
        else:
            for k, value in enumerate(found.tolist()):
                self.sheet.write_number(FIRST + k, column, value, book.style[look])
        if key:
            book.values[key] = found
        return found

    def inputs(self) -> None:
        """Write the columns of the inputs."""
        self.group = "Input"
        for variable in self.book.model.equations.inputs:
            unit = self.book.unit(variable.kind)
            self.formula(self.book.shown(variable), unit, Name(variable.symbol))

    def finish(self, what: str, note: str, repeated: int, last: int = 0, widest: float = 0) -> None:
        """Write the title, a note and the titles of groups; set the columns and the print.

        Parameters
        ----------
        repeated : int
            The number of first columns that every page repeats, and that stay visible.
        last : int
            The number of rows that are printed; all by default.
        widest : float
            The width of the last column.
        """
        book, sheet = self.book, self.sheet
        book.title(sheet, what)
        sheet.write(1, 0, note, book.style["note"])
        style = book.style["group"]
        for title, first, end in self._groups:
            if title and first == end:
                sheet.write(FIRST - 3, first, title, style)
            elif title:
                sheet.merge_range(FIRST - 3, first, FIRST - 3, end, title, style)
        widths = [6.0, *[self.width] * (self.end - 2), widest or self.width]
        print_table(sheet, widths, repeated, FIRST + (last or book.count) - 1)
        sheet.freeze_panes(FIRST, repeated)
