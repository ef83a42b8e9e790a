"""Blocks of equations packed into flat arrays, for compiled code that solves one row."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate, chain
from typing import Protocol

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray

#: Whole numbers and floats.
Packed = tuple[list[int], list[float]]


#: Variables with weights.
Parts = Sequence[tuple[int, float]]


HEAD = 9  # numbers of a block that say how long its lists are


class _Terms(Protocol):
    @property
    def packed(self) -> Packed | None:
        """The terms, see :func:`packed_terms`; ``None`` if there are others."""


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
    def one(self) -> _Terms:
        """Its equations."""


def pack(blocks: Sequence[PackedBlock]) -> tuple[IndexArray, Array] | None:
    """Whole numbers, their count of blocks first, and floats of all blocks; ``None`` if compiled
    code does not know the terms of one.

    :func:`linkwork.families.single.blocks.read` reads them in the same order.
    """
    whole: list[int] = [len(blocks)]
    floats: list[float] = []
    for block in blocks:
        terms, n = block.one.packed, len(block.weights)
        if terms is None:
            return None
        sizes, lists = terms[0][: HEAD - 2], terms[0][HEAD - 2 :]
        flags = [int(k in block.angles) for k in range(n)]
        whole += [n, len(block.variables), *sizes, *block.variables, *flags, *lists]
        floats += [*block.equation_scale, *block.weights, *terms[1]]
    return np.array(whole, dtype=np.int64), np.array(floats, dtype=float)


def packed_terms(
    loops: int,
    phases: Sequence[Parts],
    fixed: Sequence[tuple[int, int, complex]],
    sliding: Sequence[tuple[int, int, complex, int]],
    lines: Sequence[tuple[float, Parts]],
) -> Packed:
    """The terms of loops and lines: the lengths of their lists, and these.

    Parameters
    ----------
    loops
        L.
    phases
        The parts of every phase.
    fixed
        Loop, phase and coefficient.
    sliding
        The same and the variable length.
    lines
        The constant and the parts of linear rows.
    """
    parts, ties = list(chain(*phases)), list(chain(*(own for _, own in lines)))
    whole = [loops, len(phases), len(parts), len(fixed), len(sliding), len(lines), len(ties)]
    whole += [*_firsts(phases), *(k for k, _ in parts)]
    whole += [*(row for row, _, _ in fixed), *(g for _, g, _ in fixed)]
    whole += [*(term[0] for term in sliding), *(term[1] for term in sliding)]
    whole += [*(term[3] for term in sliding)]
    whole += [*_firsts([own for _, own in lines]), *(k for k, _ in ties)]
    floats = [w for _, w in parts]
    for terms in ([c for _, _, c in fixed], [term[2] for term in sliding]):
        sizes = [complex(c) for c in terms]  # some may be real
        floats += [*(c.real for c in sizes), *(c.imag for c in sizes)]
    floats += [*(constant for constant, _ in lines), *(w for _, w in ties)]
    return whole, floats


def _firsts(lists: Sequence[Sequence[object]]) -> list[int]:
    """Where each list begins if they follow each other, and the end of the last."""
    return [0, *accumulate(len(own) for own in lists)]
