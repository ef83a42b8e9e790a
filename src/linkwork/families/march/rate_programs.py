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

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass

from linkwork.core.record.closure import BlockPart, Closure, inverse_of, solve_linear, weighted_norm
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


class _RateWriter:
    def __init__(self, table: LoopTable, parts: Sequence[BlockPart], zeros: Set[str]) -> None:
        self.table, self.n = table, table.unknowns
        self.rec = rec = Recorder()
        variables = [rec.input(f"v{k}") for k in range(table.variables)]
        self.closures = [Closure(table, part, rec, variables, zeros) for part in parts]

    def finish(self, wanted: Sequence[str]) -> PlaceProgram:
        """The program, which computes these."""
        registers = Registers()
        reserve(self.rec, registers)
        program = lower_program(self.rec, registers, registers.count)
        return PlaceProgram(program=program, registers=registers, wanted=tuple(wanted))

    # ---------------------------------------------------------------- rates

    def derivatives(self) -> tuple[dict[int, Number], dict[int, Number]]:
        """Both derivatives of all variables by the leading input."""
        inputs = range(self.table.variables - self.n)
        alone = len(inputs) == 1  # a single input leads
        first: dict[int, Number] = {
            self.n + j: 1.0 if alone else self.rec.input(f"u{j}.rate") for j in inputs
        }
        second: dict[int, Number] = {self.n + j: 0.0 for j in inputs}
        for closure in self.closures:
            self._block_rates(closure, first, second)
        return first, second

    def rates(self) -> list[str]:
        """Write both derivatives of all unknowns; return the names of the registers."""
        first, second = self.derivatives()
        for k in range(self.n):
            self.rec.write(f"first{k}", first[k])
            self.rec.write(f"second{k}", second[k])
        return [f"{name}{k}" for name in ("first", "second") for k in range(self.n)]

    def _block_rates(
        self, closure: Closure, first: dict[int, Number], second: dict[int, Number]
    ) -> None:
        unknowns, known = closure.part.unknowns, closure.known()
        matrix, drives = closure.jacobian(unknowns), closure.jacobian(known)
        side = self._driven(drives, [first[k] for k in known])
        for k, x in zip(unknowns, self._solution(matrix, side), strict=True):
            first[k] = -x  # eq. (11)
        bends = closure.bending(first, first)
        driven = self._driven(drives, [second[k] for k in known])
        side = [self.rec.add(x, y) for x, y in zip(bends, driven, strict=True)]
        for k, x in zip(unknowns, self._solution(matrix, side), strict=True):
            second[k] = -x  # eq. (12)

    def _solution(self, matrix: list[list[Number]], side: Sequence[Number]) -> list[Value]:
        return solve_linear(self.rec, matrix, [side]).columns[0]

    def _driven(self, drives: list[list[Number]], rates: list[Number]) -> list[Value]:
        """Σ dF/dv times the rates of known variables."""
        rec = self.rec
        return [
            rec.total([rec.multiply(x, rate) for x, rate in zip(row, rates, strict=True)])
            for row in drives
        ]

    # ---------------------------------------------------------------- evidence

    def evidence(self, lengths: Set[int]) -> list[str]:
        """Condition and residual; ``lengths``: the linear rows that are equations of lengths."""
        rec = self.rec
        conditions = [rec.constant(1.0)]
        conditions += [self._condition(c, self._scales(c, lengths)) for c in self.closures]
        rec.write("condition", rec.largest(conditions))
        return ["condition", *self.residual(lengths)]

    def residual(self, lengths: Set[int]) -> list[str]:
        """The largest residual alone."""
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

    def _weight(self, k: int) -> Value:
        """Of a variable: 1 for angles."""
        return self.rec.constant(1.0) if self.table.is_angle[k] else self.rec.input(f"scale{k}")

    def _condition(self, closure: Closure, scales: Sequence[Number]) -> Value:
        rec = self.rec
        weights = [self._weight(k) for k in closure.part.unknowns]
        matrix = closure.jacobian(closure.part.unknowns)
        inverse, _ = inverse_of(rec, matrix)
        forward = weighted_norm(rec, matrix, weights, scales)
        return rec.multiply(forward, weighted_norm(rec, inverse, scales, weights))  # eq. (14)


def rate_program(
    table: LoopTable, parts: Sequence[BlockPart], zeros: Set[str] = frozenset()
) -> PlaceProgram:
    """First derivatives of all unknowns, then the second ones.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    parts : sequence of BlockPart
        Blocks in the order in which they are solved.
    zeros : set of str
        Names of coefficients that are zero in every design.
    """
    writer = _RateWriter(table, parts, zeros)
    return writer.finish(writer.rates())


def quantity_program(
    table: LoopTable,
    parts: Sequence[BlockPart],
    write: Callable[[Recorder, Mapping[int, Number], Mapping[int, Number]], Sequence[str]],
    zeros: Set[str] = frozenset(),
) -> PlaceProgram:
    """What a function writes of the derivatives of all variables; see :func:`rate_program`.

    Parameters
    ----------
    write : callable
        Of the recorder, the first and the second derivatives by variable; it returns the names of
        the registers that it has written.
    """
    writer = _RateWriter(table, parts, zeros)
    first, second = writer.derivatives()
    return writer.finish(write(writer.rec, first, second))


def evidence_program(
    table: LoopTable,
    parts: Sequence[BlockPart],
    lengths: Set[int],
    zeros: Set[str] = frozenset(),
) -> PlaceProgram:
    """Condition and residual; see :func:`rate_program`.

    Parameters
    ----------
    lengths : set of int
        The linear rows whose residual is a length.
    """
    writer = _RateWriter(table, parts, zeros)
    return writer.finish(writer.evidence(lengths))


def drawn_program(
    table: LoopTable,
    parts: Sequence[BlockPart],
    lengths: Set[int],
    zeros: Set[str] = frozenset(),
) -> PlaceProgram:
    """Rates and residual, for a page that solves; see :func:`evidence_program`."""
    writer = _RateWriter(table, parts, zeros)
    return writer.finish([*writer.rates(), *writer.residual(lengths)])
