"""Programs that find the dead point ahead of a node: there the path's value turns back.

With another variable in the lead (parameter λ, the fastest one near the dead point), the path's
value t is an unknown like the others, and the dead point is where dt/dλ = 0: found by the secant
method on the curve. Registers as in :mod:`march_programs`, and

``lead0`` ``slope0``   λ and dt/dλ at the place before
``bend``               d²t/dλ² between the last two places
``move``               the weighted size of the last change of λ
``seeking``            1.0 while the place is still improved
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

import numpy as np

from linkwork.kernels.lanes.closure import BlockPart, Closure, solved
from linkwork.kernels.lanes.lowering import lowered, reserve
from linkwork.kernels.lanes.program import Program, Registers
from linkwork.kernels.lanes.proof_program import BlockProof
from linkwork.kernels.lanes.recorder import Recorder, Value
from linkwork.kernels.loop_table import LoopTable

__all__ = ["FoldPrograms", "fold_programs"]

_UNIT = float(np.finfo(float).eps) / 2.0
_FARTHEST = 0.3  # weighted: how far λ may go in one step


@dataclass(frozen=True, kw_only=True, eq=False)
class FoldPrograms:
    """``iterate``: Newton-Raphson at a fixed λ with the rates by λ; ``move``: to the next λ;
    ``prove``: the arc from the node to the dead point (``None`` without proofs).
    """

    registers: Registers
    height: int
    iterate: Program
    move: Program
    prove: Program | None


class _Writer:
    def __init__(self, table: LoopTable, lead: int, zeros: Set[str]) -> None:
        self.table, self.lead, self.zeros = table, lead, zeros
        self.n = table.unknowns
        equations = tuple(range(table.loops.rows + len(table.linear.constant)))
        others = tuple(k for k in range(self.n + 1) if k != lead)
        self.part = BlockPart(equations=equations, unknowns=others)

    def _closure(self, rec: Recorder) -> Closure:
        variables = [rec.input(f"v{k}") for k in range(self.n + 1)]
        return Closure(self.table, self.part, rec, variables, self.zeros)

    def _scale(self, rec: Recorder, k: int) -> Value:
        return rec.constant(1.0) if self.table.turns[k] else rec.input(f"scale{k}")

    def iterate(self) -> Recorder:
        """One step with λ held, and the rates of the others by λ."""
        rec = Recorder()
        closure = self._closure(rec)
        drives = [row[0] for row in closure.jacobian([self.lead])]
        matrix = closure.jacobian(self.part.unknowns)
        change, moved = solved(rec, matrix, [closure.residual(), drives]).columns
        live, sizes = rec.input("live"), []
        for d, r, k in zip(change, moved, self.part.unknowns, strict=True):
            sizes.append(rec.divide(rec.absolute(d), self._scale(rec, k)))
            rec.write(f"v{k}", rec.where(live, closure.v[k] - d, closure.v[k]))
            rec.write(f"r{k}", rec.where(live, -r, rec.input(f"r{k}")))
        size = rec.largest(sizes)
        rec.write("step", rec.where(live, size, rec.input("step")))
        done = rec.at_most(size, rec.input("tolerance"))
        rec.write("live", rec.where(done, 0.0, live))
        return rec

    def move(self) -> Recorder:
        """The next λ by the secant method, the others along their rates."""
        rec = Recorder()
        here, before = rec.input(f"v{self.lead}"), rec.input("lead0")
        slope, slope0 = rec.input(f"r{self.n}"), rec.input("slope0")
        seeking = rec.input("seeking")
        bend = (slope - slope0) / (here - before)
        far = _FARTHEST * self._scale(rec, self.lead)
        wanted = -(slope / bend)
        change = rec.largest([rec.smallest([wanted, far]), -far])
        moved = rec.divide(rec.absolute(change), self._scale(rec, self.lead))
        rec.write("bend", rec.where(seeking, bend, rec.input("bend")))
        rec.write("move", rec.where(seeking, moved, rec.input("move")))
        rec.write("lead0", rec.where(seeking, here, before))
        rec.write("slope0", rec.where(seeking, slope, slope0))
        rec.write(f"v{self.lead}", rec.where(seeking, here + change, here))
        for k in self.part.unknowns:
            v = rec.input(f"v{k}")
            rec.write(f"v{k}", rec.where(seeking, v + rec.input(f"r{k}") * change, v))
        close = rec.at_most(moved, rec.input("close"))
        rec.write("seeking", rec.where(close, 0.0, seeking))
        return rec

    def prove(self) -> Recorder:
        """That the dead point lies on the curve of the node."""
        rec = Recorder()
        closure = self._closure(rec)
        used = (*self.part.unknowns, *closure.known())
        proof = BlockProof(closure, {k: self._scale(rec, k) for k in used})
        here, node = closure.v[self.lead], rec.input(f"w{self.lead}")
        near = rec.absolute(here) * (4.0 * _UNIT)
        # the node's own λ is known as well as its position
        away = rec.absolute(here - node) * (1.0 + 16.0 * _UNIT)
        far = away + 2.0 * near + rec.input(f"x{self.lead}")
        place = proof.within(dict.fromkeys(proof.known, near))
        arc = proof.within(dict.fromkeys(proof.known, far))
        masks = [place.holds, arc.holds]
        for k, error, alone in zip(self.part.unknowns, place.each, arc.alone, strict=True):
            off = rec.absolute(closure.v[k] - rec.input(f"w{k}"))
            known = rec.largest([error, rec.input(f"x{k}")])
            masks.append(rec.at_most(off + known, alone * (1.0 - 4.0 * _UNIT)))
        rec.write("good", rec.all_of(masks))
        return rec


def fold_programs(
    table: LoopTable, lead: int, zeros: Set[str] = frozenset(), certified: bool = False
) -> FoldPrograms:
    """The programs of a table with a single input, led by one of its unknowns.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    lead : int
        The unknown that leads.
    """
    writer = _Writer(table, lead, zeros)
    recorded = [writer.iterate(), writer.move(), *([writer.prove()] if certified else [])]
    registers = Registers()
    for rec in recorded:
        reserve(rec, registers)
    programs = [lowered(rec, registers, registers.count) for rec in recorded]
    return FoldPrograms(
        registers=registers,
        height=max(program.height for program in programs),
        iterate=programs[0],
        move=programs[1],
        prove=programs[2] if certified else None,
    )
