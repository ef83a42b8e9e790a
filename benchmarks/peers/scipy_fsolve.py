"""SciPy's ``fsolve`` on the loop equations, with their Jacobian, row after row."""

from __future__ import annotations

from importlib import import_module
from math import cos, sin
from typing import Any

import numpy as np

from benchmarks.peers.dyad_linkage import Array, ComplexArray
from benchmarks.peers.loop_system import LoopSystem
from benchmarks.peers.peer import Peer, Prepared
from benchmarks.peers.work import Work

__all__ = ["ScipyFsolve"]


class ScipyFsolve(Peer):
    """The textbook recipe: the row before is the estimate of the next."""

    name = "scipy fsolve"
    distribution = "scipy"
    module = "scipy"
    most_members = 20

    def prepare(self, work: Work) -> Prepared:
        fsolve = import_module("scipy.optimize").fsolve

        def run() -> list[Array]:
            return [_rows(fsolve, member.loops, work.inputs) for member in work.members]

        def read(rows: list[Array]) -> ComplexArray:
            return np.array(
                [
                    member.loops.trace(q, work.inputs)
                    for member, q in zip(work.members, rows, strict=True)
                ]
            )

        return Prepared(run=run, read=read)


def _rows(fsolve: Any, system: LoopSystem, inputs: Array) -> Array:
    written = _WrittenLoops(system)
    q = system.start
    rows = np.empty((len(inputs), system.unknowns))
    for row, u in enumerate(inputs):
        driven = system.driven(u).tolist()
        q, _, found, _ = fsolve(
            written.residual, q, args=(driven,), fprime=written.jacobian, full_output=True
        )
        rows[row] = q if found == 1 else np.nan
    return rows


class _WrittenLoops:
    """The equations as one writes them for ``fsolve``: plain numbers, and no term that is zero.

    So small, they are evaluated faster than as products of NumPy arrays.
    """

    def __init__(self, system: LoopSystem) -> None:
        self.angles = system.angles
        table = np.hstack((system.turning, system.sliding))
        self.terms = [[(k, complex(line[k])) for k in np.flatnonzero(line)] for line in table]
        self.matrix = np.zeros((2 * len(table), system.unknowns))

    def residual(self, q: Array, driven: list[complex]) -> list[float]:
        phasors = self._phasors(q)
        gaps = []
        for terms, gap in zip(self.terms, driven, strict=True):
            for k, coefficient in terms:
                gap += coefficient * phasors[k]
            gaps += [gap.real, gap.imag]
        return gaps

    def jacobian(self, q: Array, _: list[complex]) -> Array:
        phasors = self._phasors(q)
        for j, terms in enumerate(self.terms):
            for k, coefficient in terms:
                slope = coefficient * (1j * phasors[k] if k < self.angles else 1.0)
                self.matrix[2 * j, k] = slope.real
                self.matrix[2 * j + 1, k] = slope.imag
        return self.matrix

    def _phasors(self, q: Array) -> list[complex]:
        values: list[complex] = q.tolist()
        turning = [complex(cos(x), sin(x)) for x in q[: self.angles].tolist()]
        return turning + values[self.angles :]
