"""The solvers of a table's equations, by the variable that is known."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import IndexArray
from linkwork.kernels.loop_table import LoopTable
from linkwork.kernels.single.quick_rows import quick_rows
from linkwork.kernels.table_splitter import TableSplitter
from linkwork.numerics.block_solver import Block, BlockSolver
from linkwork.numerics.decomposition import block_form

__all__ = ["LeaderSolvers"]


class LeaderSolvers:
    """The solvers of a table's equations with any variable as the known one, made when first asked
    for.

    Parameters
    ----------
    table : LoopTable
    solver : BlockSolver, optional
        Of the table with one input.
    """

    def __init__(self, table: LoopTable, solver: BlockSolver | None = None) -> None:
        self.table, self._solver = table, solver
        self._splitter, self._pattern = TableSplitter(table), table.pattern()
        self._found: dict[int, tuple[BlockSolver, IndexArray] | None] = {}
        if solver is not None:
            self._found[table.unknowns] = solver, np.arange(table.variables)

    def __reduce__(self) -> tuple[type[LeaderSolvers], tuple[object, ...]]:
        """Copies by pickle make their own."""
        return LeaderSolvers, (self.table, self._solver)

    def led_by(self, lead: int) -> tuple[BlockSolver, IndexArray] | None:
        """A solver, and the variables (N,) in its order; ``None`` if one does not determine all."""
        # a curve changes its parameter many times, but among few variables
        if lead not in self._found:
            self._found[lead] = self._make(lead)
        return self._found[lead]

    def _make(self, lead: int) -> tuple[BlockSolver, IndexArray] | None:
        table = self.table
        others = [k for k in range(table.variables) if k != lead]
        place = {old: new for new, old in enumerate([*others, lead])}
        loops = table.loops.rows
        pattern = [[place[k] for k in used if k != lead] for used in self._pattern]
        rows = [2] * loops + [1] * (len(pattern) - loops)
        form = block_form(pattern, rows, len(others))
        if not form.square:
            return None
        blocks = []
        for members, unknowns in form.blocks:
            mine = [others[k] for k in unknowns]
            part, known = self._splitter.part(list(members), mine)
            variables = [place[k] for k in (*mine, *known)]
            blocks.append(
                Block(
                    system=part,
                    equations=members,
                    unknowns=np.array(unknowns, dtype=np.intp),
                    variables=np.array(variables, dtype=np.intp),
                )
            )
        order: IndexArray = np.array([*others, lead], dtype=np.intp)
        scale = table.variable_scale[order]
        return BlockSolver(
            blocks, len(others), table.variables, scale, make_quick=quick_rows
        ), order
