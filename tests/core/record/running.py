"""Recorded programs run on the machine, any number of lanes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from linkwork.core.record.recorder import (
    LANES,
    Program,
    Recorder,
    Registers,
    lower_program,
    reserve,
)
from linkwork.families.compiled.interpreter import run

__all__ = ["ran", "with_registers"]

Array = npt.NDArray[np.float64]


def with_registers(recorder: Recorder) -> tuple[Program, Registers]:
    """The program of a recording alone, with its registers."""
    registers = Registers()
    reserve(recorder, registers)
    return lower_program(recorder, registers, registers.count), registers


def ran(recorder: Recorder, given: Mapping[str, Array]) -> dict[str, Array]:
    """All named registers after the program has run, (M,) each, for what they held before."""
    program, registers = with_registers(recorder)
    count = max((len(values) for values in given.values()), default=1)
    found = {name: np.empty(count) for name in registers.named}
    for first in range(0, count, LANES):
        space = registers.filled(max(program.height, registers.count), LANES)
        space[registers.count :] = np.nan  # scratch holds anything
        here = slice(first, min(first + LANES, count))
        for name, values in given.items():
            if name in registers.named:
                space[registers.named[name], : here.stop - first] = values[here]
        run(program.code, space)
        for name, register in registers.named.items():
            found[name][here] = space[register, : here.stop - first]
    return found
