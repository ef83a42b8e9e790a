"""The status of a row as a formula: a proof is shown for the numbers that Linkwork proved only."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

from linkwork.equations.model import Variable
from linkwork.export.formulas.cell_formula import cell_number
from linkwork.export.workbook.book import FIRST, LINKWORK, Book, column_name
from linkwork.export.workbook.cycle_columns import CycleColumns
from linkwork.foundation.certification import Certification

__all__ = ["StatusFormulas", "statement"]

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
            own = column_name(self.columns.of[variable.symbol])
            other = column_name(self.book.linkwork_columns[variable.name])
            size = float(abs(self.book.motion.inputs[variable.name]).max()) or 1.0
            near = cell_number(float(f"{_SAME_INPUT * size:.1e}"))
            parts.append(f"ABS({own}{FIRST + k + 1}-{LINKWORK}!{other}{self.source(k)})<={near}")
        return ",".join(parts)

    def source(self, k: int) -> int:
        """The row of position k on the sheet of Linkwork's values."""
        return int(self.book.iterations.rows[k]) + FIRST + 1

    def difference(self, k: int) -> str:
        """The distance of the unknowns from Linkwork's, of a radian and of the longest link."""
        found, row = [], FIRST + k + 1
        for size, own, other, count in self._runs:
            mine, theirs = (
                f"{column_name(first)}{line}:{column_name(first + count - 1)}{line}"
                for first, line in ((own, row), (other, self.source(k)))
            )
            found.append(f"SUMXMY2({mine},{LINKWORK}!{theirs})/{cell_number(size)}^2")
        distance = f"SQRT({'+'.join(found)})" if found else "0"
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
            own = [entry for _, entry in entries]
            runs.append((*own[0], len(own)))
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
        own = f'IF({closes}="yes",{self._converged},{self._lost(row)})'
        stale = 'IF(unused_changes>0,"not solved: a changed cell is not used"'
        return f"IF({holds},{said},{stale},{own}))"

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
            given = formula.text(book.names.cells)
            near = cell_number(float(f"{_CELL_AGREES * book.model.equations.length_scale:.1e}"))
            fits = f"ABS({book.names.cells[variable.symbol]}-({given}))<={near}"
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
