"""Linear equations with few unknowns, in plain numbers and with the roundings of compiled code."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray, StatusArray
from linkwork.core.foundation.statuses import CONVERGED, Status
from linkwork.core.numerics.newton import FAR, SMALLEST_RATIO, NewtonOptions
from linkwork.core.numerics.system import QuickRows, SingleSystem, SolvedRows, System

Row = list[float]


def solve_linear(matrix: Sequence[Row], right: Row) -> Row | None:
    """x with A x = b for n rows b, from the first n columns of A; ``None`` if A is singular."""
    n = len(right)
    if n == 1:
        return [right[0] / matrix[0][0]] if matrix[0][0] else None
    if n == 2:  # most blocks are dyads
        a, b, *_ = matrix[0]
        c, d, *_ = matrix[1]
        r, s = right
        if abs(c) > abs(a):
            a, b, r, c, d, s = c, d, s, a, b, r
        if not a:
            return None
        share = c / a
        pivot = d - share * b
        if not pivot:
            return None
        y = (s - share * r) / pivot
        return [(r - b * y) / a, y]
    found = [[x] for x in right]
    sign = _eliminate([row[:n] for row in matrix], found)
    return [x for (x,) in found] if sign else None


def inverse_and_sign(matrix: Sequence[Row]) -> tuple[list[Row], int]:
    """The inverse of the first n columns of n rows and the sign of their determinant.

    NaN and 0 where it is singular.
    """
    n = len(matrix)
    if n == 1:
        x = matrix[0][0]
        return ([[1.0 / x]], _sign(x)) if x else ([[math.nan]], 0)
    if n == 2:
        a, b, *_ = matrix[0]
        c, d, *_ = matrix[1]
        exchanged = abs(c) > abs(a)
        if exchanged:
            a, b, c, d = c, d, a, b
        share = c / a if a else 0.0
        pivot = d - share * b
        if not (a and pivot):
            return [[math.nan] * 2, [math.nan] * 2], 0
        lower, last = -share / pivot, 1.0 / pivot
        rows = [[(1.0 - b * lower) / a, -b * last / a], [lower, last]]
        sign = _sign(a) * _sign(pivot)
        return ([row[::-1] for row in rows], -sign) if exchanged else (rows, sign)
    inverse = [[float(i == j) for j in range(n)] for i in range(n)]
    sign = _eliminate([row[:n] for row in matrix], inverse)
    return inverse, sign


def _eliminate(matrix: list[Row], right: list[Row]) -> int:
    """Solve A X = B, in place of B, with partial pivoting; the sign of det A.

    It is 0 where A is singular, B then NaN, or has NaN.
    """
    n, sign = len(matrix), 1
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i][k]) > abs(matrix[best][k]):
                best = i
        if best != k:
            sign = -sign
            matrix[k], matrix[best] = matrix[best], matrix[k]
            right[k], right[best] = right[best], right[k]
        above, known = matrix[k], right[k]
        pivot = above[k]
        if not pivot:
            right[:] = [[math.nan] * len(known) for _ in right]
            return 0
        sign *= _sign(pivot)
        for row, own in zip(matrix[k + 1 :], right[k + 1 :], strict=True):
            share = row[k] / pivot
            for j in range(k + 1, n):
                row[j] -= share * above[j]
            for j, x in enumerate(known):
                own[j] -= share * x
    for k in range(n - 1, -1, -1):
        row, own = matrix[k], right[k]
        for i in range(n - 1, k, -1):
            share = row[i]
            for j, x in enumerate(right[i]):
                own[j] -= share * x
        pivot = row[k]
        for j, x in enumerate(own):
            own[j] = x / pivot
    return sign


def _sign(x: float) -> int:
    """0 for what is not a number."""
    return (x > 0.0) - (x < 0.0)


# ----------------------------------------------------------------------
# A few rows solved one after the other in plain numbers: what arrays would take longer for.
#
# The methods are those of :mod:`newton` and :mod:`block_solver`, step by step. Where a process
# solves many such rows, compiled code takes the same steps.


LARGE = 1e3  # condition up to which balanced columns are not tried
_OFTEN = 4  # rows that take as long in plain numbers as to hand their blocks to compiled code


class SingleBlock:
    """A block with the scales and indices of its variables as lists."""

    def __init__(self, system: System, one: SingleSystem, variables: IndexArray) -> None:
        self.one, self.n = one, one.unknowns
        self.variables: list[int] = variables.tolist()
        self.unknowns = self.variables[: self.n]
        self.equation_scale: Row = system.equation_scale.tolist()
        self.weights: Row = system.variable_scale[: self.n].tolist()
        turns = system.is_angle[: self.n].tolist()
        self.angles = [k for k, angle in enumerate(turns) if angle]


@dataclass(slots=True)
class SingleSolution:
    """How Newton-Raphson ended for one row; columns of :class:`SolvedRows`."""

    status: int = CONVERGED
    failed_block: int = -1
    iterations: int = 0
    residual: float = 0.0
    first_step: float = 0.0
    contraction: float = 0.0


#: Makes compiled code of blocks, if it pays after so many more of their rows.
MakeQuick = Callable[[Sequence[SingleBlock], int], QuickRows | None]


class SingleRows:
    """Blocks of which rows are solved one by one.

    Parameters
    ----------
    blocks : sequence of SingleBlock
    make_quick : MakeQuick, optional
    """

    def __init__(self, blocks: Sequence[SingleBlock], make_quick: MakeQuick | None) -> None:
        self._blocks, self._make_quick = blocks, make_quick
        self._quick: QuickRows | None = None
        self._rows = 0

    def __reduce__(self) -> tuple[type[SingleRows], tuple[object, ...]]:
        """Copies by pickle ask for compiled code themselves."""
        return SingleRows, (self._blocks, self._make_quick)

    def _compiled(self) -> QuickRows | None:
        """Compiled code, if it serves."""
        if self._quick is None and self._make_quick is not None:
            self._rows += 1
            if self._rows >= _OFTEN:
                self._quick, self._rows = self._make_quick(self._blocks, self._rows), 0
        return self._quick

    def solve_row(self, v: Array, options: NewtonOptions) -> SingleSolution:
        """Newton-Raphson block by block from v (N,), in place; a row whose block fails keeps its
        guess in later ones.
        """
        quick = self._compiled()
        if quick is not None:
            return SingleSolution(*quick.solve(v, options.max_steps, (
                options.equation_tolerance, options.solution_tolerance, options.largest_turn,
                FAR, SMALLEST_RATIO,
            )))  # fmt: skip
        row, found = v.tolist(), SingleSolution()
        for number, block in enumerate(self._blocks):
            here = [row[k] for k in block.variables]
            _newton(block, here, options, found)
            for k, x in zip(block.unknowns, here, strict=False):
                row[k] = x
            if found.status != CONVERGED:
                found.failed_block = number
                break
        v[:] = row
        return found

    def take_rates(
        self, v: Array, first: Array, second: Array, signs: StatusArray
    ) -> tuple[float, float]:
        """``BlockSolver.rates`` at one position v (N,): condition and nearness.

        ``first``, ``second`` (N,): with u' and u'' of the inputs in place, filled with the rates of
        the unknowns; ``signs`` (blocks,): filled with those of the determinants.
        """
        quick = self._compiled()
        if quick is not None:
            return quick.take_rates(v, first, second, signs, LARGE)
        row, rates, bends = v.tolist(), first.tolist(), second.tolist()
        condition = nearness = 1.0
        for number, block in enumerate(self._blocks):
            here = [row[k] for k in block.variables]
            part = _block_rates(block, here, rates, bends)
            own = _condition(block, part)
            condition = max(condition, own)
            nearness = max(nearness, own if own <= LARGE else _nearness(block, part, own))
            signs[number] = part.sign
        first[:], second[:] = rates, bends
        return condition, nearness

    def solve(self, start: Array, options: NewtonOptions) -> SolvedRows:
        """``BlockSolver.solve`` for a few rows (B, N)."""
        v = start.copy()
        done = [self.solve_row(row, options) for row in v]
        return SolvedRows(
            v=v,
            status=np.array([x.status for x in done], dtype=np.int8),
            failed_block=np.array([x.failed_block for x in done]),
            iterations=np.array([x.iterations for x in done]),
            residual=np.array([x.residual for x in done]),
            first_step=np.array([x.first_step for x in done]),
            contraction=np.array([x.contraction for x in done]),
        )

    def rates(self, v: Array, input_rate: Array, input_bend: Array | float = 0.0) -> SolvedRows:
        """``BlockSolver.rates`` for a few rows (B, N)."""
        first, second = np.zeros(v.shape), np.zeros(v.shape)
        unknowns = v.shape[1] - input_rate.shape[-1]
        first[:, unknowns:], second[:, unknowns:] = input_rate, input_bend
        signs = np.zeros((len(v), len(self._blocks)), dtype=np.int8)
        rows = zip(v, first, second, signs, strict=True)
        found = np.array([self.take_rates(*row) for row in rows]).reshape(-1, 2)
        return SolvedRows(
            v=v,
            first=first,
            second=second,
            condition=found[:, 0],
            nearness=found[:, 1],
            orientation=signs,
        )


def _newton(block: SingleBlock, v: Row, opt: NewtonOptions, found: SingleSolution) -> None:
    """Solve one block from ``v`` (N,), in place; see :func:`newton`."""
    one, scales, weights = block.one, block.equation_scale, block.weights
    last, first, contraction = math.inf, 0.0, 0.0
    for k in range(opt.max_steps + 1):
        settled = last <= opt.solution_tolerance
        if settled:  # only the evidence is missing
            f, jacobian = one.residual(v), None
        else:
            f, jacobian = one.residual_and_jacobian(v)
        error = 0.0
        for x, s in zip(f, scales, strict=True):
            own = abs(x) / s
            if not own <= error:  # an error of NaN stays
                error = own
                if own != own:
                    break
        if not error < math.inf or (k and last > FAR):
            found.status = Status.DIVERGED.code
            break
        if settled or error <= opt.equation_tolerance:  # eq. (8)
            break
        if k == opt.max_steps:
            found.status = Status.STEP_LIMIT.code
            break
        assert jacobian is not None
        change = solve_linear(jacobian, f)
        if change is None or not math.isfinite(sum(change)):
            found.status = Status.SINGULAR_JACOBIAN.code
            break
        if block.angles:
            turn = max([abs(change[a]) for a in block.angles])
            if turn > opt.largest_turn:
                change = [x * (opt.largest_turn / turn) for x in change]  # eq. (7)
        size = 0.0
        for i, x in enumerate(change):
            v[i] -= x  # eq. (6)
            size = max(size, abs(x) / weights[i])
        if k:
            if size > SMALLEST_RATIO:
                contraction = max(contraction, size / last)
        else:
            first = size
        last = size
    found.iterations = max(found.iterations, k)
    found.residual = error if error != error else max(found.residual, error)
    found.first_step = max(found.first_step, first)
    found.contraction = max(found.contraction, contraction)


@dataclass(frozen=True, slots=True)
class SingleLinear:
    """A block at one position: dF/dv (n, N), the inverse of its first n columns, sign of det."""

    jacobian: list[Row]
    inverse: list[Row]
    sign: int


def linearise_singly(block: SingleBlock, v: Row) -> SingleLinear:
    """A block at a position of its own variables (N,)."""
    jacobian = block.one.residual_and_jacobian(v)[1]
    return SingleLinear(jacobian, *inverse_and_sign(jacobian))


def _block_rates(block: SingleBlock, v: Row, first: Row, second: Row) -> SingleLinear:
    """The rates of one block, into ``first`` and ``second`` (N of the whole,)."""
    n, part = block.n, linearise_singly(block, v)
    direction = [first[k] for k in block.variables]
    known = [second[k] for k in block.variables[n:]]
    driven, bent = [], []
    for row in part.jacobian:
        x = y = 0.0
        for slope, a, b in zip(row[n:], direction[n:], known, strict=True):
            x += slope * a
            y += slope * b
        driven.append(x)
        bent.append(y)
    for i, row in enumerate(part.inverse):
        direction[i] = -dot(row, driven)  # eq. (11)
    bend = block.one.second_directional_derivative(v, direction)
    bent = [x + y for x, y in zip(bend, bent, strict=True)]
    for k, x, row in zip(block.unknowns, direction, part.inverse, strict=False):
        first[k], second[k] = x, -dot(row, bent)  # eq. (12)
    return part


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    """Σ a b."""
    total = 0.0
    for x, y in zip(a, b, strict=False):
        total += x * y
    return total


def _total(terms: Sequence[float]) -> float:
    """The sum, each addition rounded as in compiled code; ``sum`` is exacter in some Pythons."""
    total = 0.0
    for x in terms:
        total += x
    return total


def _condition(block: SingleBlock, part: SingleLinear) -> float:
    """‖J‖·‖J⁻¹‖ in the system's own weights."""
    w, s = block.weights, block.equation_scale
    forward = max(
        [
            _total([abs(x) * own for x, own in zip(row, w, strict=False)]) / scale
            for row, scale in zip(part.jacobian, s, strict=True)
        ]
    )
    backward = max(
        [
            _total([abs(x) * scale for x, scale in zip(row, s, strict=True)]) / own
            for row, own in zip(part.inverse, w, strict=True)
        ]
    )
    product = forward * backward  # eq. (14)
    return product if product < math.inf else math.inf


def _nearness(block: SingleBlock, part: SingleLinear, condition: float) -> float:
    """How near to a singular position; see ``block_solver``."""
    s, columns = block.equation_scale, range(block.n)
    scaled = [
        [abs(x) / scale for x in row[: block.n]]
        for row, scale in zip(part.jacobian, s, strict=True)
    ]
    longest = [max([row[k] for row in scaled]) for k in columns]
    if not all(longest):
        return condition
    forward = max([_total([x / y for x, y in zip(row, longest, strict=True)]) for row in scaled])
    backward = max(
        [
            _total([abs(x) * scale for x, scale in zip(row, s, strict=True)]) * own
            for row, own in zip(part.inverse, longest, strict=True)
        ]
    )
    balanced = forward * backward
    least = min(condition, balanced) if balanced < math.inf else condition
    return math.sqrt(condition) * math.sqrt(least)  # eq. (15)
