"""The closure equations with another variable as parameter (local parametrization).

Near a dead point the input is no suitable parameter, but a fast-moving link is. The equations do
not change: the input becomes an unknown, the parameter becomes known, and the block-triangular form
is recomputed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.kernels.loop_table import LoopTable, TableSplitter
from linkwork.kernels.real_rows import LinearRows
from linkwork.kernels.single.quick_rows import quick_rows
from linkwork.numerics.block_solver import Block, BlockSolver
from linkwork.numerics.continuation.branch_tracking import InputPath
from linkwork.numerics.continuation.local_parametrization import Parametrization
from linkwork.numerics.decomposition import block_form

__all__ = ["LeaderSolvers", "ParametrizedTable"]


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


class ParametrizedTable:
    """A table along a path of inputs, solvable with any variable as parameter.

    Parameters
    ----------
    table : LoopTable
        n unknowns and p inputs.
    path : InputPath
        The common motion of the inputs.
    parameter : int
        Index of the input that parametrises the path (0 … p-1).
    solvers : LeaderSolvers, optional
        Of the table; they serve a single input.
    """

    def __init__(
        self,
        table: LoopTable,
        path: InputPath,
        parameter: int,
        solvers: LeaderSolvers | None = None,
    ) -> None:
        self.parameter = table.unknowns + parameter
        self.table = _lock_inputs(table, path, parameter)
        self.scale = self.table.variable_scale
        self.is_angle = self.table.is_angle
        self.repeats_after = self.table.repeats_after
        own = solvers if self.table is table else None
        self._solvers = own or LeaderSolvers(self.table)
        self._leads: dict[int, Parametrization | None] = {}

    def with_parameter(self, lead: int) -> Parametrization | None:
        """The equations with one variable known; ``None`` if it does not determine the others."""
        if lead not in self._leads:
            found = self._solvers.led_by(lead)
            self._leads[lead] = found and Parametrization(
                lead=lead, solver=found[0], order=found[1]
            )
        return self._leads[lead]

    def jacobian(self, v: Array) -> Array:
        """The scaled Jacobian with respect to all variables but the path parameter, (B, m, m)."""
        table = self.table
        one = table.single if len(v) == 1 else None
        slope = (
            table.jacobian(v)
            if one is None
            else np.array([one.residual_and_jacobian(v[0].tolist())[1]])
        )
        slope = slope * table.variable_scale / table.equation_scale[:, None]
        return np.delete(slope, self.parameter, axis=2)

    def _bend(self, v: Array, directions: Array) -> Array:
        """D²F[d, d] at a position v (N,) for directions (B, N), (B, m)."""
        one = self.table.single
        if one is None:
            places = np.tile(v, (len(directions), 1))
            return self.table.second_directional_derivative(places, directions)
        here = v.tolist()
        return np.array([one.second_directional_derivative(here, d) for d in directions.tolist()])

    def weakening(self, v: Array, rates: Array) -> float:
        """The rate of the smallest singular value σ of the scaled Jacobian at a position v (N,).

        dσ = uᵀ dJ w with the singular vectors u and w (Golub & Van Loan, Matrix Computations, 8.6),
        and dJ w is the mixed second derivative of the equations along w and ``rates`` (N,).
        """
        table = self.table
        left, _, right = np.linalg.svd(self.jacobian(v[None, :])[0])
        w = np.insert(right[-1], self.parameter, 0.0) * table.variable_scale
        both = np.stack([rates + w, rates - w])
        # eq. (5)
        change = 0.25 * np.subtract(*self._bend(v, both))
        return float(left[:, -1] @ (change / table.equation_scale))  # eq. (16)


def _lock_inputs(table: LoopTable, path: InputPath, parameter: int) -> LoopTable:
    """The table with a linear row for every other input: u_j = origin_j + rate_j t."""
    n = table.unknowns
    others = [j for j in range(len(path.rate)) if j != parameter]
    if not others:
        return table
    lines, old = table.linear, len(table.linear.constant)
    ratio = path.rate / path.rate[parameter]
    # u_j = origin_j + ratio_j (u_lead - origin_lead)
    offset = path.origin - ratio * path.origin[parameter]
    entries = [
        entry
        for row, j in enumerate(others)
        for entry in ((old + row, n + j, 1.0), (old + row, n + parameter, -ratio[j]))
        if entry[2] != 0.0
    ]
    at = 2 * table.loops.rows + old
    return replace(
        table,
        linear=LinearRows(
            constant=np.concatenate([lines.constant, [-offset[j] for j in others]]),
            row=np.concatenate([lines.row, [row for row, _, _ in entries]]).astype(np.intp),
            variable=np.concatenate([lines.variable, [k for _, k, _ in entries]]).astype(np.intp),
            weight=np.concatenate([lines.weight, [w for _, _, w in entries]]),
        ),
        equation_scale=np.insert(
            table.equation_scale, at, table.variable_scale[[n + j for j in others]]
        ),
    )
