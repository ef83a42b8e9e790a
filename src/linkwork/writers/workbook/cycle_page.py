"""The columns of the sheet of positions."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np

from linkwork.core.equations.compiling import coordinate_name
from linkwork.core.equations.model import Variable
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.statuses import Certification
from linkwork.core.results.quantity import Kind
from linkwork.writers.formulas.closure_formulas import cell_number, cell_text
from linkwork.writers.workbook.book import CYCLE, FIRST, LINKWORK, NEWTON, Book, apart, column_name
from linkwork.writers.workbook.dimension_page import input_table
from linkwork.writers.workbook.layout import print_table
from linkwork.writers.workbook.newton_page import NewtonColumns


@dataclass(frozen=True, kw_only=True)
class CycleColumns:
    """The columns of the sheet; ``largest`` is the column of differences."""

    of: dict[str, int]
    equations: tuple[int, ...]
    squares: int
    as_solved: int
    largest: int
    closes: int
    status: int
    groups: tuple[tuple[str, int, int], ...]


def planned_cycle(book: Book) -> CycleColumns:
    """Number the columns and name them."""
    of: dict[str, int] = {}
    groups: list[tuple[str, int, int]] = []
    place = 1

    def group(title: str, keys: list[str]) -> None:
        nonlocal place
        for key in keys:
            of[key] = place
            place += 1
        if keys:
            groups.append((title, place - len(keys), place - 1))

    equations = book.model.equations
    group("Input", [v.symbol for v in equations.inputs])
    group("Unknowns", [v.symbol for v in equations.unknowns])
    rows = sorted(
        (row.name for block in book.closure.blocks for row in block.rows),
        key=lambda name: int(name[1:]),
    )
    group("Equations, 0 where they close", [f"row {name}" for name in rows])
    squares, place = place, place + (1 if rows else 0)
    group("Links that turn with another link", [canonical(link) for link in book.closure.links])
    group("Outputs", [f"output {name}" for name in book.closure.outputs])
    points = book.closure.points
    group("Points", [coordinate_name(point, axis) for point in points for axis in "xy"])
    groups.append(("Check", place, place + 3))
    book.names.claim("as_solved", "as_solved")
    of["as_solved"] = place
    for key, column in of.items():
        if key in book.names.cells:
            book.define(key, CYCLE, f"${column_name(column)}1")
    return CycleColumns(
        of=of,
        equations=tuple(of[f"row {name}"] for name in rows),
        squares=squares if rows else -1,
        as_solved=place,
        largest=place + 1,
        closes=place + 2,
        status=place + 3,
        groups=tuple(groups),
    )


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
    columns: CycleColumns

    def as_solved(self, k: int) -> str:
        """``yes`` while dimensions and input are those that Linkwork solved."""
        return f'IF(AND(changes=0,{self.same_input(k)}),"yes","no")'

    def same_input(self, k: int) -> str:
        """Whether the input is the one that Linkwork solved."""
        parts = []
        for variable in self.book.model.equations.inputs:
            letter = column_name(self.columns.of[variable.symbol])
            other = column_name(self.book.linkwork_columns[variable.name])
            size = float(abs(self.book.motion.inputs[variable.name]).max()) or 1.0
            near = cell_number(float(f"{_SAME_INPUT * size:.1e}"))
            parts.append(f"ABS({letter}{FIRST + k + 1}-{LINKWORK}!{other}{self.source(k)})<={near}")
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
            (float(f"{size:.6g}"), self.columns.of[v.symbol], book.linkwork_columns[v.name])
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
        row = FIRST + k + 1
        unknowns = [self.columns.of[v.symbol] for v in self.book.model.equations.unknowns]
        if not unknowns:
            return '"yes"'
        every = f"SUM({column_name(unknowns[0])}{row}:{column_name(unknowns[-1])}{row})"
        if not self.columns.equations:
            return f'IF(ISNUMBER({every}),"yes","NO")'
        squares = f"{column_name(self.columns.squares)}{row}"
        if not any(block.reason for block in self.book.closure.blocks):
            every = squares
        return f'IF(ISNUMBER({every}),IF({squares}<tolerance,"yes","NO"),"NO")'

    def status(self, k: int) -> str:
        """Linkwork's statement while it holds, otherwise that of the cells."""
        row = FIRST + k + 1
        said = f"{LINKWORK}!{column_name(self.book.statements)}{self.source(k)}"
        holds = 'as_solved="yes"'
        if self.book.iterations.found[k]:
            largest = f"{column_name(self.columns.largest)}{row}"
            holds = f"AND({holds},{largest}<={cell_number(_CELL_AGREES)})"
        closes = f"{column_name(self.columns.closes)}{row}"
        solved = f'IF({closes}="yes",{self._converged},{self._lost(row)})'
        stale = 'IF(unused_changes>0,"not solved: a changed cell is not used"'
        return f"IF({holds},{said},{stale},{solved}))"

    @cached_property
    def _held(self) -> list[Variable]:
        """The unknowns that cells do not solve for."""
        unknowns = self.book.model.equations.unknowns
        return [unknowns[k] for b in self.book.closure.blocks if b.reason for k in b.unknowns]

    def _lost(self, row: int) -> str:
        """The status of a row that does not close after a change."""
        text = '"no convergence from the row above"'
        if not self._held:
            return text
        held = self._held[:_MOST_ARGUMENTS]
        cells = ",".join(f"{column_name(self.columns.of[v.symbol])}{row}" for v in held)
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
            released = cell_text(formula, book.names.cells)
            near = cell_number(float(f"{_CELL_AGREES * book.model.equations.length_scale:.1e}"))
            fits = f"ABS({book.names.cells[variable.symbol]}-({released}))<={near}"
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


_WIDTH, _STATUS = 13, 60


def write_cycle(book: Book, sheet: Any, columns: CycleColumns, newton: NewtonColumns) -> None:
    """Write all positions."""
    _Page(book, sheet, columns, newton).write()


@dataclass
class _Page:
    book: Book
    sheet: Any
    columns: CycleColumns
    newton: NewtonColumns

    def write(self) -> None:
        """Write the headings, then column by column."""
        book, sheet = self.book, self.sheet
        self.status = StatusFormulas(book, self.columns)
        said = (statement(book, int(row)) for row in book.iterations.rows)
        widths = [6, *[_WIDTH] * self.columns.closes, min(max(map(len, said), default=0), _STATUS)]
        repeated = 1 + len(book.model.equations.inputs)
        print_table(sheet, widths, repeated, book.last - 1)
        book.title(sheet, "positions")
        sheet.write(
            1, 0, "After a change, statuses follow: Linkwork's proofs are shown only for rows as "
            "Linkwork solved them.", book.style["note"],
        )  # fmt: skip
        book.group_heads(sheet, self.columns.groups)
        book.row_numbers(sheet)
        self._inputs()
        self._unknowns()
        self._equations()
        self._rest()
        self._check()
        sheet.freeze_panes(FIRST, repeated)

    def _inputs(self) -> None:
        book = self.book
        for variable in book.model.equations.inputs:
            column = self.columns.of[variable.symbol]
            book.head(self.sheet, column, book.shown(variable), book.unit(variable.kind))
            values = book.motion.inputs[variable.name][book.iterations.rows]
            # an even table is first + step·k in cells, so that both can be changed
            even = input_table(values) is not None
            for k, value in enumerate(values):
                at = FIRST + k, column
                if not even:
                    self.sheet.write_number(*at, value, book.style["input_number"])
                    continue
                first, step = (
                    book.names.cells[f"{word} {variable.symbol}"] for word in ("from", "step")
                )
                formula = f"={first}+{step}*($A{FIRST + k + 1}-1)"
                self.sheet.write_formula(*at, formula, book.style["number"], value)

    def _unknowns(self) -> None:
        book, done = self.book, self.book.iterations
        for number, variable in enumerate(book.model.equations.unknowns):
            column = self.columns.of[variable.symbol]
            book.head(self.sheet, column, book.shown(variable), book.unit(variable.kind))
            look = "number" if number in self.newton.last else "value"
            for k, value in enumerate(done.values[-1][:, number].tolist()):
                formula = apart(f"={self._unknown(number, variable, k)}", FIRST + k)
                book.put(self.sheet, k, column, formula, look, value)

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
        book = self.book
        squares: Any = np.zeros(book.count)
        for block in book.closure.blocks:
            for row in block.rows:
                column = self.columns.of[f"row {row.name}"]
                book.head(self.sheet, column, row.name, "")
                values = book.column(self.sheet, column, row.formula, "small")
                squares = squares + values**2
        if not self.columns.equations:
            return
        book.head(self.sheet, self.columns.squares, "ΣF²", "")
        first = column_name(self.columns.equations[0])
        last = column_name(self.columns.equations[-1])
        for k, value in enumerate(squares.tolist()):
            row_number = FIRST + k + 1
            formula = f"=SUMSQ({first}{row_number}:{last}{row_number})"
            book.put(self.sheet, k, self.columns.squares, formula, "small", value)

    def _rest(self) -> None:
        """Write points, links and outputs, each from preceding ones."""
        book, closure = self.book, self.book.closure
        for point, pair in closure.points.items():
            for axis, formula in zip("xy", pair, strict=True):
                key = coordinate_name(point, axis)
                column = self.columns.of[key]
                book.head(self.sheet, column, f"{point}.{axis}", book.unit("length"))
                book.values[key] = book.column(self.sheet, column, formula, "number")
        for link, formula in closure.links.items():
            column = self.columns.of[canonical(link)]
            book.head(self.sheet, column, link, book.unit("angle"))
            book.values[canonical(link)] = book.column(self.sheet, column, formula, "number")
        kinds = {name: output.kind for name, output in book.model.equations.outputs.items()}
        for name, formula in closure.outputs.items():
            column = self.columns.of[f"output {name}"]
            book.head(self.sheet, column, name, book.model.units.of(Kind(kinds[name])))
            book.values[f"output {name}"] = book.column(self.sheet, column, formula, "number")

    def _check(self) -> None:
        book, columns = self.book, self.columns
        book.head(self.sheet, columns.as_solved, "as solved", "by Linkwork")
        book.head(self.sheet, columns.largest, "difference", "relative")
        book.head(self.sheet, columns.closes, "closes", "")
        self.sheet.write(FIRST - 2, columns.status, "status", book.style["head_indented"])
        self.sheet.write(FIRST - 1, columns.status, "", book.style["unit"])
        status = self.status
        for k, solved in enumerate(book.iterations.found.tolist()):
            closes = "yes" if solved else "NO"
            said = statement(book, int(book.iterations.rows[k]))
            for column, formula, value, look in (
                (columns.as_solved, status.as_solved(k), "yes", "right"),
                (columns.largest, status.difference(k), 0.0 if solved else "-", "relative"),
                (columns.closes, status.closes(k), closes, "right"),
                (columns.status, status.status(k), said, "status"),
            ):
                cell_style = book.style[look]
                self.sheet.write_formula(FIRST + k, column, f"={formula}", cell_style, value)
        self._highlight()

    def _highlight(self) -> None:
        """Colour the statuses, and fade cells without a value."""
        book, columns = self.book, self.columns
        last = book.last - 1
        no = {"type": "cell", "criteria": "==", "value": '"NO"', "format": book.style["wrong"]}
        self.sheet.conditional_format(FIRST, columns.closes, last, columns.closes, no)
        for text, look in (("proved for", "good"), ("not proved", "doubtful"), ("no ", "lost")):
            rule = {
                "type": "text", "criteria": "begins with" if look != "doubtful" else "containing",
                "value": text, "format": book.style[look],
            }  # fmt: skip
            self.sheet.conditional_format(FIRST, columns.status, last, columns.status, rule)
        faded = {"type": "errors", "format": book.style["faded"]}
        self.sheet.conditional_format(FIRST, 1, last, columns.closes, faded)
