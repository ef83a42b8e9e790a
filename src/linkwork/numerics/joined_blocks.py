"""Blocks put together again: one system of a block and everything it depends on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.numerics.block_solver import Block, BlockSolver

__all__ = ["JoinedBlocks", "closure_of"]


def closure_of(solver: BlockSolver, number: int) -> list[int]:
    """The blocks that a block depends on, itself last, in solving order."""
    home = {int(u): k for k, block in enumerate(solver.blocks) for u in block.unknowns}
    wanted, open_ = {number}, [number]
    while open_:
        block = solver.blocks[open_.pop()]
        for known in block.variables[len(block.unknowns) :]:
            before = home.get(int(known))
            if before is not None and before not in wanted:
                wanted.add(before)
                open_.append(before)
    return sorted(wanted)


@dataclass(frozen=True)
class JoinedBlocks:
    """Several blocks as one system over all variables of the whole.

    Variables are the blocks' unknowns in solving order, then the inputs of the whole.

    Parameters
    ----------
    solver : BlockSolver
    members : sequence of int
        Block numbers, closed under dependence.
    """

    solver: BlockSolver
    members: Sequence[int]

    @cached_property
    def blocks(self) -> list[Block]:
        """The member blocks."""
        return [self.solver.blocks[k] for k in self.members]

    @cached_property
    def order(self) -> IndexArray:
        """The variables of the whole in this system's order."""
        own = [block.unknowns for block in self.blocks]
        inputs = np.arange(self.solver.unknowns, self.solver.variables)
        return np.concatenate([*own, inputs]).astype(np.intp)

    @property
    def unknowns(self) -> int:
        """n."""
        return sum(len(block.unknowns) for block in self.blocks)

    @property
    def equation_scale(self) -> Array:
        """(n,)."""
        return np.concatenate([block.system.equation_scale for block in self.blocks])

    @property
    def variable_scale(self) -> Array:
        """(N,)."""
        return self.solver.variable_scale[self.order]

    @property
    def is_angle(self) -> BoolArray:
        """(N,)."""
        found = np.zeros(self.solver.variables, dtype=bool)
        for block in self.blocks:
            found[block.variables] |= block.system.is_angle
        return found[self.order]

    @property
    def single(self) -> None:
        """The blocks are joined as arrays only."""

    def _whole(self, v: Array) -> Array:
        whole = np.zeros((len(v), self.solver.variables))
        whole[:, self.order] = v
        return whole

    def residual(self, v: Array) -> Array:
        """F, (B, n)."""
        whole = self._whole(v)
        parts = [block.system.residual(whole[:, block.variables]) for block in self.blocks]
        return np.concatenate(parts, axis=1)

    def exact_residual(self, v: Array) -> tuple[Array, Array]:
        """F at one position v (N,), (n,), with as little rounding as the equations allow, and a
        bound of its error.
        """
        whole = self._whole(v[None, :])[0]
        parts = [block.system.exact_residual(whole[block.variables]) for block in self.blocks]
        values, errors = zip(*parts, strict=True)
        return np.concatenate(values), np.concatenate(errors)

    def jacobian(self, v: Array) -> Array:
        """dF/dv, (B, n, N)."""
        return self.residual_and_jacobian(v)[1]

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        """F, (B, n), and dF/dv, (B, n, N)."""
        whole = self._whole(v)
        order = self.order
        # columns of the whole in this system's order
        place = np.full(self.solver.variables, -1)
        place[order] = np.arange(len(order))
        residual, jacobian = [], np.zeros((len(v), self.unknowns, len(order)))
        row = 0
        for block in self.blocks:
            f, slope = block.system.residual_and_jacobian(whole[:, block.variables])
            residual.append(f)
            rows = np.arange(row, row + f.shape[1])
            jacobian[:, rows[:, None], place[block.variables][None, :]] = slope
            row += f.shape[1]
        return np.concatenate(residual, axis=1), jacobian

    def second_directional_derivative(self, v: Array, d: Array) -> Array:
        """D²F[d, d], (B, n)."""
        whole, direction = self._whole(v), self._whole(d)
        parts = [
            block.system.second_directional_derivative(
                whole[:, block.variables], direction[:, block.variables]
            )
            for block in self.blocks
        ]
        return np.concatenate(parts, axis=1)

    def hessians(self, v: Array, weights: Array) -> Array:
        """Second derivatives of K sums of equations, (K, N, N), with ``weights`` (K, n)."""
        whole, order = self._whole(v[None, :])[0], self.order
        found = np.zeros((len(weights), self.solver.variables, self.solver.variables))
        row = 0
        for block in self.blocks:
            own, n = block.variables, len(block.unknowns)
            found[:, own[:, None], own] += block.system.hessians(
                whole[own], weights[:, row : row + n]
            )
            row += n
        return found[:, order[:, None], order]

    def mixed(self, v: Array, a: Array, b: Array) -> Array:
        """D²F[a, b], (B, n), by polarisation."""
        # eq. (5)
        half: Array = 0.25 * (
            self.second_directional_derivative(v, a + b)
            - self.second_directional_derivative(v, a - b)
        )
        return half
