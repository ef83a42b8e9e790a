"""Names of cells: ``a2`` is the address of a cell, so the dimension a2 is called ``a2_``."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.expression.tree import Node
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
