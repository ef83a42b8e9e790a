"""Straight-line programs: lists of instructions over registers.

A register holds one number for every lane. Some registers are named and stay between runs
(variables, coefficients); constants have registers of their own; the rest are scratch. Programs are
recorded (:mod:`recorder`), given their registers (:mod:`lowering`) and run (:mod:`interpreter`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import TypeVar

import numpy as np

from linkwork.foundation.aligned import allocate_aligned
from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["ROLES", "SOURCES", "Code", "Op", "Program", "Registers", "registers_read"]

#: Roles that a node of a march takes in turn: the trial first, then the nodes behind it.
ROLES = 5
#: Instructions, (K, 5) uint32; see :class:`Program`.
Code = np.ndarray[tuple[int, int], np.dtype[np.uint32]]

_Key = TypeVar("_Key", str, float)


class Op(IntEnum):
    """Instructions over the registers a, b, c; masks are 1.0 and 0.0."""

    # The numbers stay: kernels that an earlier process has compiled know them.
    COPY = 0  # a
    ADD = 1  # a + b
    SUB = 2  # a - b
    MUL = 3  # a b
    DIV = 4  # a / b
    FMA = 5  # a b + c
    FMS = 6  # a b - c
    FNMA = 7  # c - a b
    NEG = 8  # -a
    ABS = 9  # |a|
    MAX = 10  # the larger one; not a number if one of them is not
    MIN = 11
    SQRT = 12
    SIN = 13  # of a; the same instruction computes
    COS = 14  # the cosine of a, into the register that follows as b
    WHERE = 15  # b where a is a true mask, else c
    LE = 16  # a <= b as a mask
    AND = 17  # of two masks
    KEEP = 18  # b where a is a true mask, else the target's present value
    LESS = 19  # the target's present value less a
    INPUT = 20  # a named register; no instruction
    CONSTANT = 21  # no instruction
    ATAN2 = 22  # the direction of (b, a); printed only, no kernel runs it


_ONE = (Op.COPY, Op.NEG, Op.ABS, Op.SQRT, Op.SIN, Op.LESS)
_THREE = (Op.FMA, Op.FMS, Op.FNMA, Op.WHERE)
#: How many of a, b, c an instruction reads.
SOURCES = {op: 1 if op in _ONE else 3 if op in _THREE else 2 for op in Op}


@dataclass
class Registers:
    """Where named values and constants live; shared by the programs of one mechanism.

    ``count``: how many there are so far, the scratch registers of every program follow.
    """

    named: dict[str, int] = field(default_factory=dict)
    constants: dict[float, int] = field(default_factory=dict)
    count: int = 0

    def of(self, name: str) -> int:
        """The register of a name, a new one if need be."""
        return self._in(self.named, name)

    def of_constant(self, value: float) -> int:
        """The register of a constant."""
        return self._in(self.constants, value)

    def _in(self, table: dict[_Key, int], key: _Key) -> int:
        found = table.get(key)
        if found is None:
            found = table[key] = self.count
            self.count += 1
        return found

    def all_of(self, names: Iterable[str]) -> IndexArray:
        """The registers of some names."""
        return np.array([self.of(name) for name in names], dtype=np.intp)

    def filled(self, height: int, lanes: int) -> Array:
        """A workspace (height, lanes) with the constants in their places."""
        space = allocate_aligned(height, lanes)
        space[:] = 0.0
        for value, register in self.constants.items():
            space[register] = value
        return space


@dataclass(frozen=True, kw_only=True, eq=False)
class Program:
    """Instructions over numbered registers.

    Parameters
    ----------
    code : (K, 5) uint32
        Operation, target, a, b, c; unused places repeat the target. A sine's c is the register
        its cosine goes to.
    height : int
        How many registers a workspace needs.
    """

    code: Code
    height: int


def registers_read(programs: Sequence[Program]) -> set[int]:
    """The registers that programs read before they write them."""
    read, written = set[int](), set[int]()
    for program in programs:
        for number, target, *sources in program.code.tolist():
            op = Op(number)
            count = SOURCES[op]
            read.update(set(sources[:count]) - written)
            if op in (Op.KEEP, Op.LESS):
                read.update({target} - written)
            written.update({target, sources[2]} if op is Op.SIN else {target})
    return read
