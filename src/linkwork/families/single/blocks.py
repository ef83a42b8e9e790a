"""Blocks of equations as two arrays, which compiled code reads one block after the other."""

from __future__ import annotations

import math
from typing import NamedTuple

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.table.packed_blocks import HEAD
from linkwork.families.compiled.compiling import unfused

# ----------------------------------------------------------------------
# Linear equations with few unknowns, and conditions of their matrices, in compiled code.
#
# As in :mod:`linkwork.numerics.elimination` and :mod:`linkwork.numerics.single_rows`.


@unfused
def eliminate(matrix: Array, right: Array) -> int:
    """Solve A X = B (n, m), in place of B, by elimination in A (n, n) with partial pivoting.

    Returns
    -------
    int
        The sign of det A: 0 where A is singular, B then NaN, or has NaN.
    """
    n, sign = len(matrix), 1
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            sign = -sign
            for j in range(n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
            for j in range(right.shape[1]):
                right[k, j], right[best, j] = right[best, j], right[k, j]
        pivot = matrix[k, k]
        if pivot == 0.0:
            right[:] = math.nan
            return 0
        sign *= (pivot > 0.0) - (pivot < 0.0)
        for i in range(k + 1, n):
            share = matrix[i, k] / pivot
            for j in range(k + 1, n):
                matrix[i, j] -= share * matrix[k, j]
            for j in range(right.shape[1]):
                right[i, j] -= share * right[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(right.shape[1]):
            for i in range(n - 1, k, -1):
                right[k, j] -= matrix[k, i] * right[i, j]
            right[k, j] /= matrix[k, k]
    return sign


@unfused
def condition_of(jacobian: Array, inverse: Array, scale: Array, weights: Array) -> float:
    """‖J‖·‖J⁻¹‖ in the system's own weights."""
    forward, backward = -math.inf, -math.inf
    for i in range(len(inverse)):
        ahead, back = 0.0, 0.0
        for j in range(len(inverse)):
            ahead += abs(jacobian[i, j]) * weights[j]
            back += abs(inverse[i, j]) * scale[j]
        ahead, back = ahead / scale[i], back / weights[i]
        # what is not a number stays if it is the first
        forward = ahead if i == 0 or ahead > forward else forward
        backward = back if i == 0 or back > backward else backward
    product = forward * backward  # eq. (14)
    return product if product < math.inf else math.inf


@unfused
def nearness_of(jacobian: Array, inverse: Array, scale: Array, condition: float) -> float:
    """How near to a singular position; see :mod:`linkwork.core.numerics.block_solver`."""
    n = len(inverse)
    forward, backward = -math.inf, -math.inf
    for i in range(n):
        ahead, back, longest = 0.0, 0.0, 0.0
        for j in range(n):
            own = _longest(jacobian, scale, j)
            if own == 0.0:
                return condition
            ahead += abs(jacobian[i, j]) / scale[i] / own
            back += abs(inverse[i, j]) * scale[j]
            longest = own if j == i else longest
        back *= longest
        forward = ahead if i == 0 or ahead > forward else forward
        backward = back if i == 0 or back > backward else backward
    balanced = forward * backward
    least = condition
    if balanced < math.inf:
        least = balanced if balanced < condition else condition
    return math.sqrt(condition) * math.sqrt(least)  # eq. (15)


@unfused
def _longest(jacobian: Array, scale: Array, j: int) -> float:
    """The largest scaled entry of a column."""
    longest = float(abs(jacobian[0, j]) / scale[0])
    for i in range(1, len(scale)):
        own = float(abs(jacobian[i, j]) / scale[i])
        longest = own if own > longest else longest
    return longest


# ----------------------------------------------------------------------
# Reading packed blocks in compiled code, and a block's equations at one position.
#
# The formulas, their order and so every rounding are those of
# :mod:`linkwork.kernels.single.single_position`.


class PackedEquations(NamedTuple):
    """A block; see :class:`linkwork.families.single.blocks.PackedBlock`."""

    loops: int
    variables: IndexArray
    angles: IndexArray
    scale: Array
    weights: Array
    first_part: IndexArray
    turned: IndexArray
    turning: Array
    fixed: tuple[IndexArray, IndexArray]
    fixed_size: tuple[Array, Array]
    sliding: tuple[IndexArray, IndexArray, IndexArray]
    sliding_size: tuple[Array, Array]
    first_tie: IndexArray
    tied: IndexArray
    constants: Array
    ties: Array


# long: every list begins where the one before it ends
@unfused
def read(code: IndexArray, numbers: Array, k: int, x: int) -> tuple[PackedEquations, int, int]:
    """The block that begins at two places, and where the next one does."""
    n, variables, loops, phases, parts = code[k], code[k + 1], code[k + 2], code[k + 3], code[k + 4]
    fixed, sliding, lines, ties = code[k + 5], code[k + 6], code[k + 7], code[k + 8]
    a = k + HEAD
    b = a + variables
    c = b + n
    d = c + phases + 1
    e = d + parts
    f = e + 2 * fixed
    g = f + 3 * sliding
    h = g + lines + 1
    p = x + 2 * n
    q = p + parts
    r = q + 2 * fixed
    s = r + 2 * sliding
    t = s + lines
    block = PackedEquations(
        loops,
        code[a:b],
        code[b:c],
        numbers[x : x + n],
        numbers[x + n : p],
        code[c:d],
        code[d:e],
        numbers[p:q],
        (code[e : e + fixed], code[e + fixed : f]),
        (numbers[q : q + fixed], numbers[q + fixed : r]),
        (code[f : f + sliding], code[f + sliding : g - sliding], code[g - sliding : g]),
        (numbers[r : r + sliding], numbers[r + sliding : s]),
        code[g:h],
        code[h : h + ties],
        numbers[s:t],
        numbers[t : t + ties],
    )
    return block, h + ties, t + ties


@unfused
def turn_phases(own: PackedEquations, v: Array, e: Array) -> None:
    """The phasors e^{iψ} (G, 2) of all phases."""
    for g in range(len(own.first_part) - 1):
        psi = _along(own, v, g)
        e[g, 0], e[g, 1] = math.cos(psi), math.sin(psi)  # eq. (1)


@unfused
def _along(own: PackedEquations, d: Array, g: int) -> float:
    """How far a phase turns along d (N,)."""
    turn = 0.0
    for j in range(own.first_part[g], own.first_part[g + 1]):
        turn += own.turning[j] * d[own.turned[j]]
    return turn


@unfused
def evaluate(own: PackedEquations, v: Array, e: Array, f: Array, jacobian: Array) -> None:
    """F (n,) and dF/dv (n, N) from the phasors."""
    f[:] = 0.0
    jacobian[:] = 0.0
    for t in range(len(own.fixed[0])):
        row, g = own.fixed[0][t], own.fixed[1][t]
        a, b = own.fixed_size[0][t], own.fixed_size[1][t]
        _add_term(own, row, g, a * e[g, 0] - b * e[g, 1], a * e[g, 1] + b * e[g, 0], f, jacobian)
    for t in range(len(own.sliding[0])):
        row, g, length = own.sliding[0][t], own.sliding[1][t], own.sliding[2][t]
        a, b = own.sliding_size[0][t], own.sliding_size[1][t]
        x, y = a * e[g, 0] - b * e[g, 1], a * e[g, 1] + b * e[g, 0]
        jacobian[row, length] += x  # eq. (2): sliding
        jacobian[own.loops + row, length] += y
        _add_term(own, row, g, x * v[length], y * v[length], f, jacobian)
    for line in range(len(own.constants)):
        row, total = 2 * own.loops + line, own.constants[line]
        for j in range(own.first_tie[line], own.first_tie[line + 1]):
            total += own.ties[j] * v[own.tied[j]]
            jacobian[row, own.tied[j]] = own.ties[j]
        f[row] = total


@unfused
def _add_term(
    own: PackedEquations, row: int, g: int, x: float, y: float, f: Array, jacobian: Array
) -> None:
    """A vector x + iy with a phase."""
    below = own.loops + row
    f[row] += x
    f[below] += y
    for j in range(own.first_part[g], own.first_part[g + 1]):  # eq. (2): turning
        k, w = own.turned[j], own.turning[j]
        jacobian[row, k] -= w * y
        jacobian[below, k] += w * x


@unfused
def bend(own: PackedEquations, v: Array, d: Array, e: Array, found: Array) -> None:
    """D²F[d, d] (n,) from the phasors."""
    found[:] = 0.0
    for t in range(len(own.fixed[0])):
        row, g = own.fixed[0][t], own.fixed[1][t]
        a, b = own.fixed_size[0][t], own.fixed_size[1][t]
        turn = _along(own, d, g)
        square = turn * turn
        found[row] -= (a * e[g, 0] - b * e[g, 1]) * square  # eq. (3) with a = b
        found[own.loops + row] -= (a * e[g, 1] + b * e[g, 0]) * square
    for t in range(len(own.sliding[0])):
        row, g, length = own.sliding[0][t], own.sliding[1][t], own.sliding[2][t]
        a, b = own.sliding_size[0][t], own.sliding_size[1][t]
        x, y = a * e[g, 0] - b * e[g, 1], a * e[g, 1] + b * e[g, 0]
        turn = _along(own, d, g)
        inward, beside = -v[length] * turn * turn, 2.0 * d[length] * turn
        found[row] += x * inward - y * beside
        found[own.loops + row] += x * beside + y * inward
