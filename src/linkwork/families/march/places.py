"""Programs run over the positions of many designs, in compiled code."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray, TurnArray
from linkwork.core.foundation.loading import share_out
from linkwork.core.record.recorder import LANES, Code
from linkwork.families.compiled.compiling import compiled
from linkwork.families.compiled.interpreter import run
from linkwork.families.march.rate_programs import PlaceProgram

_PART = 1024  # designs that one thread works on at a time


def at_places(
    reading: PlaceProgram,
    coefficients: Mapping[str, Array],
    v: Array,
    inputs: Array,
    turns: TurnArray,
    threads: int = 1,
) -> Array:
    """Run a program at the positions of D designs in R rows.

    Parameters
    ----------
    coefficients : Mapping[str, (D,)]
        By register; names that the program does not use are left out.
    v : (n, R, D)
        Unknowns; NaN gives NaN.
    inputs : (R, p)
    turns : (R, D)
        Whole turns by which the first input of a position exceeds the row's.

    Returns
    -------
    (len(reading.wanted), R, D)
    """
    n, rows, count = v.shape
    named = reading.registers.named
    used = [name for name in coefficients if name in named]
    design = np.array([coefficients[name] for name in used]).reshape(len(used), count)
    # a variable that the program does not use is loaded into a register of its own
    spare = max(reading.program.height, reading.registers.count)
    places = np.array([named[name] for name in used], dtype=np.intp)
    variables = [named.get(f"v{k}", spare) for k in range(n + inputs.shape[1])]
    found = np.empty((len(reading.wanted), rows, count))

    def one(first: int) -> None:
        part = slice(first, first + _PART)
        _evaluate(
            reading.program.code, reading.registers.filled(spare + 1, LANES), places,
            np.array(variables, dtype=np.intp), np.ascontiguousarray(design[:, part]),
            v[:, :, part], inputs, turns[:, part], reading.registers.all_of(reading.wanted),
            found[:, :, part],
        )  # fmt: skip

    firsts = range(0, count, _PART)
    share_out(one, firsts, min(threads, len(firsts)))
    return found


@compiled
def _evaluate(
    code: Code,
    w: Array,
    places: IndexArray,
    variables: IndexArray,
    design: Array,
    v: Array,
    inputs: Array,
    turns: TurnArray,
    wanted: IndexArray,
    found: Array,
) -> None:
    """LANES designs at a time, row by row."""
    unknowns, rows, count = v.shape
    for base in range(0, count, LANES):
        lanes = min(LANES, count - base)
        for lane in range(LANES):
            member = base + min(lane, lanes - 1)
            for j in range(len(places)):
                w[places[j], lane] = design[j, member]
        for row in range(rows):
            for k in range(unknowns):
                for lane in range(lanes):
                    w[variables[k], lane] = v[k, row, base + lane]
            for j in range(inputs.shape[1]):
                for lane in range(lanes):
                    w[variables[unknowns + j], lane] = inputs[row, j]
            if inputs.shape[1]:
                for lane in range(lanes):
                    turn = turns[row, base + lane]
                    if turn:
                        w[variables[unknowns], lane] += turn * 2.0 * math.pi
            run(code, w)
            for j in range(len(wanted)):
                for lane in range(lanes):
                    found[j, row, base + lane] = w[wanted[j], lane]
