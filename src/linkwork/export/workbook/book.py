"""The workbook that its sheets share: names of cells, numbers, first and last rows."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.equations.compiling import coordinate_name
from linkwork.equations.model import Variable
from linkwork.export.workbook.cell_formula import CellFormula
from linkwork.export.workbook.cell_names import CellNames
from linkwork.export.workbook.closure_formulas import ClosureFormulas
from linkwork.export.workbook.iterations import Iterations
from linkwork.export.workbook.style import Style
from linkwork.export.workbook.traced_equations import Dimension, TracedEquations
from linkwork.expression.tree import names_in
from linkwork.foundation.names import canonical, pretty
from linkwork.mechanism.figures import Disc
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = [
    "CYCLE",
    "DIMENSIONS",
    "FIRST",
    "LINKWORK",
    "NEWTON",
    "Book",
    "apart",
    "cached",
    "column_name",
]

DIMENSIONS, CYCLE, NEWTON, LINKWORK = "Dimensions", "Cycle", "Newton", "Linkwork"
FIRST = 6  # rows above the first position, on every sheet with a row for every position


def column_name(column: int) -> str:
    """``A``, ``B``, … ``AA`` of a column counted from 0."""
    shown = ""
    column += 1
    while column:
        # digits from 1 to 26: there is no zero in A, B, … AA
        column, rest = divmod(column - 1, 26)
        shown = chr(ord("A") + rest) + shown
    return shown


@dataclass
class Book:
    """A workbook while its sheets are written.

    ``values`` holds what formulas come to: numbers of dimensions, arrays (R,) of what
    every row has. ``further``: further quantities for the sheet of Linkwork's own values.
    """

    workbook: Any
    model: Model
    motion: Motion
    traced: TracedEquations
    closure: ClosureFormulas
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
    def dimensions(self) -> list[Dimension]:
        """The dimensions that have cells: those of the file, and points that formulas use."""
        used = set(self._used())  # a sketch has many points that nothing follows from
        kept = ("dimensions", "lengths", "angles")
        return [d for d in self.traced.dimensions if d.kind in kept or d.key in used]

    def _used(self) -> Iterator[str]:
        closure = self.closure
        formulas = [part.formula for part in closure.coefficients.values()]
        formulas += [formula for pair in closure.points.values() for formula in pair]
        formulas += [*closure.links.values(), *closure.outputs.values()]
        for block in closure.blocks:
            for row in block.rows:
                formulas += [row.formula, *row.slopes]
        for formula in formulas:
            yield from (node.name for node in names_in(formula.node))

    @cached_property
    def linkwork_columns(self) -> dict[str, int]:
        """Where the sheet of Linkwork's own values has which quantity."""
        return {name: k for k, name in enumerate(self.motion.table().columns)}

    @cached_property
    def model_circles(self) -> list[tuple[str, str, float]]:
        """Wheels to draw: name, centre, radius."""
        discs = self.model.skeleton.of(Disc)
        return [(d.name, d.center, d.radius) for d in discs if d.center in self.closure.points]

    def solved(self, unknown: int) -> bool:
        """Whether cells solve for an unknown; else they hold its values."""
        return any(block.rows and unknown in block.unknowns for block in self.closure.blocks)

    @property
    def count(self) -> int:
        """R: how many rows were asked for."""
        return len(self.iterations.rows)

    @property
    def last(self) -> int:
        """The number of the last position's row, as spreadsheets count."""
        return FIRST + self.count

    def unit(self, kind: str) -> str:
        """The unit of what a variable measures."""
        return self.model.units.of(Kind(kind))

    def scale(self, variable: Variable) -> float:
        """Internal units per file unit."""
        return self.model.units.scale(Kind(variable.kind))

    def text(self, formula: CellFormula, **instead: str) -> str:
        """A formula as a cell has it."""
        return "=" + formula.text({**self.names.cells, **instead})

    def shown(self, variable: Variable) -> str:
        """A variable as headings show it."""
        return pretty(variable.name)

    def define(self, key: str, sheet: str, place: str) -> None:
        """Give a cell its name; ``$B1`` is column B of the row that asks."""
        self.workbook.define_name(self.names.cells[key], f"={sheet}!{place}")

    def head(self, sheet: Any, column: int, title: str, unit: str) -> None:
        """A heading with its unit, above the rows of a sheet with a row for every position."""
        sheet.write(FIRST - 2, column, title, self.style["head"])
        sheet.write(FIRST - 1, column, unit, self.style["unit"])

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
    """What a cell shows until it is calculated."""
    return float(value) if math.isfinite(value) else ""


def apart(formula: str, row: int) -> str:
    """A formula whose column must not be calculated as one: every other row is in parentheses.

    Every row of Newton-Raphson needs the row above. LibreOffice calculates a column of the same
    formula at once, in several threads, and 7.4 comes to #VALUE! where that column needs itself.
    """
    return f"=({formula[1:]})" if row % 2 else formula
