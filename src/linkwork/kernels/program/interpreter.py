"""The interpreter, which runs programs over lanes: one instruction at a time, all lanes at once.

Registers are rows of a workspace (R, LANES). A pass over one row is a loop of known length over
contiguous numbers, which the compiler turns into vector instructions; choosing the operation costs
little in comparison. So no mechanism needs a compilation of its own.
"""

from __future__ import annotations

import math

from linkwork.foundation.arrays import Array
from linkwork.kernels.program.compiling import (
    called_by_name,
    carray,
    inlined,
    types,
)
from linkwork.kernels.program.program import Code, Op
from linkwork.kernels.program.sine import sin_cos

__all__ = ["FIELDS", "HIGH", "LANES", "run", "run_part"]

LANES = 64

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
