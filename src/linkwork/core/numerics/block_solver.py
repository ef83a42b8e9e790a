"""Solving a decomposed system block by block: positions, rates, condition."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray, StatusArray, inverses, matrix_vector
from linkwork.core.foundation.statuses import CONVERGED
from linkwork.core.numerics.newton import NewtonOptions, Recorded, SolvedRows, System, Watch, newton

FEW = 24  # rows that floats solve, one after the other, as fast as arrays all together
LARGE = 1e3  # condition up to which balanced columns are not tried


@dataclass(frozen=True, kw_only=True)
class Block:
    """An irreducible part: its system, which variables of the whole it solves for, which it uses.

    ``variables`` lists the whole's variables in the part's order: unknowns, then known ones.
    ``record``: the part's arithmetic as functions, where it is recorded.
    """

    system: System
    equations: tuple[int, ...]
    unknowns: IndexArray
    variables: IndexArray
    record: Recorded | None = None

    @cached_property
    def places(self) -> list[int]:
        """``variables`` as a list."""
        return list(map(int, self.variables))

    @cached_property
    def alone(self) -> BlockSolver:
        """The block by itself: its variables in its own order, the known ones as inputs."""
        n, count = len(self.unknowns), len(self.variables)
        own = replace(self, unknowns=np.arange(n), variables=np.arange(count))
        return BlockSolver([own], n, count, self.system.variable_scale)


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
    """

    blocks: Sequence[Block]
    unknowns: int
    variables: int
    variable_scale: Array
    options: NewtonOptions = field(default_factory=NewtonOptions)

    @cached_property
    def is_recorded(self) -> bool:
        """Whether all blocks are recorded."""
        return all(block.record is not None for block in self.blocks)

    @cached_property
    def is_provable(self) -> bool:
        """Whether proofs know a bound for every block: of its curvature, or of its slopes."""
        systems = [block.system for block in self.blocks]
        return all(system.has_curvature_bound or system.is_enclosed for system in systems)

    @cached_property
    def has_formulas(self) -> bool:
        """Whether a block has equations of any formula, whose small residuals say little."""
        return any(block.system.is_enclosed for block in self.blocks)

    def goes_singly(self, count: int) -> bool:
        """Whether so few rows are solved and proved one by one, on floats."""
        return self.is_recorded and 0 < count <= FEW

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
            return self._solve_singly(start, options or self.options)
        v = start.copy()
        count = len(v)
        status = np.full(count, CONVERGED, dtype=np.int8)
        failed = np.full(count, -1)
        names = ("residual", "first_step", "contraction")
        largest: dict[str, Any] = {name: np.zeros(count) for name in names}
        largest["iterations"] = np.zeros(count, dtype=np.int64)
        live = np.arange(count)
        for k, block in enumerate(self.blocks):
            here = v[live[:, None], block.variables]
            watch = watches[k] if watches else None
            done = newton(block.system, here, options or self.options, watch)
            v[live[:, None], block.unknowns] = done.v[:, : len(block.unknowns)]
            status[live] = done.status
            for name, column in largest.items():
                column[live] = np.maximum(column[live], getattr(done, name))
            wrong = done.status != CONVERGED
            if wrong.any():
                failed[live[wrong]] = k
                live = live[~wrong]
                if not len(live):
                    break
        return SolvedRows(v=v, status=status, failed_block=failed, **largest)

    def solve_row(self, v: list[float], options: NewtonOptions) -> SingleSolution:
        """Newton-Raphson block by block from v (N,), in place, on floats.

        A row whose block fails keeps its guess in later ones.
        """
        found = SingleSolution()
        limits = (
            options.max_steps, options.equation_tolerance, options.solution_tolerance,
            options.largest_turn,
        )  # fmt: skip
        for number, block in enumerate(self.blocks):
            record = block.record
            assert record is not None
            places = block.places
            status, count, error, first, contraction, *x = record.of_floats.solve(
                *[v[k] for k in places], *limits
            )
            for k, value in zip(places, x, strict=False):
                v[k] = value
            found.iterations = max(found.iterations, count)
            found.residual = error if error != error else max(found.residual, error)
            found.first_step = max(found.first_step, first)
            found.contraction = max(found.contraction, contraction)
            if status:
                found.status, found.failed_block = status, number
                break
        return found

    def rates_row(
        self, v: list[float], first: list[float], second: list[float]
    ) -> tuple[float, float, list[int]]:
        """:meth:`rates` at one position v (N,), on floats: condition, nearness, signs.

        ``first``, ``second`` (N,): with u' and u'' of the inputs in place, filled with the rates of
        the unknowns.
        """
        condition = nearness = 1.0
        signs = []
        for block in self.blocks:
            record = block.record
            assert record is not None
            places, n = block.places, len(block.unknowns)
            here, known = [v[k] for k in places], places[n:]
            rates = record.of_floats.rates
            try:
                *found, own, determinant = rates(
                    *here, *[first[k] for k in known], *[second[k] for k in known]
                )
            except (ArithmeticError, ValueError):  # a singular Jacobian
                found, own, determinant = [math.nan] * (2 * n), math.inf, 0.0
            for k, x, y in zip(places, found, found[n:], strict=False):
                first[k], second[k] = x, y
            own = own if own < math.inf else math.inf
            condition = max(condition, own)
            if own > LARGE:  # balancing the columns costs more than the rates themselves
                own = math.sqrt(own) * math.sqrt(min(own, _balanced(record, here)))  # eq. (15)
            nearness = max(nearness, own)
            signs.append((determinant > 0.0) - (determinant < 0.0))
        return condition, nearness, signs

    def _solve_singly(self, start: Array, options: NewtonOptions) -> SolvedRows:
        """:meth:`solve` for a few rows."""
        rows = start.tolist()
        done = [self.solve_row(row, options) for row in rows]
        names = ("failed_block", "iterations", "residual", "first_step", "contraction")
        return SolvedRows(
            v=np.array(rows).reshape(start.shape),
            status=np.array([x.status for x in done], dtype=np.int8),
            **{name: np.array([getattr(x, name) for x in done]) for name in names},
        )

    def _rates_singly(self, v: Array, input_rate: Array, input_bend: Array | float) -> SolvedRows:
        """:meth:`rates` for a few rows."""
        first, second = np.zeros_like(v), np.zeros_like(v)
        first[:, self.unknowns :], second[:, self.unknowns :] = input_rate, input_bend
        rows = v.tolist(), first.tolist(), second.tolist()
        found = [self.rates_row(a, b, c) for a, b, c in zip(rows[0], rows[1], rows[2], strict=True)]
        return SolvedRows(
            v=v,
            first=np.array(rows[1]),
            second=np.array(rows[2]),
            condition=np.array([x for x, _, _ in found]),
            nearness=np.array([x for _, x, _ in found]),
            orientation=np.array([x for _, _, x in found], dtype=np.int8).reshape(len(v), -1),
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
        input_bend: Array | float = 0.0,
    ) -> SolvedRows:
        """First and second derivative of all variables, as the inputs move.

        J x' = -F_u u';  J x'' = -D²F[(x', u'), (x', u')].

        Parameters
        ----------
        v : (B, N)
            Converged positions.
        input_rate : (p,) or (B, p)
            u' of the inputs.
        input_bend : (B, p), optional
            u''; by default the rate is constant.

        Returns
        -------
        SolvedRows
            ``v``, ``first``, ``second``, ``condition``, ``nearness``, ``orientation``.
        """
        if self.goes_singly(len(v)):
            return self._rates_singly(v, input_rate, input_bend)
        count = len(v)
        first = np.zeros((count, self.variables))
        second = np.zeros((count, self.variables))
        first[:, self.unknowns :] = input_rate
        second[:, self.unknowns :] = input_bend
        condition, nearness = np.ones(count), np.ones(count)
        orientation = np.zeros((count, len(self.blocks)), dtype=np.int8)
        for k, block in enumerate(self.blocks):
            rates = _array_rates if block.record is None else _recorded_rates
            own, near, orientation[:, k] = rates(block, v, first, second)
            condition, nearness = np.maximum(condition, own), np.maximum(nearness, near)
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


@dataclass(slots=True)
class SingleSolution:
    """How Newton-Raphson ended for one row; columns of :class:`SolvedRows`."""

    status: int = CONVERGED
    failed_block: int = -1
    iterations: int = 0
    residual: float = 0.0
    first_step: float = 0.0
    contraction: float = 0.0


def _columns(v: Array) -> list[Array]:
    """The columns of v (B, N), each in one piece."""
    return list(np.ascontiguousarray(v.T))


def _array_rates(
    block: Block, v: Array, first: Array, second: Array
) -> tuple[Array, Array, StatusArray]:
    """Rates of one block, in place: condition, nearness, signs of determinants.

    The blocks before have left their rates there: they are known motions for this one.
    """
    system, part, n = block.system, linearise_block(block, v), len(block.unknowns)
    here, known = v[:, block.variables], block.variables[n:]
    jacobian, inverse = part.jacobian, part.inverse
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
    condition = nearness = _condition(system, jacobian[:, :, :n], inverse)
    # balancing the columns costs more than the rates themselves
    if condition.max(initial=0.0) > LARGE:
        nearness = _nearness(condition, system.equation_scale, jacobian[:, :, :n], inverse)
    return condition, nearness, part.sign


def _recorded_rates(
    block: Block, v: Array, first: Array, second: Array
) -> tuple[Array, Array, StatusArray]:
    """The same by the block's record."""
    n, known = len(block.unknowns), block.variables[len(block.unknowns) :]
    here = _columns(v[:, block.variables])
    assert block.record is not None
    functions, count = block.record.of_arrays, len(v)
    with np.errstate(all="ignore"):
        *found, own, determinant = functions.rates(
            *here, *_columns(first[:, known]), *_columns(second[:, known])
        )
        for i, k in enumerate(block.unknowns):
            first[:, k], second[:, k] = found[i], found[n + i]
        condition = np.broadcast_to(own, count)
        condition = np.where(np.isfinite(condition), condition, np.inf)
        nearness, risen = condition, np.flatnonzero(condition > LARGE)
        if len(risen):
            (balanced,) = functions.balanced(*(x[risen] for x in here))
            nearness = condition.copy()
            nearness[risen] = _mean_condition(condition[risen], balanced)
        sign = np.nan_to_num(np.sign(determinant))
    return condition, nearness, np.broadcast_to(sign, count).astype(np.int8)


def _balanced(record: Recorded, v: list[float]) -> float:
    """The condition with equally long columns at one position."""
    balanced = record.of_floats.balanced
    try:
        (found,) = balanced(*v)
    except (ArithmeticError, ValueError):
        return math.inf
    return float(found) if found == found else math.inf


def _mean_condition(condition: Array, balanced: Array) -> Array:
    """The geometric mean of both conditions, see :func:`_nearness`; the first is the largest."""
    least = np.where(np.isfinite(balanced), np.minimum(condition, balanced), condition)
    return np.asarray(np.sqrt(condition) * np.sqrt(least))  # eq. (15)


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
        return _mean_condition(condition, forward * backward)
