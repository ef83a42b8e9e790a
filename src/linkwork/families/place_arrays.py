"""Programs run over the positions of many designs with arrays, where nothing is compiled."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, TurnArray
from linkwork.core.record.recorder import Code, Op
from linkwork.families.march.rate_programs import PlaceProgram

_PART = 1 << 14  # positions worked on together

_OPERATIONS: dict[Op, Callable[..., Any]] = {
    Op.COPY: lambda a, b, c, d: a,
    Op.ADD: lambda a, b, c, d: a + b,
    Op.SUB: lambda a, b, c, d: a - b,
    Op.MUL: lambda a, b, c, d: a * b,
    Op.DIV: lambda a, b, c, d: a / b,
    Op.FMA: lambda a, b, c, d: a * b + c,
    Op.FMS: lambda a, b, c, d: a * b - c,
    Op.FNMA: lambda a, b, c, d: c - a * b,
    Op.NEG: lambda a, b, c, d: -a,
    Op.ABS: lambda a, b, c, d: np.abs(a),
    Op.MAX: lambda a, b, c, d: np.maximum(a, b),
    Op.MIN: lambda a, b, c, d: np.minimum(a, b),
    Op.SQRT: lambda a, b, c, d: np.sqrt(a),
    Op.WHERE: lambda a, b, c, d: np.where(a > 0.5, b, c),
    Op.LE: lambda a, b, c, d: np.where(a <= b, 1.0, 0.0),
    Op.AND: lambda a, b, c, d: a * b,
    Op.KEEP: lambda a, b, c, d: np.where(a > 0.5, b, d),
    Op.LESS: lambda a, b, c, d: d - a,
}


def run(code: Code, registers: list[Any]) -> None:
    """Run a program in place; registers are numbers or arrays (B,)."""
    with np.errstate(all="ignore"):
        for number, d, a, b, c in code.tolist():
            if number == Op.SIN:
                angle = registers[a]
                registers[d], registers[c] = np.sin(angle), np.cos(angle)
            else:
                of = _OPERATIONS[Op(number)]
                registers[d] = of(registers[a], registers[b], registers[c], registers[d])


def at_places(
    reading: PlaceProgram,
    coefficients: Mapping[str, Array],
    v: Array,
    inputs: Array,
    turns: TurnArray,
    threads: int = 1,
) -> Array:
    """As :func:`linkwork.families.march.places.at_places`."""
    n, rows, count = v.shape
    named = reading.registers.named
    height = max(reading.program.height, reading.registers.count)
    found = np.empty((len(reading.wanted), rows, count))
    step = max(1, _PART // max(rows, 1))
    for begin in range(0, count, step):
        part = slice(begin, begin + step)
        registers: list[Any] = [0.0] * height
        for value, register in reading.registers.constants.items():
            registers[register] = value
        for name, values in coefficients.items():
            if name in named:
                registers[named[name]] = values[part]
        for k in range(n):
            if f"v{k}" in named:
                registers[named[f"v{k}"]] = v[k, :, part]
        for j, column in enumerate(inputs.T):
            if f"v{n + j}" in named:
                moved = turns[:, part] * (2.0 * math.pi if j == 0 else 0.0)
                registers[named[f"v{n + j}"]] = column[:, None] + moved
        run(reading.program.code, registers)
        for k, name in enumerate(reading.wanted):
            found[k, :, part] = registers[named[name]]
    return found
