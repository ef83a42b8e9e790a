"""The programs of one topology: predict, solve block by block, take or leave the step.

Registers by name, one number per lane each:

``t`` ``t1`` ``t0``         the value of the path tried, at the last node, at the one before
``u<j>.origin`` ``.rate``   inputs along the path: u = origin + rate t
``u<j>.spread``             how far the inputs of a row may be from those, beside their own rounding
``v<k>`` ``w<k>`` ``q<k>``  variables at the trial, at the last node, at the one before
``r<k>`` ``s<k>`` ``p<k>``  their derivatives by t there
``scale<k>``, ``size<b>``   weights of variables, sizes of a block's residuals
``first``                   1.0 where there is no node before the last
``live<b>``                 1.0 where block b still iterates
``step<b>`` ``begin<b>``    weighted size of the latest and of the first correction
``side<b>`` ``sign<b>``     the sign of det J at the trial and at the last node
``e<k>`` ``x<k>``           how far the true position may be from the trial, from the last node
``radius``                  the largest of the former, weighted
``y<k>``                    how far it may get from the trial on the way between both
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass

import numpy as np

from linkwork.kernels.lanes.closure import BlockPart, Closure, solved
from linkwork.kernels.lanes.program import Program, Recorder, Registers, Value, lowered, reserve
from linkwork.kernels.lanes.proof_program import BlockProof
from linkwork.kernels.loop_table import LoopTable

__all__ = ["MarchPrograms", "march_programs"]

_UNIT = float(np.finfo(float).eps) / 2.0
_FARTHEST = 16.0  # distances of the last two nodes that the cubic is trusted beyond them


@dataclass(frozen=True, kw_only=True, eq=False)
class MarchPrograms:
    """``predict``; ``begin`` and ``iterate`` of every block; ``judge``; ``take`` the step."""

    registers: Registers
    height: int
    predict: Program
    begin: tuple[Program, ...]
    damped: tuple[Program, ...]
    iterate: tuple[Program, ...]
    prove: tuple[Program, ...]
    judge: Program
    take: Program
    stand: Program


class _Writer:
    """Records the programs of one table."""

    def __init__(
        self, table: LoopTable, parts: Sequence[BlockPart], zeros: Set[str], certified: bool
    ) -> None:
        self.table, self.parts, self.zeros, self.certified = table, parts, zeros, certified
        self.n, self.count = table.unknowns, table.variables
        self.alone = self.count == self.n + 1  # a single input is the path's own value

    def _scale(self, rec: Recorder, k: int) -> Value:
        """The weight of a variable: 1 for angles."""
        return rec.constant(1.0) if self.table.turns[k] else rec.input(f"scale{k}")

    def _rate(self, rec: Recorder, j: int) -> Value:
        """By how much an input changes with t."""
        return rec.constant(1.0) if self.alone else rec.input(f"u{j}.rate")

    def _weighted(self, rec: Recorder, k: int, change: Value) -> Value:
        """|change| of a variable in its weight."""
        return abs(change) if self.table.turns[k] else abs(change) / rec.input(f"scale{k}")

    def predict(self) -> Recorder:
        """The cubic through both last nodes with their derivatives, at t; the inputs there.

        Nodes that lie much nearer together than the step is long tell nothing but their rounding:
        then, and without a node before the last, the tangent.
        """
        rec = Recorder()
        t, t1, t0 = rec.input("t"), rec.input("t1"), rec.input("t0")
        h, apart = t - t1, t1 - t0
        near = rec.at_most(abs(h), _FARTHEST * abs(apart))
        usable = rec.where(rec.input("first"), 0.0, near)
        inverse = rec.where(usable, 1.0 / apart, 0.0)
        q = h * inverse
        more = q + 1.0
        for k in range(self.n):
            x1, x0 = rec.input(f"w{k}"), rec.input(f"q{k}")
            r1, r0 = rec.input(f"s{k}"), rec.input(f"p{k}")
            slope = (x1 - x0) * inverse
            a, e = r1 - slope, r0 - slope
            rec.write(f"v{k}", x1 + h * (r1 + q * (a + more * (e + a))))
        for j in range(self.count - self.n):
            value = t if self.alone else rec.input(f"u{j}.origin") + self._rate(rec, j) * t
            rec.write(f"v{self.n + j}", value)
        for b in range(len(self.parts)):
            rec.write(f"live{b}", rec.input("active"))
        return rec

    def _moved(self, rec: Recorder, k: int) -> Value:
        """The rate of a variable that a block takes as known."""
        return rec.input(f"r{k}") if k < self.n else self._rate(rec, k - self.n)

    def iterate(self, number: int, first: bool, damped: bool) -> Recorder:
        """One Newton-Raphson step of a block; without proofs with rates and the sign of det J."""
        part, rec = self.parts[number], Recorder()
        v = [rec.input(f"v{k}") for k in range(self.count)]
        closure = Closure(self.table, part, rec, v, self.zeros)
        known = closure.known()
        slopes = [] if self.certified else closure.jacobian(known)
        drives = [
            rec.total(
                [rec.multiply(x, self._moved(rec, k)) for x, k in zip(row, known, strict=True)]
            )
            for row in slopes
        ]
        matrix = closure.jacobian(part.unknowns)
        f = closure.residual()
        answer = solved(rec, matrix, [f] if self.certified else [f, drives])
        change = answer.columns[0]
        live = rec.input(f"live{number}")
        turns = [abs(d) for d, k in zip(change, part.unknowns, strict=True) if self.table.turns[k]]
        if damped and turns:
            factor = rec.smallest([1.0, rec.input("most_turn") / rec.largest(turns)])
            change = [factor * d for d in change]
        size = rec.largest(
            self._weighted(rec, k, d) for d, k in zip(change, part.unknowns, strict=True)
        )
        for d, k in zip(change, part.unknowns, strict=True):
            rec.write(f"v{k}", rec.where(live, v[k] - d, v[k]))
        for moved in answer.columns[1:]:
            for r, k in zip(moved, part.unknowns, strict=True):
                rec.write(f"r{k}", rec.where(live, -r, rec.input(f"r{k}")))
        if not self.certified:
            rec.write(f"step{number}", rec.where(live, size, rec.input(f"step{number}")))
        if not self.certified:
            if first:
                rec.write(f"begin{number}", size)
            side = rec.where(live, answer.determinant, rec.input(f"side{number}"))
            rec.write(f"side{number}", side)
        goes_on = rec.at_most(size, rec.input("tolerance"))
        rec.write(f"live{number}", rec.where(goes_on, 0.0, live))
        return rec

    def prove(self, number: int) -> Recorder:
        """A block's proof: of the trial, and that it lies on the branch of the last node."""
        rec, part = Recorder(), self.parts[number]
        v = [rec.input(f"v{k}") for k in range(self.count)]
        closure = Closure(self.table, part, rec, v, self.zeros)
        used = (*part.unknowns, *closure.known())
        proof = BlockProof(closure, {k: self._scale(rec, k) for k in used})
        near: dict[int, Value] = {}
        far: dict[int, Value] = {}
        step = abs(rec.input("t") - rec.input("t1")) * (1.0 + 16.0 * _UNIT)
        for k in proof.known:
            if k < self.n:
                near[k], far[k] = rec.input(f"e{k}"), rec.input(f"y{k}")
            else:
                near[k] = abs(v[k]) * (4.0 * _UNIT) + rec.input(f"u{k - self.n}.spread")
                far[k] = step * abs(self._rate(rec, k - self.n)) + 2.0 * near[k]
        for k, rate in zip(part.unknowns, proof.rates(self._moved), strict=True):
            rec.write(f"r{k}", rate)
        here, there = proof.within(near), proof.within(far)
        masks = [here.holds, there.holds]
        for k, error, reach, alone in zip(
            part.unknowns, here.each, there.each, there.alone, strict=True
        ):
            rec.write(f"e{k}", error)
            rec.write(f"y{k}", reach)
            away = abs(v[k] - rec.input(f"w{k}")) + rec.largest([error, rec.input(f"x{k}")])
            masks.append(rec.at_most(away, alone * (1.0 - 4.0 * _UNIT)))
        rec.write(f"ok{number}", rec.all_of(masks))
        rec.write(f"radius{number}", here.radius)
        return rec

    def judge_proof(self) -> Recorder:
        """``good``: where everything is proved."""
        rec = Recorder()
        masks = [rec.input(f"ok{b}") for b in range(len(self.parts))]
        # what has not converged may be proved, but its radius would be of no use
        masks += [rec.at_most(rec.input(f"live{b}"), 0.0) for b in range(len(self.parts))]
        rec.write("radius", rec.largest(rec.input(f"radius{b}") for b in range(len(self.parts))))
        rec.write("good", rec.all_of([*masks, rec.input("active")]))
        return rec

    def judge(self) -> Recorder:
        """``good``: where the step may be taken."""
        rec = Recorder()
        masks = []
        for b in range(len(self.parts)):
            masks.append(rec.at_most(rec.input(f"step{b}"), rec.input("tolerance")))
            masks.append(rec.at_most(rec.input(f"begin{b}"), rec.input("most_correction")))
            product = rec.input(f"side{b}") * rec.input(f"sign{b}")
            masks.append(rec.at_most(0.0, product))
        h = rec.input("t") - rec.input("t1")
        drifts = [
            self._weighted(rec, k, (rec.input(f"r{k}") - rec.input(f"s{k}")) * h)
            for k in range(self.n)
        ]
        masks.append(rec.at_most(rec.largest(drifts), rec.input("most_drift")))
        rec.write("good", rec.all_of([*masks, rec.input("active")]))
        return rec

    def take(self) -> Recorder:
        """Where ``good``, the trial becomes the last node."""
        rec = Recorder()
        t, t1 = rec.input("t"), rec.input("t1")
        stands = rec.at_most(t, t1) * rec.at_most(t1, t)  # a row at the very node
        moves = rec.input("good") * (1.0 - stands)

        def moved(new: str, old: str) -> Value:
            return rec.where(moves, rec.input(new), rec.input(old))

        for k in range(self.n):
            rec.write(f"q{k}", moved(f"w{k}", f"q{k}"))
            rec.write(f"p{k}", moved(f"s{k}", f"p{k}"))
            rec.write(f"w{k}", moved(f"v{k}", f"w{k}"))
            rec.write(f"s{k}", moved(f"r{k}", f"s{k}"))
            if self.certified:
                rec.write(f"x{k}", moved(f"e{k}", f"x{k}"))
        rec.write("t0", moved("t1", "t0"))
        rec.write("t1", moved("t", "t1"))
        rec.write("first", rec.where(moves, 0.0, rec.input("first")))
        for b in range(0 if self.certified else len(self.parts)):
            rec.write(f"sign{b}", moved(f"side{b}", f"sign{b}"))
        return rec

    def stand(self) -> Recorder:
        """The trial becomes the first node."""
        rec = Recorder()
        for k in range(self.n):
            for to, source in (("w", "v"), ("q", "v"), ("s", "r"), ("p", "r")):
                rec.write(f"{to}{k}", rec.input(f"{source}{k}"))
            if self.certified:
                rec.write(f"x{k}", rec.input(f"e{k}"))
        for b in range(0 if self.certified else len(self.parts)):
            rec.write(f"sign{b}", rec.input(f"side{b}"))
        for name in ("t0", "t1"):
            rec.write(name, rec.input("t"))
        rec.write("first", 1.0)
        return rec


def march_programs(
    table: LoopTable,
    parts: Sequence[BlockPart],
    zeros: Set[str] = frozenset(),
    certified: bool = False,
) -> MarchPrograms:
    """The programs of a table in blocks.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    parts : sequence of BlockPart
        Blocks in the order in which they are solved.
    zeros : set of str
        Names of coefficients that are zero in every design.
    """
    writer = _Writer(table, parts, zeros, certified)
    blocks = range(len(parts))
    recorded = [
        writer.predict(),
        writer.judge_proof() if certified else writer.judge(),
        writer.take(),
        writer.stand(),
        *[writer.iterate(b, first=True, damped=False) for b in blocks],
        *[writer.iterate(b, first=False, damped=True) for b in blocks],
        *[writer.iterate(b, first=False, damped=False) for b in blocks],
        *[writer.prove(b) for b in blocks if certified],
    ]
    registers = Registers()
    for rec in recorded:
        reserve(rec, registers)
    programs = [lowered(rec, registers, registers.count) for rec in recorded]
    predict, judge, take, stand, *rest = programs
    count = len(parts)
    return MarchPrograms(
        registers=registers,
        height=max(program.height for program in programs),
        predict=predict,
        judge=judge,
        take=take,
        stand=stand,
        begin=tuple(rest[:count]),
        damped=tuple(rest[count : 2 * count]),
        iterate=tuple(rest[2 * count : 3 * count]),
        prove=tuple(rest[3 * count :]),
    )
