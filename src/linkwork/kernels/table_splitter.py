"""Cutting a loop table into the tables of its blocks."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import IndexArray
from linkwork.kernels.loop_table import LoopTable
from linkwork.kernels.phasor_rows import PhasorRows
from linkwork.kernels.real_rows import LinearRows

__all__ = ["TableSplitter"]


class TableSplitter:
    """Cuts a table into smaller ones; sparse, so that n cuts cost no more than the table."""

    def __init__(self, table: LoopTable) -> None:
        self.table = table
        loops, linear = table.loops, table.linear
        self._terms_of_row = _by_value(loops.row, loops.rows)
        self._entries_of_term = _by_value(loops.phase_term, len(loops.row))
        self._entries_of_linear = _by_value(linear.row, len(linear.constant))

    def part(self, equations: list[int], unknowns: list[int]) -> tuple[LoopTable, list[int]]:
        """The table of some equations (numbered as in ``pattern``) for some unknowns.

        Returns the table and the variables of the whole that it takes as inputs.
        """
        whole = self.table
        loops, lines, functions = self._sorted_out(equations)
        pattern = self._pattern(loops, lines) | {
            k for f in functions for k in whole.functions[f].variables
        }
        known = sorted(pattern - set(unknowns))
        index = {old: new for new, old in enumerate([*unknowns, *known])}
        order = np.array([*unknowns, *known], dtype=np.intp)
        n_loops, n_lines = whole.loops.rows, len(whole.linear.constant)
        real = [
            *loops,
            *[n_loops + k for k in loops],
            *[2 * n_loops + k for k in lines],
            *[2 * n_loops + n_lines + k for k in functions],
        ]
        part = LoopTable(
            unknowns=len(unknowns),
            loops=self._loops(loops, index),
            linear=self._linear(lines, index),
            functions=tuple(whole.functions[k].moved(index) for k in functions),
            equation_scale=whole.equation_scale[np.array(real, dtype=np.intp)],
            variable_scale=whole.variable_scale[order],
            is_angle=whole.is_angle[order],
            link_constant=None if whole.link_constant is None else whole.link_constant[order],
        )
        return part, known

    def _sorted_out(self, equations: list[int]) -> tuple[list[int], list[int], list[int]]:
        n_loops, n_lines = self.table.loops.rows, len(self.table.linear.constant)
        loops = [k for k in equations if k < n_loops]
        lines = [k - n_loops for k in equations if n_loops <= k < n_loops + n_lines]
        functions = [k - n_loops - n_lines for k in equations if k >= n_loops + n_lines]
        return loops, lines, functions

    def _pattern(self, loops: list[int], lines: list[int]) -> set[int]:
        table = self.table
        found: set[int] = set()
        for row in loops:
            for term in self._terms_of_row[row]:
                if table.loops.length[term] >= 0:
                    found.add(int(table.loops.length[term]))
                found.update(
                    int(table.loops.phase_variable[e]) for e in self._entries_of_term[term]
                )
        for row in lines:
            found.update(int(table.linear.variable[e]) for e in self._entries_of_linear[row])
        return found

    def _loops(self, rows: list[int], index: dict[int, int]) -> PhasorRows:
        loops = self.table.loops
        terms = [(new, t) for new, row in enumerate(rows) for t in self._terms_of_row[row]]
        entries = [(new, e) for new, (_, t) in enumerate(terms) for e in self._entries_of_term[t]]
        own = np.array([t for _, t in terms], dtype=np.intp)
        return PhasorRows(
            rows=len(rows),
            variables=len(index),
            row=np.array([new for new, _ in terms], dtype=np.intp),
            coefficient=loops.coefficient[own],
            length=np.array([index.get(int(k), -1) for k in loops.length[own]], dtype=np.intp),
            phase_term=np.array([new for new, _ in entries], dtype=np.intp),
            phase_variable=np.array(
                [index[int(loops.phase_variable[e])] for _, e in entries], dtype=np.intp
            ),
            phase_weight=np.array([loops.phase_weight[e] for _, e in entries], dtype=float),
        )

    def _linear(self, rows: list[int], index: dict[int, int]) -> LinearRows:
        linear = self.table.linear
        entries = [(new, e) for new, row in enumerate(rows) for e in self._entries_of_linear[row]]
        return LinearRows(
            constant=linear.constant[np.array(rows, dtype=np.intp)],
            row=np.array([new for new, _ in entries], dtype=np.intp),
            variable=np.array([index[int(linear.variable[e])] for _, e in entries], dtype=np.intp),
            weight=np.array([linear.weight[e] for _, e in entries], dtype=float),
        )


def _by_value(values: IndexArray, count: int) -> list[list[int]]:
    found: list[list[int]] = [[] for _ in range(count)]
    for k, value in enumerate(values):
        found[value].append(k)
    return found
