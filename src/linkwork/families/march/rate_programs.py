"""Programs that compute rates, condition and residual at positions, and prove these.

Block by block, as in ``numerics.block_solver``:  J x' = -F_u u',  J x'' = -D²F[(x', u'), (x', u')]
with the rates of all variables that a block knows. Registers by name:

``v<k>``             variables, the inputs after the unknowns
``u<j>.rate``        rate of an input by the leading one
``scale<k>``         weights of variables that are lengths
``length``           scale of the residuals of equations of lengths
``first<k>`` ``second<k>``  derivatives of the unknowns by the leading input
``condition``        the largest ‖J‖·‖J⁻¹‖ of all blocks, weighted, in the largest norm
``residual``         the largest residual of all equations, scaled
``u<j>.spread``      how far an input may be from its true value, besides its rounding
``radius`` ``unique``  a position lies within the first, no other one within the second, weighted;
                     both NaN where that is not proved
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from linkwork.core.record.closure import BlockPart, Closure, add_rates, condition_of
from linkwork.core.record.recorder import (
    Program,
    Recorder,
    Registers,
    Value,
    lower_program,
    reserve,
)
from linkwork.core.table.loop_table import LoopTable

Number = Value | float


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaceProgram:
    """A program that computes ``wanted`` named registers from a position."""

    program: Program
    registers: Registers
    wanted: tuple[str, ...]


class PlaceWriter:
    """Writes programs that compute quantities of a position.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    parts : sequence of BlockPart
        Blocks in the order in which they are solved.
    zeros : set of str
        Names of coefficients that are zero in every design.
    """

    def __init__(
        self, table: LoopTable, parts: Sequence[BlockPart], zeros: Set[str] = frozenset()
    ) -> None:
        self.table, self.n = table, table.unknowns
        self.rec = rec = Recorder()
        variables = [rec.input(f"v{k}") for k in range(table.variables)]
        self.closures = [Closure(table, part, rec, variables, zeros) for part in parts]

    def finish(self, wanted: Sequence[str]) -> PlaceProgram:
        """The program, which computes these registers."""
        registers = Registers()
        reserve(self.rec, registers)
        program = lower_program(self.rec, registers, registers.count)
        return PlaceProgram(program=program, registers=registers, wanted=tuple(wanted))

    def derivatives(self) -> tuple[Mapping[int, Number], Mapping[int, Number]]:
        """Both derivatives of all variables by the leading input."""
        inputs = range(self.table.variables - self.n)
        alone = len(inputs) == 1  # a single input leads
        first: dict[int, Number] = {
            self.n + j: 1.0 if alone else self.rec.input(f"u{j}.rate") for j in inputs
        }
        second: dict[int, Number] = {self.n + j: 0.0 for j in inputs}
        for closure in self.closures:
            add_rates(closure, first, second)
        return first, second

    def rates(self) -> list[str]:
        """Write the first derivatives of all unknowns, then the second ones; the registers."""
        written = {
            f"{name}{k}": by_variable[k]
            for name, by_variable in zip(("first", "second"), self.derivatives(), strict=True)
            for k in range(self.n)
        }
        for name, value in written.items():
            self.rec.write(name, value)
        return list(written)

    def condition(self, lengths: Set[int]) -> list[str]:
        """The largest condition; ``lengths``: the linear rows that are equations of lengths."""
        rec = self.rec
        found = [condition_of(c, self._scales(c, lengths))[0] for c in self.closures]
        rec.write("condition", rec.largest([1.0, *found]))
        return ["condition"]

    def residual(self, lengths: Set[int]) -> list[str]:
        """The largest residual, scaled."""
        rec = self.rec
        residuals = [rec.constant(0.0)]
        for closure in self.closures:
            residuals += [
                rec.divide(rec.absolute(f), scale)
                for f, scale in zip(closure.residual(), self._scales(closure, lengths), strict=True)
            ]
        rec.write("residual", rec.largest(residuals))
        return ["residual"]

    def _scales(self, closure: Closure, lengths: Set[int]) -> list[Number]:
        """Of the residuals of a block."""
        length = self.rec.input("length")
        lines = [length if r in lengths else 1.0 for r in closure.lines]
        return [*[length] * (2 * len(closure.loops)), *lines]
