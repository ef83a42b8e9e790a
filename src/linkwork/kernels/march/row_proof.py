"""Proving rows that are side by side in the lanes, and that they lie on one branch."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, CountArray
from linkwork.kernels.march.named_trial import correct_and_judge
from linkwork.kernels.march.step_control import row_from
from linkwork.kernels.march.step_trial import (
    GOOD,
    RADIUS,
    Topology,
)
from linkwork.kernels.march.work_arrays import InputTable, MarchResult
from linkwork.kernels.program.compiling import compiled, njit_no_refcount
from linkwork.kernels.program.interpreter import LANES
from linkwork.kernels.program.program import ROLES

__all__ = ["keep_rows", "prove_rows"]

_FAR = 1e-7  # rad, or of a length's weight: the error that a row may have before it is proved


@njit_no_refcount
def _all_good(topology: Topology, w: Array, lanes: int) -> bool:
    good, bad = topology.noted[GOOD], 0
    for i in range(lanes):
        bad += not w[good, i] > 0.5
    return bad == 0


@njit_no_refcount
def keep_rows(
    topology: Topology, turn: int, w: Array, lanes: int, row: int, unknowns: int, found: MarchResult
) -> None:
    """Keep the positions of the lanes as rows, from ``row`` on."""
    m, trial = found.first, -turn % ROLES
    for j in range(unknowns):
        source = topology.nodes[trial, j]
        for i in range(lanes):
            found.unknowns[j, row + i, m] = w[source, i]


@njit_no_refcount
def _prove_steps(
    topology: Topology,
    w: Array,
    first: int,
    table: InputTable,
    scale: Array,
    standing: Array,
    found: MarchResult,
    counts: CountArray,
) -> bool:
    """Prove LANES rows from ``first`` on, each from the row before it; whether all are proved.

    The error of the row before is assumed to be :data:`_FAR`, which is checked afterwards.
    """
    nodes, n, m, rows = topology.nodes, len(scale), found.first, table.rows
    last, lanes = nodes.shape[1] - 1, min(LANES, len(rows) - first)
    for i in range(lanes):
        w[nodes[0, last], i] = rows[first + i]
        w[nodes[1, last], i] = rows[max(first + i - 1, 0)]
    for k in range(n):
        mine, near, source = nodes[2, k], nodes[1, k], found.unknowns[k]
        for i in range(lanes):
            w[mine, i] = source[first + i, m]
        for i in range(lanes):
            w[near, i] = source[max(first + i - 1, 0), m]
        for i in range(lanes):
            # the error of the row before, not known yet: checked after the proof
            w[nodes[1, 2 * n + k], i] = _FAR * scale[k]
    count = correct_and_judge(topology, 0, w, standing, False, lanes)
    if not _all_good(topology, w, lanes):
        return False
    outside = 0
    for k in range(n):
        x, error, guess = nodes[0, k], nodes[0, 2 * n + k], nodes[2, k]
        for i in range(lanes):
            outside += not abs(w[x, i] - w[guess, i]) + w[error, i] <= _FAR * scale[k]
    keep_rows(topology, 0, w, lanes, first, n, found)
    radius = topology.noted[RADIUS]
    for i in range(lanes):
        found.radius[first + i, m] = w[radius, i]
        counts[first + i] += count
    return outside == 0


@njit_no_refcount
def _joins_start(
    topology: Topology,
    w: Array,
    start: Array,
    rows: Array,
    scale: Array,
    found: MarchResult,
    standing: Array,
) -> bool:
    """Whether the start (S,) is proved to lie on the branch of the row next to it."""
    nodes, n = topology.nodes, len(scale)
    last = nodes.shape[1] - 1
    row = min(row_from(start[-1], rows), len(rows) - 1)
    if row > 0 and start[-1] - rows[row - 1] < rows[row] - start[-1]:
        row -= 1
    for k in range(n):
        w[nodes[2, k], 0], w[nodes[1, k], 0] = start[k], found.unknowns[k, row, found.first]
        w[nodes[1, 2 * n + k], 0] = _FAR * scale[k]
    w[nodes[0, last], 0], w[nodes[1, last], 0] = start[-1], rows[row]
    correct_and_judge(topology, 0, w, standing, False, 1)
    return bool(w[topology.noted[GOOD], 0] > 0.5)


@compiled
def prove_rows(
    topology: Topology,
    w: Array,
    start: Array,
    table: InputTable,
    scale: Array,
    found: MarchResult,
    counts: CountArray,
) -> bool:
    """Whether all rows are proved, and to be on the branch of the start."""
    for j in range(len(topology.weights)):
        for i in range(LANES):  # the guess: the node before the last
            w[topology.weights[j], i] = 1.0 if j == 2 else 0.0
    standing = np.ones(LANES)
    for first in range(0, len(table.rows), LANES):
        if not _prove_steps(topology, w, first, table, scale, standing, found, counts):
            return False
    return _joins_start(topology, w, start, table.rows, scale, found, standing)
