"""Solving a decomposed system block by block: positions, rates, condition."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray, StatusArray, inverses, matrix_vector
from linkwork.core.foundation.statuses import CONVERGED
from linkwork.core.numerics.newton import NewtonOptions, Watch, newton
from linkwork.core.numerics.single_rows import LARGE, MakeQuick, SingleBlock, SingleRows
from linkwork.core.numerics.system import SolvedRows, System

__all__ = ["Block", "BlockSolver", "Linearised", "linearise_block"]

# With arrays Newton-Raphson takes about as long on a block as this much work with numbers,
_ARRAYS = 150
_PROOFS = 75  # and a proof as this much;
_CALL = 15  # any block takes as much as this


@dataclass(frozen=True, kw_only=True)
class Block:
    """An irreducible part: its system, which variables of the whole it solves for, which it uses.

    ``variables`` lists the whole's variables in the part's order: unknowns, then known ones.
    """

    system: System
    equations: tuple[int, ...]
    unknowns: IndexArray
    variables: IndexArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Linearised:
    """A block at B positions: dF/dv (B, n, N), the inverse of its first n columns, sign of det."""

    jacobian: Array
    inverse: Array
    sign: StatusArray


@dataclass(frozen=True)
class BlockSolver:
    """A system in block-triangular form.

    Parameters
    ----------
    blocks : sequence of Block
        In solving order.
    unknowns, variables : int
        n and N of the whole.
    variable_scale : (N,)
    make_quick : MakeQuick, optional
        Compiled code for rows that are solved one by one.
    """

    blocks: Sequence[Block]
    unknowns: int
    variables: int
    variable_scale: Array
    options: NewtonOptions = field(default_factory=NewtonOptions)
    make_quick: MakeQuick | None = None

    @cached_property
    def one_by_one(self) -> SingleRows:
        """Rows one after the other, where :meth:`goes_singly`."""
        return SingleRows(self.singles, self.make_quick)

    @cached_property
    def singles(self) -> list[SingleBlock]:
        """The blocks in plain numbers; empty if one of them is not known so."""
        found = [
            SingleBlock(block.system, one, block.variables)
            for block in self.blocks
            if (one := block.system.single) is not None
        ]
        return found if len(found) == len(self.blocks) else []

    @cached_property
    def is_provable(self) -> bool:
        """Whether proofs know a bound for every block: of its curvature, or of its slopes."""
        systems = [block.system for block in self.blocks]
        return all(system.has_curvature_bound or system.is_enclosed for system in systems)

    @cached_property
    def has_formulas(self) -> bool:
        """Whether a block has equations of any formula, whose small residuals say little."""
        return any(block.system.is_enclosed for block in self.blocks)

    @cached_property
    def _share(self) -> float:
        """Of the work of a whole row, that of one block."""
        works = [_CALL + block.one.work for block in self.singles]
        return sum(works) / len(works) if works else math.inf

    def goes_singly(self, count: int) -> bool:
        """Whether so few rows are solved one by one in plain numbers."""
        return 0 < count * self._share <= _ARRAYS

    def is_proved_singly(self, count: int) -> bool:
        """Whether so few rows are proved one by one in plain numbers."""
        return 0 < count * self._share <= _PROOFS

    def solve(
        self,
        start: Array,
        options: NewtonOptions | None = None,
        watches: Sequence[Watch | None] | None = None,
    ) -> SolvedRows:
        """Newton-Raphson block by block from each row of ``start`` (B, N), inputs included.

        A row whose block fails keeps its guess in all later blocks.
        """
        if watches is None and self.goes_singly(len(start)):
            return self.one_by_one.solve(start, options or self.options)
        v = start.copy()
        count = len(v)
        status = np.full(count, CONVERGED, dtype=np.int8)
        failed = np.full(count, -1)
        iterations = np.zeros(count, dtype=np.int64)
        residual = np.zeros(count)
        first = np.zeros(count)
        contraction = np.zeros(count)
        live = np.arange(count)
        for k, block in enumerate(self.blocks):
            here = v[live[:, None], block.variables]
            done = newton(
                block.system, here, options or self.options, watches[k] if watches else None
            )
            v[live[:, None], block.unknowns] = done.v[:, : len(block.unknowns)]
            status[live] = done.status
            iterations[live] = np.maximum(iterations[live], done.iterations)
            residual[live] = np.maximum(residual[live], done.residual)
            first[live] = np.maximum(first[live], done.first_step)
            contraction[live] = np.maximum(contraction[live], done.contraction)
            wrong = done.status != CONVERGED
            if wrong.any():
                failed[live[wrong]] = k
                live = live[~wrong]
                if not len(live):
                    break
        return SolvedRows(
            v=v,
            status=status,
            failed_block=failed,
            iterations=iterations,
            residual=residual,
            first_step=first,
            contraction=contraction,
        )

    def linearise(self, v: Array) -> list[Linearised]:
        """Jacobian, its inverse and the sign of its determinant for every block at v (B, N)."""
        return [linearise_block(block, v) for block in self.blocks]

    def sharpen(self, v: Array) -> Array:
        """Positions (B, N) after one step of Newton-Raphson with residuals that are rounded once.

        Where branches nearly cross, a residual within the tolerance still moves a dead point. The
        correction of a block enters those of later blocks before anything is rounded. A position
        with a singular block stays.
        """
        change = np.zeros_like(v)
        for block, part in zip(self.blocks, self.linearise(v), strict=True):
            n, own = len(block.unknowns), block.variables
            residual = np.stack([block.system.exact_residual(row)[0] for row in v[:, own]])
            # the corrections of earlier blocks move the known variables
            residual += matrix_vector(part.jacobian[:, :, n:], change[:, own[n:]])
            change[:, block.unknowns] = -matrix_vector(part.inverse, residual)
        finite = np.isfinite(change).all(axis=1, keepdims=True)
        return np.where(finite, v + change, v)

    def rates(
        self,
        v: Array,
        input_rate: Array,
        linear: Sequence[Linearised] | None = None,
        input_bend: Array | float = 0.0,
    ) -> SolvedRows:
        """First and second derivative of all variables, as the inputs move.

        J x' = -F_u u';  J x'' = -D²F[(x', u'), (x', u')]: one inverse of J serves both and the
        condition number.

        Parameters
        ----------
        v : (B, N)
            Converged positions.
        input_rate : (p,) or (B, p)
            u' of the inputs.
        linear : list of Linearised, optional
            ``linearise(v)``, if computed already.
        input_bend : (B, p), optional
            u''; by default the rate is constant.

        Returns
        -------
        SolvedRows
            ``v``, ``first``, ``second``, ``condition``, ``nearness``, ``orientation``.
        """
        if linear is None and self.goes_singly(len(v)):
            return self.one_by_one.rates(v, input_rate, input_bend)
        parts = self.linearise(v) if linear is None else linear
        count = len(v)
        first = np.zeros((count, self.variables))
        second = np.zeros((count, self.variables))
        first[:, self.unknowns :] = input_rate
        second[:, self.unknowns :] = input_bend
        condition, nearness = np.ones(count), np.ones(count)
        orientation = np.zeros((count, len(self.blocks)), dtype=np.int8)
        for k, block in enumerate(self.blocks):
            n = len(block.unknowns)
            system = block.system
            here = v[:, block.variables]
            jacobian, inverse = parts[k].jacobian, parts[k].inverse
            # earlier blocks have left their rates there: they are known motions for this one
            known = block.variables[n:]
            direction = np.empty_like(here)
            direction[:, n:] = first[:, known]
            with np.errstate(over="ignore", invalid="ignore"):  # rates may be of any size
                # eq. (11)
                x1 = -matrix_vector(inverse, matrix_vector(jacobian[:, :, n:], direction[:, n:]))
                direction[:, :n] = x1
                # eq. (12)
                bend = system.second_directional_derivative(here, direction) + matrix_vector(
                    jacobian[:, :, n:], second[:, known]
                )
                x2 = -matrix_vector(inverse, bend)
            first[:, block.unknowns], second[:, block.unknowns] = x1, x2
            own = _condition(system, jacobian[:, :, :n], inverse)
            condition = np.maximum(condition, own)
            # balancing the columns costs more than the rates themselves
            if own.max(initial=0.0) > LARGE:
                own = _nearness(own, system.equation_scale, jacobian[:, :, :n], inverse)
            nearness = np.maximum(nearness, own)
            orientation[:, k] = parts[k].sign
        return SolvedRows(
            v=v,
            first=first,
            second=second,
            condition=condition,
            nearness=nearness,
            orientation=orientation,
        )

    def residual(self, v: Array) -> Array:
        """Largest scaled residual over all equations, (B,)."""
        worst = np.zeros(len(v))
        for block in self.blocks:
            f = block.system.residual(v[:, block.variables]) / block.system.equation_scale
            worst = np.maximum(worst, np.abs(f).max(axis=1, initial=0.0))
        return worst


def linearise_block(block: Block, v: Array) -> Linearised:
    """One block at v (B, N)."""
    jacobian = block.system.jacobian(v[:, block.variables])
    inverse, sign = _inverse(jacobian[:, :, : len(block.unknowns)])
    return Linearised(jacobian=jacobian, inverse=inverse, sign=sign)


def _inverse(jacobian: Array) -> tuple[Array, StatusArray]:
    """J⁻¹ and the sign of det J per lane; NaN and 0 where J is singular."""
    # the two positions that meet at a dead point have opposite signs
    sign = np.sign(np.linalg.det(jacobian))
    return inverses(jacobian), np.where(np.isfinite(sign), sign, 0).astype(np.int8)


def _condition(system: System, jacobian: Array, inverse: Array) -> Array:
    """‖J‖·‖J⁻¹‖ in the system's own weights, (B,)."""
    w, s = system.variable_scale[: jacobian.shape[2]], system.equation_scale
    with np.errstate(over="ignore", invalid="ignore"):
        forward = np.abs(jacobian * w / s[:, None]).sum(axis=2).max(axis=1, initial=0.0)
        backward = np.abs(inverse * s / w[:, None]).sum(axis=2).max(axis=1, initial=0.0)
        product: Array = forward * backward  # eq. (14)
    return np.where(np.isfinite(product), product, np.inf)


def _nearness(condition: Array, s: Array, jacobian: Array, inverse: Array) -> Array:
    """How near to a singular position, as far as rounding and bending equations go, (B,).

    ‖J⁻¹‖ counts twice in a proof (Newton-Kantorovich): for the size of errors, and for how much the
    equations bend. The latter does not depend on the ratio of the lengths, so that the condition
    with all columns of J equally long is taken for it: within a factor of √n the least that weights
    can bring about (van der Sluis 1969, doi:10.1007/BF02165096). The mean of both is returned.
    """
    scaled = np.abs(jacobian / s[:, None])
    longest = scaled.max(axis=1, initial=0.0)
    with np.errstate(all="ignore"):
        forward = (scaled / longest[:, None, :]).sum(axis=2).max(axis=1, initial=0.0)
        backward = np.abs(inverse * s * longest[:, :, None]).sum(axis=2).max(axis=1, initial=0.0)
        balanced = forward * backward
        least = np.where(np.isfinite(balanced), np.minimum(condition, balanced), condition)
        return np.asarray(np.sqrt(condition) * np.sqrt(least))  # eq. (15)
