"""Blocks of equations as two arrays, which compiled code reads one block after the other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, chain
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["HEAD", "PackedBlock", "pack"]

HEAD = 9  # numbers of a block that say how long its lists are


class Terms(Protocol):
    """The terms of a block's loops and lines."""

    @property
    def loops(self) -> int:
        """L."""

    @property
    def phases(self) -> Sequence[Sequence[tuple[int, float]]]:
        """Variable and weight of the parts of every phase."""

    @property
    def fixed(self) -> Sequence[tuple[int, int, complex]]:
        """Loop, phase and coefficient of terms."""

    @property
    def sliding(self) -> Sequence[tuple[int, int, complex, int]]:
        """The same and the variable length of terms that have one."""

    @property
    def lines(self) -> Sequence[tuple[float, Sequence[tuple[int, float]]]]:
        """The constant, and variables with weights, of linear rows."""

    @property
    def has_laws(self) -> bool:
        """Whether other rows follow, which compiled code does not know."""


class PackedBlock(Protocol):
    """A block with n unknowns.

    ``variables`` (N,): which ones of the whole, the unknowns first; ``equation_scale``, ``weights``
    (n,); ``angles``: numbers of the unknowns that are angles.
    """

    variables: list[int]
    equation_scale: list[float]
    weights: list[float]
    angles: list[int]

    @property
    def one(self) -> Terms:
        """Its terms."""


def pack(blocks: Sequence[PackedBlock]) -> tuple[IndexArray, Array]:
    """Whole numbers, their count of blocks first, and floats of all blocks.

    :func:`linkwork.kernels.single.block_reader.read` reads them in the same order.
    """
    whole: list[int] = [len(blocks)]
    floats: list[float] = []
    for block in blocks:
        own = block.one
        parts, ties = list(chain(*own.phases)), list(chain(*(line for _, line in own.lines)))
        n = len(block.weights)
        whole += [n, len(block.variables), own.loops, len(own.phases), len(parts)]
        whole += [len(own.fixed), len(own.sliding), len(own.lines), len(ties)]
        whole += [*block.variables, *(k in block.angles for k in range(n))]
        whole += [*_firsts(own.phases), *(k for k, _ in parts)]
        whole += [*(row for row, _, _ in own.fixed), *(g for _, g, _ in own.fixed)]
        whole += [*(t[0] for t in own.sliding), *(t[1] for t in own.sliding)]
        whole += [t[3] for t in own.sliding]
        whole += [*_firsts([line for _, line in own.lines]), *(k for k, _ in ties)]
        floats += [*block.equation_scale, *block.weights, *(w for _, w in parts)]
        for terms in (own.fixed, own.sliding):
            coefficients = [complex(term[2]) for term in terms]
            floats += [c.real for c in coefficients]
            floats += [c.imag for c in coefficients]
        floats += [*(constant for constant, _ in own.lines), *(w for _, w in ties)]
    return np.array(whole, dtype=np.int64), np.array(floats, dtype=float)


def _firsts(lists: Sequence[Sequence[object]]) -> list[int]:
    """Where each list begins if they follow each other, and the end of the last."""
    return [0, *accumulate(len(own) for own in lists)]
