"""The data shared by the sheets of a workbook: names of cells, values, first and last rows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.equations.model import Variable
from linkwork.export.formulas.cell_formula import CellFormula
from linkwork.export.formulas.closure_formulas import ClosureFormulas
from linkwork.export.formulas.rate_formulas import RateFormulas
from linkwork.export.formulas.traced_equations import Dimension, TracedEquations
from linkwork.export.workbook.cell_names import CellNames
from linkwork.export.workbook.iterations import Iterations
from linkwork.export.workbook.style import Style
from linkwork.expression.tree import names_in
from linkwork.foundation.arrays import Array
from linkwork.foundation.names import canonical, pretty
from linkwork.mechanism.figures import Disc
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = [
    "CYCLE",
    "DIMENSIONS",
    "FIRST",
    "FORCES",
    "LINKWORK",
    "NEWTON",
    "NO_VALUE",
    "VELOCITIES",
    "Book",
    "apart",
    "cached",
    "column_name",
]

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
            wanted = dimension.name if dimension.kind == "dimensions" else _cell_stem(dimension)
            self.names.claim(dimension.key, wanted)
            self.values[dimension.key] = dimension.value
        for k, variable in enumerate(self.variables):
            self.names.claim(variable.symbol, variable.shown)
            self.values[variable.symbol] = self.iterations.values[-1][:, k]
        for variable in self.model.equations.inputs:  # known in rows without a position, too
            own = self.motion.inputs[variable.name]
            self.values[variable.symbol] = own[self.iterations.rows]
        for link in self.closure.links:
            self.names.claim(canonical(link), f"theta_{link}")
        for point in self.closure.points:
            for axis in "xy":
                self.names.claim(coordinate_name(point, axis), f"{point}.{axis}")
        for part in self.closure.coefficients.values():
            self.names.claim(part.key, part.wanted)
            self.values[part.key] = float(part.formula.value(self.values))
        for name in self.closure.outputs:
            self.names.claim(f"output {name}", name)

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Unknowns, then inputs."""
        return self.model.equations.variables

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
        return np.array([self.scale(variable) for variable in self.variables])

    @cached_property
    def dimensions(self) -> list[Dimension]:
        """The dimensions with cells: those of the file, and points used by formulas."""
        kept = ("dimensions", "lengths", "angles")
        # a sketch has many points that formulas do not use
        return [d for d in self.traced.dimensions if d.kind in kept or d.key in self.used]

    @cached_property
    def used(self) -> set[str]:
        """The keys of everything that a formula uses, derived dimensions included."""
        found = set(self._used())
        for dimension in reversed(self.traced.dimensions):
            if dimension.key in found and dimension.formula is not None:
                found |= {node.name for node in names_in(dimension.formula)}
        return found

    def _used(self) -> Iterator[str]:
        closure = self.closure
        formulas = [part.formula for part in closure.coefficients.values()]
        formulas += [formula for pair in closure.points.values() for formula in pair]
        formulas += [*closure.links.values(), *closure.outputs.values()]
        formulas += [formula for pair in self.rates.of.values() for formula in pair]
        formulas += [released for _, released in closure.released]
        for block, sides in zip(closure.blocks, self.rates.sides, strict=True):
            formulas += [formula for pair in sides for formula in pair]
            for row in block.rows:
                formulas += [row.formula, *row.slopes]
        for formula in formulas:
            yield from (node.name for node in names_in(formula.node))

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
        discs = self.model.skeleton.of(Disc)
        return [(d.name, d.center, d.radius) for d in discs if d.center in self.closure.points]

    def solved(self, unknown: int) -> bool:
        """Whether cells solve for an unknown; otherwise they contain its values."""
        return any(block.rows and unknown in block.unknowns for block in self.closure.blocks)

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

    def text(self, formula: CellFormula, **instead: str) -> str:
        """The text of a formula in a cell."""
        return "=" + formula.text({**self.names.cells, **instead})

    def shown(self, variable: Variable) -> str:
        """The name of a variable in headings."""
        return pretty(variable.name)

    def define(self, key: str, sheet: str, place: str) -> None:
        """Define the name of a cell; ``$B1`` is column B of the row of the formula."""
        self.workbook.define_name(self.names.cells[key], f"={sheet}!{place}")

    def head(self, sheet: Any, column: int, title: str, unit: str) -> None:
        """Write a heading with unit above the rows of positions."""
        sheet.write(FIRST - 2, column, title, self.style["head"])
        sheet.write(FIRST - 1, column, unit, self.style["unit"])

    def title(self, sheet: Any, what: str) -> None:
        """Write the title of a sheet."""
        sheet.write(0, 0, f"{self.model.description.name}: {what}", self.style["title"])

    def group_heads(self, sheet: Any, groups: Iterable[tuple[str, int, int]]) -> None:
        """Write titles above groups of columns, from the first to the last column."""
        for title, first, last in groups:
            if first == last:
                sheet.write(FIRST - 3, first, title, self.style["group"])
            else:
                sheet.merge_range(FIRST - 3, first, FIRST - 3, last, title, self.style["group"])

    def row_numbers(self, sheet: Any) -> None:
        """Write the column of row numbers."""
        self.head(sheet, 0, "row", "")
        for k in range(self.count):
            sheet.write_number(FIRST + k, 0, k + 1, self.style["count"])

    def put(
        self, sheet: Any, k: int, column: int, formula: str, look: str, value: float | str
    ) -> None:
        """Write a formula in the row of position k, with its value, unless that is not known."""
        if not isinstance(value, str):
            known = math.isfinite(value) or self.iterations.found[k]
            value = cached(value) if known else NO_VALUE
        sheet.write_formula(FIRST + k, column, formula, self.style[look], value)

    def column(self, sheet: Any, column: int, formula: CellFormula, look: str) -> Array:
        """Write a formula in all rows; returns its values (R,)."""
        values = self.over_rows(formula.value(self.values))
        if not any(True for _ in names_in(formula.node)):
            for k, value in enumerate(values.tolist()):
                sheet.write_number(FIRST + k, column, value, self.style[look])
            return values
        shown = self.text(formula)
        for k, value in enumerate(values.tolist()):
            self.put(sheet, k, column, shown, look, value)
        return values

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
