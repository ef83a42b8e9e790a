"""The closure equations with another variable as parameter (local parametrization).

Near a dead point the input is no suitable parameter, but a fast-moving link is. The equations do
not change: the input becomes an unknown, the parameter becomes known, and the block-triangular form
is recomputed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.equations.leader_solvers import LeaderSolvers
from linkwork.foundation.arrays import Array
from linkwork.kernels.loop_table import LoopTable
from linkwork.kernels.real_rows import LinearRows
from linkwork.numerics.continuation.branch_tracking import InputPath
from linkwork.numerics.continuation.local_parametrization import Parametrization

__all__ = ["ParametrizedTable"]


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
