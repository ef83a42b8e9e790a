"""Programs that find the dead point ahead of a node: there the path's value turns back.

With another variable in the lead (parameter λ, the fastest one near the dead point), the path's
value t is an unknown like the others, and the dead point is where dt/dλ = 0: found by the secant
method on the curve. Registers as in :mod:`march_programs`, and

``lead0`` ``slope0``   λ and dt/dλ at the place before
``bend``               d²t/dλ² between the last two places
``move``               the weighted size of the last change of λ
``seeking``            1.0 while the place is still improved
``w<k>`` ``x<k>``      the place that an arc is proved from, and how far the true one may be
``e<k>``               how far the true place may be from where the arc was proved to
``p<k>`` ``pr<k>``     the node with its rates by λ; ``z<k>`` ``zr<k>`` the dead point with its own
``along``              which part of the way from the node to the dead point a place between has
``sound``              1.0 where the place reached is proved, wherever it was reached from
``side``               -1.0 or 1.0, on which side of the place ``w`` another one is tried
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.kernels.loop_table import LoopTable
from linkwork.kernels.march.closure import BlockPart, Closure, solve_linear
from linkwork.kernels.march.proof_program import BlockProof
from linkwork.kernels.program.lowering import lower_program, reserve
from linkwork.kernels.program.program import Program, Registers
from linkwork.kernels.program.recorder import Recorder, Value

__all__ = ["FoldPrograms", "fold_programs"]

_CLEARLY = 32.0  # twice as many errors of t as lie between a dead point and the places aside
_LEAST = 1e-9  # weighted: the nearest of them
_FARTHEST = 0.3  # weighted: how far λ may go in one step


@dataclass(frozen=True, kw_only=True, eq=False)
class FoldPrograms:
    """``iterate``: Newton-Raphson at a fixed λ with the rates by λ; ``move``: to the next λ.

    ``prove``: the arc from ``w`` to the place reached. For proofs in parts ``between`` predicts a
    place between node and dead point; after ``advance`` the next part begins at the place reached.
    ``aside``: a place so far from ``w`` that t, which turns back there, differs by more than its
    error.
    """

    registers: Registers
    height: int
    iterate: Program
    move: Program
    prove: Program
    between: Program
    advance: Program
    aside: Program


class _FoldWriter:
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
        return rec.constant(1.0) if self.table.is_angle[k] else rec.input(f"scale{k}")

    def iterate(self) -> Recorder:
        """One step with λ held, and the rates of the others by λ."""
        rec = Recorder()
        closure = self._closure(rec)
        drives = [row[0] for row in closure.jacobian([self.lead])]
        matrix = closure.jacobian(self.part.unknowns)
        change, moved = solve_linear(rec, matrix, [closure.residual(), drives]).columns
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
        bend = (slope - slope0) / (here - before)  # eq. (37)
        far = _FARTHEST * self._scale(rec, self.lead)
        wanted = -(slope / bend)  # eq. (37)
        # far from the dead point the secant may lead out of the arc
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
        """Prove that the place reached lies on the curve of the previous one (first: the node)."""
        rec = Recorder()
        closure = self._closure(rec)
        used = (*self.part.unknowns, *closure.known())
        proof = BlockProof(closure, {k: self._scale(rec, k) for k in used})
        here, node = closure.v[self.lead], rec.input(f"w{self.lead}")
        near = rec.absolute(here) * (4.0 * UNIT_ROUNDOFF)
        # a node's own λ is known as well as its position
        away = rec.absolute(here - node) * (1.0 + 16.0 * UNIT_ROUNDOFF)
        far = away + 2.0 * near + rec.input(f"x{self.lead}")
        place = proof.within(dict.fromkeys(proof.known, near))
        arc = proof.within(dict.fromkeys(proof.known, far))
        rec.write("sound", rec.where(place.holds, 1.0, 0.0))
        masks = [place.holds, arc.holds]
        for k, error, alone in zip(
            self.part.unknowns, place.error_bound, arc.isolation_radius, strict=True
        ):
            rec.write(f"e{k}", error)
            off = rec.absolute(closure.v[k] - rec.input(f"w{k}"))
            known = rec.largest([error, rec.input(f"x{k}")])
            masks.append(rec.at_most(off + known, alone * (1.0 - 4.0 * UNIT_ROUNDOFF)))  # eq. (33)
        rec.write("good", rec.all_of(masks))
        return rec

    def between(self) -> Recorder:
        """A place between node and dead point: the cubic through both with their rates."""
        rec = Recorder()
        s = rec.input("along")
        square, cube = s * s, s * s * s
        away = rec.input(f"z{self.lead}") - rec.input(f"p{self.lead}")
        ahead = 3.0 * square - 2.0 * cube
        rise, fall = (cube - 2.0 * square + s) * away, (cube - square) * away
        rec.write(f"v{self.lead}", rec.input(f"p{self.lead}") + s * away)
        for k in self.part.unknowns:
            begin, end = rec.input(f"p{k}"), rec.input(f"z{k}")
            bent = rise * rec.input(f"pr{k}") + fall * rec.input(f"zr{k}")
            rec.write(f"v{k}", begin + ahead * (end - begin) + bent)  # eq. (19)
        return rec

    def advance(self) -> Recorder:
        """The next part begins where this one ended, at a λ that is exact."""
        rec = Recorder()
        rec.write(f"w{self.lead}", rec.input(f"v{self.lead}"))
        rec.write(f"x{self.lead}", 0.0)
        for k in self.part.unknowns:
            rec.write(f"w{k}", rec.input(f"v{k}"))
            rec.write(f"x{k}", rec.input(f"e{k}"))
        return rec

    def aside(self) -> Recorder:
        """A place near ``w``: t there differs by half of ``bend`` times the distance squared."""
        rec = Recorder()
        bend = rec.absolute(rec.input("bend"))
        away = rec.sqrt(rec.divide(_CLEARLY * rec.input(f"x{self.n}"), bend))
        here = rec.input(f"w{self.lead}")
        least = _LEAST * self._scale(rec, self.lead)
        away = rec.largest([away, least])
        rec.write(f"v{self.lead}", here + rec.input("side") * away)
        for k in self.part.unknowns:
            rec.write(f"v{k}", rec.input(f"w{k}"))
        return rec


def fold_programs(table: LoopTable, lead: int, zeros: Set[str] = frozenset()) -> FoldPrograms:
    """The programs of a table with a single input, led by one of its unknowns.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    lead : int
        The unknown that leads.
    """
    writer = _FoldWriter(table, lead, zeros)
    recorded = {
        "iterate": writer.iterate(),
        "move": writer.move(),
        "prove": writer.prove(),
        "between": writer.between(),
        "advance": writer.advance(),
        "aside": writer.aside(),
    }
    registers = Registers()
    for rec in recorded.values():
        reserve(rec, registers)
    programs = {
        name: lower_program(rec, registers, registers.count) for name, rec in recorded.items()
    }
    return FoldPrograms(
        registers=registers,
        height=max(program.height for program in programs.values()),
        **programs,
    )
