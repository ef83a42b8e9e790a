"""The tasks of a march, and the arrays of its results."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.kernels.program.compiling import named_tuple, types

__all__ = ["INPUT_TABLE", "MARCH_RESULT", "TASKS", "InputTable", "MarchResult", "Tasks"]


class InputTable(NamedTuple):
    """``rows`` (R,): increasing values of t. ``steps``: the first, largest and smallest step.

    ``unknowns``: how many a position has.
    """

    rows: Array
    steps: Array
    unknowns: int


class Tasks(NamedTuple):
    """Ways to go: each a mechanism, a direction (1 upwards, 0 downwards) and a node to start from.

    ``member``, ``way`` (T,); ``node`` (S, T).
    """

    member: IndexArray
    way: IndexArray
    node: Array

    @classmethod
    def room(cls, count: int, size: int) -> Tasks:
        """For so many tasks with nodes of S numbers."""
        return cls(np.empty(count, np.int64), np.empty(count, np.int64), np.empty((size, count)))


class MarchResult(NamedTuple):
    """Results of M mechanisms; the mechanism k of a part has the column ``first + k``.

    Parameters
    ----------
    first : int
    unknowns : (n, R, M)
    radius : (R, M), (0, M) without proofs
    reached : (R, M)
    end : (2, M)
        Where a mechanism could go no further, downwards and upwards: the value of t last reached;
        NaN where it went through all rows.
    last : (2, 2 S, M)
        The last node there and the node before.
    """

    first: int
    unknowns: Array
    radius: Array
    reached: BoolArray
    end: Array
    last: Array


INPUT_TABLE = named_tuple(
    [types.Array(types.float64, 1, "C"), types.Array(types.float64, 1, "C"), types.int64],
    InputTable,
)
TASKS = named_tuple(
    [
        types.Array(types.int64, 1, "C"),
        types.Array(types.int64, 1, "C"),
        types.Array(types.float64, 2, "C"),
    ],
    Tasks,
)
MARCH_RESULT = named_tuple(
    [
        types.int64,
        types.Array(types.float64, 3, "C"),
        types.Array(types.float64, 2, "C"),
        types.Array(types.boolean, 2, "C"),
        types.Array(types.float64, 2, "C"),
        types.Array(types.float64, 3, "C"),
    ],
    MarchResult,
)
