"""Sine and cosine of one number, free of branches: lanes of them become vector instructions."""

from __future__ import annotations

import math

from linkwork.core.foundation.arrays import Array
from linkwork.core.record.recorder import LANES, Code, Op
from linkwork.families.compiled.compiling import (
    called_by_name,
    carray,
    inlined,
    njit_no_refcount,
    types,
)

_TWO_OVER_PI = 2.0 / math.pi
_WHOLE = 1.5 * 2.0**52  # added and taken away again, it leaves the nearest whole number
# π/2 in three parts, of 33 bits each the first two: n times them is exact for |n| ≤ 2^20
_MOST_QUARTERS = 2.0**20
_PART_1 = float.fromhex("0x1.921fb54400000p+0")
_PART_2 = float.fromhex("0x1.0b4611a600000p-34")
_PART_3 = float.fromhex("0x1.3198a2e037073p-69")


@njit_no_refcount
def sin_cos(x: float) -> tuple[float, float]:
    """Reduced to within π/4 of a multiple of π/2, then Taylor's series.

    For |x| below a million the error is below 2.5 · 2⁻⁵³, and three units in the last place; far
    beyond, where the reduction would lose digits, the result is NaN.
    """
    n = (x * _TWO_OVER_PI + _WHOLE) - _WHOLE
    r = ((x - n * _PART_1) - n * _PART_2) - n * _PART_3
    r = r if abs(n) <= _MOST_QUARTERS else math.nan
    z = r * r
    s = -7.647163731819816e-13 + z * 2.8114572543455206e-15
    s = 1.6059043836821613e-10 + z * s
    s = -2.505210838544172e-08 + z * s
    s = 2.7557319223985893e-06 + z * s
    s = -0.0001984126984126984 + z * s
    s = 0.008333333333333333 + z * s
    s = -0.16666666666666666 + z * s
    s = r + r * z * s
    p = 4.779477332387385e-14 + z * -1.5619206968586225e-16
    p = -1.1470745597729725e-11 + z * p
    p = 2.08767569878681e-09 + z * p
    p = -2.755731922398589e-07 + z * p
    p = 2.48015873015873e-05 + z * p
    p = -0.001388888888888889 + z * p
    p = 0.041666666666666664 + z * p
    p = 1.0 - 0.5 * z + z * z * p
    q = n - 4.0 * ((0.25 * n - 0.375 + _WHOLE) - _WHOLE)  # 0, 1, 2 or 3
    odd = (q == 1.0) | (q == 3.0)
    u = p if odd else s
    v = s if odd else p
    sine = -u if q >= 2.0 else u
    cosine = -v if (q == 1.0) | (q == 2.0) else v
    return sine, cosine


# ----------------------------------------------------------------------
# The interpreter, which runs programs over lanes: one instruction at a time, all lanes at once.
#
# Registers are rows of a workspace (R, LANES). A pass over one row is a loop of known length over
# contiguous numbers, which the compiler turns into vector instructions; choosing the operation
# costs little in comparison. So no mechanism needs a compilation of its own.


FIELDS = 5  # of an instruction
HIGH = 1 << 24  # registers: more than any workspace has, for its height is not known here


# long: one branch for each instruction; a call for each would cost as much as the instruction.
@inlined
def _interpret(code: Code, first: int, end: int, w: Array, lanes: int) -> None:
    """Run some instructions of a program in the first lanes."""
    for k in range(first, end):
        op = code[k, 0]
        d, a, b, c = code[k, 1], code[k, 2], code[k, 3], code[k, 4]
        if op == Op.FMA:
            for i in range(lanes):
                w[d, i] = w[a, i] * w[b, i] + w[c, i]
        elif op == Op.MUL:
            for i in range(lanes):
                w[d, i] = w[a, i] * w[b, i]
        elif op == Op.ADD:
            for i in range(lanes):
                w[d, i] = w[a, i] + w[b, i]
        elif op == Op.SUB:
            for i in range(lanes):
                w[d, i] = w[a, i] - w[b, i]
        elif op == Op.FNMA:
            for i in range(lanes):
                w[d, i] = w[c, i] - w[a, i] * w[b, i]
        elif op == Op.FMS:
            for i in range(lanes):
                w[d, i] = w[a, i] * w[b, i] - w[c, i]
        elif op == Op.WHERE:
            for i in range(lanes):
                yes, no = w[b, i], w[c, i]
                w[d, i] = yes if w[a, i] > 0.5 else no
        elif op == Op.KEEP:
            for i in range(lanes):
                yes = w[b, i]
                w[d, i] = yes if w[a, i] > 0.5 else w[d, i]
        elif op == Op.LESS:
            for i in range(lanes):
                w[d, i] -= w[a, i]
        elif op == Op.SIN:
            for i in range(lanes):
                w[d, i], w[c, i] = sin_cos(w[a, i])
        elif op == Op.COPY:
            for i in range(lanes):
                w[d, i] = w[a, i]
        elif op == Op.NEG:
            for i in range(lanes):
                w[d, i] = -w[a, i]
        elif op == Op.ABS:
            for i in range(lanes):
                w[d, i] = abs(w[a, i])
        elif op == Op.MAX:
            for i in range(lanes):
                x, y = w[a, i], w[b, i]
                w[d, i] = x if (x > y) | (x != x) else y
        elif op == Op.MIN:
            for i in range(lanes):
                x, y = w[a, i], w[b, i]
                w[d, i] = x if (x < y) | (x != x) else y
        elif op == Op.LE:
            for i in range(lanes):
                w[d, i] = 1.0 if w[a, i] <= w[b, i] else 0.0
        elif op == Op.AND:
            for i in range(lanes):
                w[d, i] = w[a, i] * w[b, i]
        elif op == Op.DIV:
            for i in range(lanes):
                w[d, i] = w[a, i] / w[b, i]
        elif op == Op.SQRT:
            for i in range(lanes):
                w[d, i] = math.sqrt(w[a, i])


@called_by_name(
    "linkwork_interpreter",
    types.CPointer(types.uint32), types.int64, types.int64, types.CPointer(types.float64),
    types.int64,
)  # fmt: skip
def _interpret_at(instructions: Array, first: int, end: int, workspace: Array, lanes: int) -> int:
    """The same at addresses; all lanes are a loop of known length."""
    code, w = carray(instructions, (end, FIELDS)), carray(workspace, (HIGH, LANES))
    if lanes == LANES:
        _interpret(code, first, end, w, LANES)
    else:
        _interpret(code, first, end, w, lanes)
    return 0


@inlined
def run_part(code: Code, first: int, end: int, w: Array, lanes: int) -> None:
    """Run some instructions of a program in the first lanes."""
    _interpret_at((code.ctypes.data, first, end, w.ctypes.data, lanes))


@inlined
def run(code: Code, w: Array) -> None:
    """Run a program (K, 5) over a workspace (R, LANES)."""
    run_part(code, 0, code.shape[0], w, LANES)


# ----------------------------------------------------------------------
# The device that a march runs on, and whether its equations are compiled for it.
