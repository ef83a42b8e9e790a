"""Names of cells: ``a2`` is the address of a cell, so the dimension a2 is called ``a2_``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import Name, Node, names_in
from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray, IndexArray
from linkwork.core.foundation.names import canonical, pretty
from linkwork.core.mechanism.bodies import DiscFigure
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.numerics.newton import corrections
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import (
    ClosureFormulas,
    UniqueNames,
    cell_text,
    value_of,
)
from linkwork.writers.formulas.rate_formulas import RateFormulas, rate_key
from linkwork.writers.formulas.traced import Dimension, TracedEquations

#: Names that spreadsheets read as a cell, row, column or Boolean.
_TAKEN = re.compile(r"[a-z]{1,3}[0-9]+|[rc][0-9]*([rc][0-9]*)?|true|false", re.IGNORECASE)
_ODD = re.compile(r"[^\w.]")
_LONGEST = 200


def chart_text(text: str) -> str:
    """A text for a chart's title or axis: XlsxWriter reads text like ``sheet!A1`` as a cell.

    An invisible character (U+2060, word joiner) after the mark makes it a text.
    """
    return text.replace("!", "!\u2060")


class CellNames(UniqueNames):
    """Valid names of cells by key."""

    def stem(self, preferred: str) -> str:
        """Letters, digits, underscores and points, no digit first, and no address of a cell."""
        stem = _ODD.sub("_", canonical(preferred).replace("'", "_prime"))[:_LONGEST]
        if not (stem[0].isalpha() or stem[0] == "_"):
            stem = f"_{stem}"
        return f"{stem}_" if _TAKEN.fullmatch(stem) else stem


# ----------------------------------------------------------------------
# The formats of the cells of a workbook.


_INK, _FAINT, _RULE = "#1f2933", "#7b8794", "#9aa5b1"
_FORMATS: dict[str, dict[str, Any]] = {
    "title": {"bold": True, "font_size": 16, "font_color": _INK},
    "heading": {"bold": True, "font_size": 12, "font_color": _INK, "bottom": 1},
    "group": {
        "bold": True, "align": "center", "bg_color": "#d9e2ec", "border": 1, "border_color": _RULE,
    },
    "head": {"bold": True, "align": "right", "shrink": True, "bg_color": "#eef2f6"},
    "head_left": {"bold": True, "align": "left", "valign": "top", "bg_color": "#eef2f6"},
    "unit": {
        "italic": True, "align": "right", "font_color": _FAINT, "bg_color": "#eef2f6", "bottom": 1,
    },
    "text": {},
    "wrapped": {"text_wrap": True, "valign": "top"},
    "note": {"italic": True, "font_color": _FAINT},
    "warning": {"text_wrap": True, "valign": "top", "font_color": "#9c3d00"},
    "code": {"font_name": "Consolas", "font_size": 10},
    "count": {"num_format": "0", "font_color": _FAINT},
    "number": {"num_format": "0.000000"},
    "general": {},
    "small": {"num_format": "0.0E+00"},
    "result": {"num_format": "0.0E+00", "align": "left"},
    "result_count": {"num_format": "0", "align": "left"},
    "unit_right": {"indent": 1},
    "slope": {"num_format": "0.0000"},
    "start": {"num_format": "0.000000", "left": 1, "left_color": _RULE},
    "input": {"bg_color": "#fff7cc", "font_color": "#0b3d91", "border": 1, "border_color": _RULE},
    "input_number": {
        "bg_color": "#fff7cc", "font_color": "#0b3d91", "num_format": "0.000000",
    },
    "derived": {"bg_color": "#e9f5ec", "border": 1, "border_color": _RULE},
    "value": {"italic": True, "font_color": _FAINT, "num_format": "0.000000"},
    "fixed": {
        "italic": True, "font_color": _FAINT, "bg_color": "#eceff1", "border": 1,
        "border_color": _RULE,
    },
    "right": {"align": "right"},
    "status": {"indent": 1, "shrink": True},
    "head_indented": {"bold": True, "align": "left", "indent": 1, "bg_color": "#eef2f6"},
    "relative": {"num_format": "0.0E+00", "align": "right"},
    "good": {"font_color": "#2d6a4f"},
    "doubtful": {"font_color": "#8d6708"},
    "lost": {"font_color": "#9c1c00"},
    "faded": {"font_color": "#b8c1cc"},
    "solved": {"font_color": _FAINT, "align": "right"},
    "changed": {"bg_color": "#ffe2b8", "bold": True},
    "wrong": {"bg_color": "#ffd9d1", "font_color": "#9c1c00", "bold": True},
}  # fmt: skip


class Style:
    """The formats of one workbook by name."""

    def __init__(self, workbook: Any) -> None:
        self._formats = {name: workbook.add_format(look) for name, look in _FORMATS.items()}

    def __getitem__(self, name: str) -> Any:
        return self._formats[name]


# ----------------------------------------------------------------------
# The values of the Newton cells, in which every row starts from the row above.


_FEWEST, _MOST = 3, 8  # iterations in a row of cells
_SPARE = 1  # additional iterations, for changed dimensions
_DONE = 1e-11  # weighted: a correction of this size is the last one needed
_RIGHT = 1e-10  # weighted: tolerance between the cells and the position


@dataclass(frozen=True, kw_only=True, eq=False)
class Iterations:
    """The iterations of R requested rows.

    Parameters
    ----------
    rows : (R,)
        Row numbers in the motion.
    values : (K + 1, R, N)
        Unknowns at every iterate, then inputs, in file units; NaN without a position.
    above : (R,)
        The row from which each row starts, -1 for a separate estimate.
    found, live : (R,) bool
        Rows with a position, and those whose cells converge to it.
    """

    rows: IndexArray
    values: Array
    above: IndexArray
    found: BoolArray
    live: BoolArray

    @property
    def count(self) -> int:
        """K: the number of iterations of every row."""
        return len(self.values) - 1


def iterated(model: Model, motion: Motion, closure: ClosureFormulas) -> Iterations:
    """Simulate the cells.

    A row that does not converge to its position from the row above starts from a rounded estimate
    of it; if that fails too, as at a change point, its cells contain values only.
    """
    rows = np.flatnonzero(motion.asked)
    scale = _file_units(model)
    inputs = np.stack([motion.inputs[v.name] for v in model.equations.inputs], axis=1)[rows]
    right = np.concatenate([motion.q[rows] / scale[: motion.q.shape[1]], inputs], axis=1)
    solved = motion.found[rows] & np.isfinite(right).all(axis=1)
    right[~solved] = np.nan
    before = np.full(len(rows), -1, dtype=np.intp)
    last = -1
    for k in range(len(rows)):
        before[k] = last
        # rows without a position are skipped: nothing can start from them
        last = k if solved[k] else last
    start, above = _rounded(model, right), np.full(len(rows), -1, dtype=np.intp)
    values = np.repeat(right[None], _MOST + 1, axis=0)
    live = np.zeros(len(rows), dtype=bool)

    def attempt(trying: IndexArray, guess: Array) -> IndexArray:
        """Try some rows from estimates; those whose cells converge to their positions."""
        tried = _newton(model, closure, guess, right[trying])
        away = np.abs((tried[-1] - right[trying]) * scale / _sizes(model)).max(axis=1, initial=0.0)
        good = away <= _RIGHT
        values[:, trying[good]] = tried[:, good]
        live[trying[good]] = True
        return trying[good]

    # each attempt takes the rows that the one before it could not recalculate
    behind = np.flatnonzero(solved & (before >= 0))
    converged = attempt(behind, right[before[behind]])
    above[converged] = before[converged]
    for estimates in (start, right):
        lost = np.flatnonzero(solved & ~live)
        attempt(lost, estimates[lost])
    needed = _needed(model, values[:, live])
    return Iterations(
        rows=rows,
        values=values[: min(max(needed + _SPARE, _FEWEST), _MOST) + 1],
        above=above,
        found=solved,
        live=live,
    )


def _file_units(model: Model) -> Array:
    """Internal units per file unit of all variables, (N,)."""
    turns = np.array([v.kind == "angle" for v in model.equations.variables])
    return np.where(turns, model.equations.angle.radians, 1.0)


def _sizes(model: Model) -> Array:
    return model.compiled.solver.variable_scale


def _rounded(model: Model, right: Array) -> Array:
    """Estimates rounded to three digits of a variable's size."""
    digits = [
        int(2 - np.floor(np.log10(size / unit)))
        for size, unit in zip(_sizes(model), _file_units(model), strict=True)
    ]
    columns = [np.round(column, d) for column, d in zip(right.T, digits, strict=True)]
    return np.stack(columns, axis=1) if columns else right


def _newton(model: Model, closure: ClosureFormulas, guess: Array, right: Array) -> Array:
    """Iterates of the cells, (K + 1, B, N), block by block with the values of earlier blocks."""
    scale = _file_units(model)
    known = right.copy()
    values = np.repeat(right[None], _MOST + 1, axis=0)
    for block, formulas in zip(model.compiled.solver.blocks, closure.blocks, strict=True):
        if not formulas.rows:
            continue
        unknowns = block.unknowns
        known[:, unknowns] = guess[:, unknowns]
        values[0][:, unknowns] = guess[:, unknowns]
        for k in range(_MOST):
            here = (known * scale)[:, block.variables]
            with np.errstate(all="ignore"):
                f, jacobian = block.system.residual_and_jacobian(here)
                # full steps: cells have no step control
                change, _ = corrections(jacobian[:, :, : len(unknowns)], f)
            known[:, unknowns] += change / scale[unknowns]
            values[k + 1][:, unknowns] = known[:, unknowns]
    return values


def _needed(model: Model, values: Array) -> int:
    """The number of iterations until all rows converge; the most if cells solve none."""
    if not values.shape[1]:
        return _MOST
    scale = _file_units(model) / _sizes(model)
    changes: AnyArray = np.abs(np.diff(values, axis=0) * scale).max(axis=(1, 2), initial=0.0)
    large = np.flatnonzero(changes > _DONE)
    return int(large[-1]) + 1 if len(large) else 1


# ----------------------------------------------------------------------
# The data shared by the sheets of a workbook: names of cells, values, first and last rows.


DIMENSIONS, CYCLE, VELOCITIES = "Dimensions", "Cycle", "Velocities"
NEWTON, LINKWORK, FORCES = "Newton", "Linkwork", "Forces"
NO_VALUE = "#N/A"
FIRST = 6  # rows above the first position, on sheets with a row for every position


@cache
def column_name(column: int) -> str:
    """``A``, ``B``, … ``AA`` of a column counted from 0."""
    shown = ""
    column += 1
    while column:
        # digits from 1 to 26: A, B, … AA has no zero
        column, rest = divmod(column - 1, 26)
        shown = chr(ord("A") + rest) + shown
    return shown


@dataclass
class Book:
    """A workbook under construction.

    ``values`` are the results of formulas: numbers of dimensions, arrays (R,) of quantities of
    every row. ``further``: further quantities for the sheet of Linkwork's values.
    """

    workbook: Any
    model: Model
    motion: Motion
    traced: TracedEquations
    closure: ClosureFormulas
    rates: RateFormulas
    iterations: Iterations
    further: tuple[str, ...] = ()
    names: CellNames = field(default_factory=CellNames)
    values: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.style = Style(self.workbook)
        for dimension in self.dimensions:
            stem = dimension.name if dimension.kind == "dimensions" else _cell_stem(dimension)
            self.names.claim(dimension.key, stem)
            self.values[dimension.key] = dimension.value
        for k, variable in enumerate(self.model.equations.variables):
            self.names.claim(variable.symbol, variable.shown)
            self.values[variable.symbol] = self.iterations.values[-1][:, k]
        for variable in self.model.equations.inputs:  # known in rows without a position, too
            series = self.motion.inputs[variable.name]
            self.values[variable.symbol] = series[self.iterations.rows]
        for quantity in self.closure.quantities:
            before = "theta_" if quantity.of == "link" else ""
            self.names.claim(quantity.key, f"{before}{quantity.shown}")
        for part in self.closure.coefficients.values():
            self.names.claim(part.key, part.wanted)
            self.values[part.key] = float(value_of(part.formula, self.values))
        for order, word in ((1, "velocity"), (2, "acceleration")):
            for key in (*(v.symbol for v in self.model.equations.unknowns), *self.rates.of):
                stem = self.names.of[key].rstrip("_")
                self.names.claim(rate_key(key, order), f"{stem}.{word}")

    @cached_property
    def lead(self) -> tuple[int, Array]:
        """The number of the leading input, and the rates of all inputs with respect to it."""
        values = np.stack([self.motion.inputs[v.name] for v in self.model.equations.inputs], axis=1)
        return leading_input(values * self.scales[len(self.model.equations.unknowns) :])

    @property
    def leading(self) -> Variable:
        """The leading input."""
        return self.model.equations.inputs[self.lead[0]]

    @property
    def speed(self) -> float:
        """The speed of the leading input [rad/s or length/s]; 1 if the file gives none."""
        return 1.0 if self.motion.speed is None else self.motion.speed

    @cached_property
    def scales(self) -> Array:
        """Internal units per file unit of all variables, (N,)."""
        return np.array([self.scale(variable) for variable in self.model.equations.variables])

    @cached_property
    def dimensions(self) -> list[Dimension]:
        """The dimensions with cells: those of the file, and points used by formulas."""
        kept = ("dimensions", "lengths", "angles")
        # a sketch has many points that formulas do not use
        return [d for d in self.traced.dimensions if d.kind in kept or d.key in self.rates.used]

    @cached_property
    def linkwork_columns(self) -> dict[str, int]:
        """The columns of quantities on the sheet of Linkwork's values."""
        return {name: k for k, name in enumerate(self.motion.table().columns)}

    @property
    def statements(self) -> int:
        """The column of Linkwork's statements on the sheet of its values."""
        return len(self.linkwork_columns)

    @cached_property
    def model_circles(self) -> list[tuple[str, str, float]]:
        """Wheels to draw: name, centre, radius."""
        discs = self.model.skeleton.of(DiscFigure)
        return [(d.name, d.center, d.radius) for d in discs if d.center in self.closure.points]

    def solved(self, unknown: int) -> bool:
        """Whether cells solve for an unknown; otherwise they contain its values."""
        return any(block.rows and unknown in block.unknowns for block in self.closure.blocks)

    @cached_property
    def row_shown(self) -> int:
        """The row with a position that the sheets of one row show first."""
        solved = np.flatnonzero(self.iterations.found)
        return int(solved[len(solved) // 6])

    @property
    def count(self) -> int:
        """R: the number of requested rows."""
        return len(self.iterations.rows)

    @property
    def last(self) -> int:
        """The row number of the last position, from 1."""
        return FIRST + self.count

    def unit(self, kind: str) -> str:
        """The unit of a variable."""
        return self.model.units.of(Kind(kind))

    def scale(self, variable: Variable) -> float:
        """Internal units per file unit."""
        return self.model.units.scale(Kind(variable.kind))

    def text(self, formula: Node, **instead: str) -> str:
        """The text of a formula in a cell."""
        return "=" + cell_text(formula, {**self.names.of, **instead})

    def shown(self, variable: Variable) -> str:
        """The name of a variable in headings."""
        return pretty(variable.name)

    def define(self, key: str, sheet: str, place: str) -> None:
        """Define the name of a cell; ``$B1`` is column B of the row of the formula."""
        self.workbook.define_name(self.names.of[key], f"={sheet}!{place}")

    def title(self, sheet: Any, what: str) -> None:
        """Write the title of a sheet."""
        sheet.write(0, 0, f"{self.model.description.name}: {what}", self.style["title"])

    def over_rows(self, values: Any) -> np.ndarray[Any, Any]:
        """Values as an array (R,)."""
        return np.broadcast_to(np.asarray(values, dtype=float), self.count)


def _cell_stem(dimension: Dimension) -> str:
    """``O2A`` for the length "O2 A", ``angle_BAP``, ``O4_x``, ``s16_offset``."""
    joined = dimension.name.replace(" ", "")
    if dimension.kind == "angles":
        return f"angle_{joined}"
    return joined.replace(".", "_")


def cached(value: float) -> float | str:
    """The value shown in a cell until it is calculated."""
    return float(value) if math.isfinite(value) else ""


def apart(formula: str, row: int) -> str:
    """A formula whose column must not be calculated in parallel: every other row is in parentheses.

    Every row of Newton-Raphson needs the row above. LibreOffice calculates a column of equal
    formulas in several threads, and version 7.4 returns #VALUE! if the column depends on itself.
    """
    return f"=({formula[1:]})" if row % 2 else formula


# ----------------------------------------------------------------------
# Sheets: cells written fast, the print, and tables with a row for every position.


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
