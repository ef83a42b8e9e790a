"""Newton-Raphson and rates of one row, block by block, in compiled code for any blocks.

The methods are those of :mod:`linkwork.core.numerics.single_rows`, and so are the order of
operations and every rounding: results do not depend on which of both a process uses.
"""

from __future__ import annotations

import math

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray, StatusArray
from linkwork.core.foundation.statuses import CONVERGED, Status
from linkwork.families.compiled.code_cache import SINGLE_LOOP, say_that_it_compiles
from linkwork.families.compiled.compiling import called_unfused, types, unfused
from linkwork.families.single.blocks import (
    bend,
    condition_of,
    eliminate,
    evaluate,
    nearness_of,
    read,
    turn_phases,
)

__all__ = ["solve_row", "take_rates"]

say_that_it_compiles(SINGLE_LOOP)

_DIVERGED, _STEP_LIMIT = Status.DIVERGED.code, Status.STEP_LIMIT.code
_SINGULAR = Status.SINGULAR_JACOBIAN.code
_WHOLE, _ROW, _NUMBER = types.int64[::1], types.float64[::1], types.float64


@unfused
def _shorten(angles: IndexArray, change: Array, largest_turn: float) -> None:
    """Shorten a step that turns an angle too far, as a whole."""
    turn = 0.0
    for i in range(len(angles)):
        if angles[i]:
            turn = max(turn, abs(change[i, 0]))
    if turn > largest_turn:
        for i in range(len(change)):
            change[i, 0] *= largest_turn / turn  # eq. (7)


@unfused
def _dot(a: Array, b: Array) -> float:
    total = 0.0
    for i in range(len(b)):
        total += a[i] * b[i]
    return total


# long: Newton-Raphson, whose numbers all of its lines share
@called_unfused(
    types.Tuple([types.int64] * 3 + [_NUMBER] * 3)(_WHOLE, _ROW, _ROW, types.int64, *[_NUMBER] * 5)
)
def solve_row(
    code: IndexArray,
    numbers: Array,
    v: Array,
    max_steps: int,
    equation_tolerance: float,
    solution_tolerance: float,
    largest_turn: float,
    far: float,
    smallest_ratio: float,
) -> tuple[int, int, int, float, float, float]:
    """Solve all blocks from ``v`` (N,), in place.

    Returns
    -------
    status, failed_block, iterations, residual, first_step, contraction
        See :class:`linkwork.core.numerics.single_rows.SingleSolution`.
    """
    status, iterations, residual, first_step, contraction = CONVERGED, 0, 0.0, 0.0, 0.0
    place, x = 1, 0
    for number in range(code[0]):
        own, place, x = read(code, numbers, place, x)
        n = len(own.weights)
        here, e = np.empty(len(own.variables)), np.empty((len(own.first_part) - 1, 2))
        f, change = np.empty(n), np.empty((n, 1))
        jacobian, matrix = np.empty((n, len(here))), np.empty((n, n))
        for i in range(len(here)):
            here[i] = v[own.variables[i]]
        last, error, k = math.inf, 0.0, 0
        for k in range(max_steps + 1):
            turn_phases(own, here, e)
            evaluate(own, here, e, f, jacobian)
            error = 0.0
            for i in range(n):
                size = abs(f[i]) / own.scale[i]
                if not size <= error:  # an error of NaN stays
                    error = size
                    if size != size:
                        break
            if not error < math.inf or (k > 0 and last > far):
                status = _DIVERGED
                break
            if last <= solution_tolerance or error <= equation_tolerance:  # eq. (8)
                break
            if k == max_steps:
                status = _STEP_LIMIT
                break
            matrix[:], change[:, 0] = jacobian[:, :n], f
            eliminate(matrix, change)
            if not math.isfinite(change.sum()):
                status = _SINGULAR
                break
            _shorten(own.angles, change, largest_turn)
            size = 0.0
            for i in range(n):
                here[i] -= change[i, 0]  # eq. (6)
                size = max(size, abs(change[i, 0]) / own.weights[i])
            if k == 0:
                first_step = max(first_step, size)
            elif size > smallest_ratio:
                contraction = max(contraction, size / last)
            last = size
        iterations = max(iterations, k)
        residual = error if error != error else max(residual, error)
        for i in range(n):
            v[own.variables[i]] = here[i]
        if status != CONVERGED:
            return status, number, iterations, residual, first_step, contraction
    return status, -1, iterations, residual, first_step, contraction


@called_unfused(
    types.UniTuple(_NUMBER, 2)(_WHOLE, _ROW, _ROW, _ROW, _ROW, types.int8[::1], _NUMBER)
)
def take_rates(
    code: IndexArray,
    numbers: Array,
    v: Array,
    first: Array,
    second: Array,
    orientation: StatusArray,
    large: float,
) -> tuple[float, float]:
    """Derivatives of all variables at one position (N,).

    Parameters
    ----------
    first, second : (N,)
        With those of the inputs in place; filled with those of the unknowns.
    orientation : (blocks,)
        Filled with the signs of the determinants.

    Returns
    -------
    condition, nearness
    """
    condition, nearness = 1.0, 1.0
    place, x = 1, 0
    for number in range(code[0]):
        own, place, x = read(code, numbers, place, x)
        n, total = len(own.weights), len(own.variables)
        here, direction = np.empty(total), np.empty(total)
        e = np.empty((len(own.first_part) - 1, 2))
        f, driven, bent = np.empty(n), np.zeros(n), np.zeros(n)
        jacobian, matrix, inverse = np.empty((n, total)), np.empty((n, n)), np.empty((n, n))
        for i in range(total):
            here[i], direction[i] = v[own.variables[i]], first[own.variables[i]]
        turn_phases(own, here, e)
        evaluate(own, here, e, f, jacobian)
        matrix[:], inverse[:] = jacobian[:, :n], 0.0
        for i in range(n):
            inverse[i, i] = 1.0
        orientation[number] = eliminate(matrix, inverse)
        for i in range(n):
            for j in range(n, total):
                driven[i] += jacobian[i, j] * direction[j]
                bent[i] += jacobian[i, j] * second[own.variables[j]]
        for i in range(n):
            direction[i] = -_dot(inverse[i], driven)  # eq. (11)
        bend(own, here, direction, e, f)
        for i in range(n):
            f[i] += bent[i]
        for i in range(n):
            first[own.variables[i]] = direction[i]
            second[own.variables[i]] = -_dot(inverse[i], f)  # eq. (12)
        known = condition_of(jacobian, inverse, own.scale, own.weights)
        condition = max(condition, known)
        near = known if known <= large else nearness_of(jacobian, inverse, own.scale, known)
        nearness = max(nearness, near)
    return condition, nearness
