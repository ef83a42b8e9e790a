"""The sheet of positions: a row for every value of the input."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np

from linkwork.core.equations.model import Variable
from linkwork.core.foundation.statuses import Certification
from linkwork.writers.formulas.closure_formulas import cell_number, cell_text
from linkwork.writers.workbook.book import CYCLE, FIRST, LINKWORK, NEWTON, Book, apart, column_name
from linkwork.writers.workbook.dimension_page import input_table
from linkwork.writers.workbook.layout import Table
from linkwork.writers.workbook.newton_page import NewtonColumns

# ----------------------------------------------------------------------
# The status of a row as a formula: a proof is shown for the numbers that Linkwork proved only.


_LONGEST = 200  # characters of names in a text of a formula, which takes 255
_MOST_ARGUMENTS = 250  # of a function, which takes 255
_CELL_AGREES = 1e-9  # of a full size: cells that differ less from Linkwork's contain its position
_SAME_INPUT = 1e-12  # of the largest value: rounding of first value + step · k
_PROVED = {
    Certification.CERTIFIED: "proved for {}",
    Certification.CONFIGURATION_CERTIFIED: "proved for {}",
    Certification.SUBSET_CERTIFIED: "proved for {}, without the redundant links",
    Certification.MOTION_NOT_PROVED: "position proved, motion not proved, for {}",
    Certification.PROOF_TOO_LONG: "position proved, motion not proved, for {}",
    Certification.BRANCH_CHOSEN: "position proved, branch chosen at a change point, for {}",
    Certification.NOT_ASKED: "converged (proofs were switched off)",
}
_NOT_PROVED = "converged (not proved)"


@dataclass(frozen=True)
class StatusFormulas:
    """The formulas of the checks in row k of the sheet of positions, without equals sign."""

    book: Book
    columns: dict[str, int]

    def cell(self, key: str, k: int) -> str:
        """The cell of a column in row k."""
        return f"{column_name(self.columns[key])}{FIRST + k + 1}"

    def as_solved(self, k: int) -> str:
        """``yes`` while dimensions and input are those that Linkwork solved."""
        return f'IF(AND(changes=0,{self.same_input(k)}),"yes","no")'

    def same_input(self, k: int) -> str:
        """Whether the input is the one that Linkwork solved."""
        parts = []
        for variable in self.book.model.equations.inputs:
            cell = self.cell(variable.symbol, k)
            other = column_name(self.book.linkwork_columns[variable.name])
            size = float(abs(self.book.motion.inputs[variable.name]).max()) or 1.0
            near = cell_number(float(f"{_SAME_INPUT * size:.1e}"))
            parts.append(f"ABS({cell}-{LINKWORK}!{other}{self.source(k)})<={near}")
        return ",".join(parts)

    def source(self, k: int) -> int:
        """The row of position k on the sheet of Linkwork's values."""
        return int(self.book.iterations.rows[k]) + FIRST + 1

    def difference(self, k: int) -> str:
        """The distance of the unknowns from Linkwork's, of a radian and of the longest link."""
        terms, row = [], FIRST + k + 1
        for size, column, other, count in self._runs:
            here, theirs = (
                f"{column_name(first)}{line}:{column_name(first + count - 1)}{line}"
                for first, line in ((column, row), (other, self.source(k)))
            )
            terms.append(f"SUMXMY2({here},{LINKWORK}!{theirs})/{cell_number(size)}^2")
        distance = f"SQRT({'+'.join(terms)})" if terms else "0"
        return f'IF(as_solved="yes",IFERROR({distance},"-"),"-")'

    @cached_property
    def _runs(self) -> list[tuple[float, int, int, int]]:
        """Neighbouring columns of one size: size, first column, Linkwork's first column, count."""
        book = self.book
        sizes = book.model.compiled.solver.variable_scale / book.scales
        listed = [
            (float(f"{size:.6g}"), self.columns[v.symbol], book.linkwork_columns[v.name])
            for size, v in zip(sizes, book.model.equations.unknowns, strict=False)
            if v.name in book.motion.unknowns
        ]
        groups = groupby(enumerate(listed), lambda e: (e[1][0], e[1][1] - e[0], e[1][2] - e[0]))
        runs = []
        for _, entries in groups:
            run = [entry for _, entry in entries]
            runs.append((*run[0], len(run)))
        return runs

    def closes(self, k: int) -> str:
        """``yes`` if the row has a position that fulfils the equations."""
        unknowns = [v.symbol for v in self.book.model.equations.unknowns]
        if not unknowns:
            return '"yes"'
        every = f"SUM({self.cell(unknowns[0], k)}:{self.cell(unknowns[-1], k)})"
        if "squares" not in self.columns:
            return f'IF(ISNUMBER({every}),"yes","NO")'
        squares = self.cell("squares", k)
        if not any(block.reason for block in self.book.closure.blocks):
            every = squares
        return f'IF(ISNUMBER({every}),IF({squares}<tolerance,"yes","NO"),"NO")'

    def status(self, k: int) -> str:
        """Linkwork's statement while it holds, otherwise that of the cells."""
        said = f"{LINKWORK}!{column_name(self.book.statements)}{self.source(k)}"
        holds = 'as_solved="yes"'
        if self.book.iterations.found[k]:
            holds = f"AND({holds},{self.cell('difference', k)}<={cell_number(_CELL_AGREES)})"
        solved = f'IF({self.cell("closes", k)}="yes",{self._converged},{self._lost(k)})'
        stale = 'IF(unused_changes>0,"not solved: a changed cell is not used"'
        return f"IF({holds},{said},{stale},{solved}))"

    @cached_property
    def _held(self) -> list[Variable]:
        """The unknowns that cells do not solve for."""
        unknowns = self.book.model.equations.unknowns
        return [unknowns[k] for b in self.book.closure.blocks if b.reason for k in b.unknowns]

    def _lost(self, k: int) -> str:
        """The status of a row that does not close after a change."""
        text = '"no convergence from the row above"'
        if not self._held:
            return text
        held = self._held[:_MOST_ARGUMENTS]
        cells = ",".join(self.cell(v.symbol, k) for v in held)
        stale = f'"{self._names} not recalculated for another input"'
        return f"IF(COUNT({cells})={len(held)},{text},{stale})"

    @cached_property
    def _names(self) -> str:
        return " ".join(self.book.shown(v) for v in self._held)[:_LONGEST].replace('"', "'")

    @cached_property
    def _converged(self) -> str:
        """The status of a row that closes after a change."""
        book = self.book
        text = f'"{_NOT_PROVED}"'
        if self._held:
            text = f'"converged, {self._names} as before (not proved)"'
        for redundant, formula in book.closure.released:
            variable = next(
                v for v in book.model.equations.unknowns if v.name == redundant.variable
            )
            released = cell_text(formula, book.names.of)
            near = cell_number(float(f"{_CELL_AGREES * book.model.equations.length_scale:.1e}"))
            fits = f"ABS({book.names.of[variable.symbol]}-({released}))<={near}"
            link = redundant.link[:_LONGEST].replace('"', "'")
            text = f'IF({fits},{text},"redundant link {link} does not fit")'
        return text


def statement(book: Book, row: int) -> str:
    """Linkwork's statement about a row of the motion."""
    status = book.motion.status[row]
    if not status.ok:
        return f"no position: {status.value.partition(':')[0]} ({status.name})"
    inputs = (
        f"{book.shown(v)} = {book.motion.inputs[v.name][row]:.10g} {book.unit(v.kind)}".rstrip()
        for v in book.model.equations.inputs
    )
    certification = book.motion.certification[row]
    return _PROVED.get(certification, _NOT_PROVED).format(", ".join(inputs))


# ----------------------------------------------------------------------
# The sheet of positions: a row for every value of the input.


_GROUPS = {
    "link": "Links that turn with another link", "point": "Points", "output": "Outputs",
}  # fmt: skip
_STATUS = 60  # the largest width of the column of statuses


def write_cycle(book: Book, sheet: Any, newton: NewtonColumns) -> dict[str, int]:
    """Write all positions; returns the columns by key."""
    table = Table(book, CYCLE, sheet, 13)
    _Page(book, table, newton).write()
    return table.of


@dataclass
class _Page:
    book: Book
    table: Table
    newton: NewtonColumns

    def write(self) -> None:
        """Write column by column."""
        book, table = self.book, self.table
        self.status = StatusFormulas(book, table.of)
        self._inputs()
        self._unknowns()
        self._equations()
        # each from preceding ones
        for quantity in book.closure.quantities:
            table.group = _GROUPS[quantity.of]
            unit = book.model.units.of(quantity.kind)
            table.formula(quantity.shown, unit, quantity.formula, key=quantity.key)
        said = [statement(book, int(row)) for row in book.iterations.rows]
        self._check(said)
        note = (
            "After a change, statuses follow: Linkwork's proofs are shown only for rows as "
            "Linkwork solved them."
        )
        widest = min(max(map(len, said), default=0), _STATUS)
        table.finish("positions", note, 1 + len(book.model.equations.inputs), widest=widest)

    def _inputs(self) -> None:
        book, table = self.book, self.table
        table.group = "Input"
        for variable in book.model.equations.inputs:
            symbol = variable.symbol
            column = table.add(book.shown(variable), book.unit(variable.kind), symbol)
            values = book.motion.inputs[variable.name][book.iterations.rows]
            # an even table is first + step·k in cells, so that both can be changed
            even = input_table(values) is not None
            first, step = (book.names.of.get(f"{word} {symbol}") for word in ("from", "step"))
            for k, value in enumerate(values):
                at = FIRST + k, column
                if even:
                    formula = f"={first}+{step}*($A{FIRST + k + 1}-1)"
                    table.sheet.write_formula(*at, formula, book.style["number"], value)
                else:
                    table.sheet.write_number(*at, value, book.style["input_number"])

    def _unknowns(self) -> None:
        book, table, values = self.book, self.table, self.book.iterations.values[-1]
        table.group = "Unknowns"
        for number, variable in enumerate(book.model.equations.unknowns):
            column = table.add(book.shown(variable), book.unit(variable.kind), variable.symbol)
            look = "number" if number in self.newton.last else "value"

            def text(k: int, number: int = number, variable: Variable = variable) -> str:
                return apart(f"={self._unknown(number, variable, k)}", FIRST + k)

            table.cells(column, text, values[:, number], look)

    def _unknown(self, number: int, variable: Variable, k: int) -> str:
        """The formula of an unknown in one row: the last iterate, or Linkwork's value, or #N/A."""
        book, done, row = self.book, self.book.iterations, FIRST + k + 1
        solved = "NA()"
        if done.found[k] and variable.name in book.motion.unknowns:
            letter = column_name(book.linkwork_columns[variable.name])
            solved = f"{LINKWORK}!{letter}{self.status.source(k)}"
        elif done.found[k]:
            solved = cell_number(float(done.values[-1][k, number]))
        last = self.newton.last.get(number)
        if last is None:
            # its cells do not solve: right for the inputs of the file only
            return f"IF(AND({self.status.same_input(k)}),{solved},NA())"
        iterate = f'IF(converged="yes",{NEWTON}!{column_name(last)}{row},NA())'
        return iterate if done.live[k] else f'IF(as_solved="yes",{solved},{iterate})'

    def _equations(self) -> None:
        """The equations in the order in which they are printed, and the sum of their squares."""
        book, table = self.book, self.table
        table.group = "Equations, 0 where they close"
        rows = sorted(
            (row for block in book.closure.blocks for row in block.rows),
            key=lambda row: int(row.name[1:]),
        )
        if not rows:
            return
        first = column_name(table.end)
        values = [table.formula(row.name, "", row.formula, "small") for row in rows]
        last = column_name(table.end - 1)

        def text(k: int) -> str:
            return f"=SUMSQ({first}{FIRST + k + 1}:{last}{FIRST + k + 1})"

        squares = np.sum(np.square(values), axis=0)
        table.cells(table.add("ΣF²", "", "squares"), text, squares, "small")

    def _check(self, said: list[str]) -> None:
        book, table, status = self.book, self.table, self.status
        solved = book.iterations.found.tolist()
        closes = ["yes" if there else "NO" for there in solved]
        none = ["-" if not there else 0.0 for there in solved]
        table.group = "Check"
        book.names.claim("as_solved", "as_solved")
        # formulas of each refer to the columns before it
        table.add("as solved", "by Linkwork", "as_solved")
        table.add("difference", "relative", "difference")
        table.add("closes", "", "closes")
        table.add("status", "", "status", look="head_indented")
        for key, formula, values, look in (
            ("as_solved", status.as_solved, ["yes"] * book.count, "right"),
            ("difference", status.difference, none, "relative"),
            ("closes", status.closes, closes, "right"),
            ("status", status.status, said, "status"),
        ):
            for k, value in enumerate(values):
                at = FIRST + k, table.of[key]
                table.sheet.write_formula(*at, f"={formula(k)}", book.style[look], value)
        self._highlight()

    def _highlight(self) -> None:
        """Colour the statuses, and fade cells without a value."""
        style, columns, last = self.book.style, self.table.of, self.book.last - 1

        def colour(first: int, end: int, look: str, **rule: Any) -> None:
            self.table.sheet.conditional_format(
                FIRST, first, last, end, {**rule, "format": style[look]}
            )

        closes, status = columns["closes"], columns["status"]
        colour(closes, closes, "wrong", type="cell", criteria="==", value='"NO"')
        colour(status, status, "good", type="text", criteria="begins with", value="proved for")
        colour(status, status, "doubtful", type="text", criteria="containing", value="not proved")
        colour(status, status, "lost", type="text", criteria="begins with", value="no ")
        colour(1, closes, "faded", type="errors")
