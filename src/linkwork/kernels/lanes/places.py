"""Programs run over the positions of many designs at once."""

from __future__ import annotations

import math
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from linkwork.foundation.arrays import Array, TurnArray
from linkwork.kernels.lanes.compiling import compiled
from linkwork.kernels.lanes.machine import LANES, run
from linkwork.kernels.lanes.rate_programs import PlaceProgram

__all__ = ["at_places"]

_PART = 1024  # designs that one thread works on at a time


def at_places(
    what: PlaceProgram,
    coefficients: Mapping[str, Array],
    v: Array,
    inputs: Array,
    turns: TurnArray,
    threads: int = 1,
) -> Array:
    """What a program computes at D designs' positions in R rows.

    Parameters
    ----------
    coefficients : Mapping[str, (D,)]
        By register; names that the program does not use are left out.
    v : (n, R, D)
        Unknowns; NaN gives NaN.
    inputs : (R, p)
    turns : (R, D)
        How many whole turns the first input of a position is further than the row says.

    Returns
    -------
    (len(what.wanted), R, D)
    """
    n, rows, count = v.shape
    named = what.registers.named
    used = [name for name in coefficients if name in named]
    design = np.array([coefficients[name] for name in used]).reshape(len(used), count)
    places = np.array([named[name] for name in used], dtype=np.intp)
    # a variable that the program does not use is loaded into a register of its own
    height = max(what.program.height, what.registers.count)
    spare = n + inputs.shape[1]
    variables = np.array([named.get(f"v{k}", height) for k in range(spare)], dtype=np.intp)
    wanted = np.array([named[name] for name in what.wanted], dtype=np.intp)
    found = np.empty((len(wanted), rows, count))

    def one(first: int) -> None:
        part = slice(first, first + _PART)
        space = what.registers.filled(height + 1, LANES)
        _evaluate(
            what.program.code, space, places, np.ascontiguousarray(design[:, part]),
            variables, v[:, :, part], inputs, turns[:, part], wanted, found[:, :, part],
        )  # fmt: skip

    firsts = range(0, count, _PART)
    with ThreadPoolExecutor(max(threads, 1)) as pool:
        list(pool.map(one, firsts))
    return found


@compiled
def _evaluate(  # type: ignore[no-untyped-def]
    code, w, places, design, variables, v, inputs, turns, wanted, found
):
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
