"""Many mechanisms in step: 64 at a time go from row to row of the table together.

All lanes have the same inputs, so the weights of a prediction are shared and results are written as
whole rows. A lane whose step is not good leaves the others and becomes a task of
:mod:`linkwork.kernels.lanes.marching`, which has steps of its own size.
"""

from __future__ import annotations

import math

import numpy as np

from linkwork.kernels.lanes.compiling import compiled, compiled_for, types
from linkwork.kernels.lanes.machine import LANES
from linkwork.kernels.lanes.march_programs import NODES, ROLES
from linkwork.kernels.lanes.tasks import FOUND, TABLE, TASKS
from linkwork.kernels.lanes.trial import (
    GOOD,
    RADIUS,
    TOPOLOGY,
    chosen,
    loaded,
    settled,
)

__all__ = ["in_step"]

_LARGEST = 0.5  # of the largest step: further apart, rows have nodes between them
_WORTH = LANES // 2  # with fewer lanes left each goes on by itself


@compiled
def _left(lane, member, way, topology, turn, w, tasks, count):  # type: ignore[no-untyped-def]
    """A lane goes on by itself from its last node; how many tasks there are now."""
    tasks.member[count], tasks.way[count] = member, way
    nodes = topology.nodes
    for j in range(nodes.shape[1]):
        tasks.node[j, count] = w[nodes[(1 - turn) % ROLES, j], lane]
    return count + 1


@compiled
def _weighted(w, topology, turn, steps, spacing):  # type: ignore[no-untyped-def]
    """The weights of the prediction: for each lane by itself until all have the same nodes behind.

    ``spacing`` (4,): of the trial and the nodes before, for which the weights are at hand.
    """
    nodes, weights = topology.nodes, topology.weights
    last, times = nodes.shape[1] - 1, np.zeros(NODES)
    trial, shared = nodes[-turn % ROLES, last], steps > NODES
    for lane in range(1 if shared else LANES):
        for role in range(1, ROLES):
            times[role - 1] = w[nodes[(role - turn) % ROLES, last], lane]
        step = w[trial, lane] - times[0]
        if not shared:
            spacing[:] = np.inf  # each lane's own
        changed = chosen(w, lane, weights, times, step, steps, spacing)
        if shared and changed:
            for j in range(len(weights)):
                w[weights[j], 1:] = w[weights[j], 0]


@compiled
def _kept(first, width, row, topology, turn, w, standing, all_stand, table, found):  # type: ignore[no-untyped-def]
    """A row is reached by the lanes that stand."""
    target, radius, reached = found.unknowns, found.radius, found.reached
    place, error = topology.nodes, topology.noted[-turn % ROLES, RADIUS]
    proofs = radius.shape[0] > 0
    if all_stand:
        for j in range(table.unknowns):
            source = place[-turn % ROLES, j]
            for i in range(width):
                target[j, row, first + i] = w[source, i]
        if proofs:
            for i in range(width):
                radius[row, first + i] = w[error, i]
        for i in range(width):
            reached[row, first + i] = True
        return
    for i in range(width):
        if standing[i] > 0.5:
            for j in range(table.unknowns):
                target[j, row, first + i] = w[place[-turn % ROLES, j], i]
            if proofs:
                radius[row, first + i] = w[error, i]
            reached[row, first + i] = True


@compiled
def _one_way(  # type: ignore[no-untyped-def]
    base, way, topology, w, begun, node, table, tasks, count, found
):
    """64 mechanisms in one direction; how many tasks there are now."""
    rows, nodes = table.rows, topology.nodes
    size = nodes.shape[1]
    width = min(LANES, node.shape[1] - base)
    standing = np.zeros(LANES)
    ahead, there = -1, False  # the first row, and whether the start lies on it: the same for all
    for i in range(LANES):
        member = base + min(i, width - 1)
        for role in range(1, ROLES):
            loaded(w, i, nodes[role], node, member)
        if i >= width or not begun[member]:
            continue
        t = node[size - 1, member]
        above = np.searchsorted(rows, t)
        own = above if way == 1 else above - 1
        if own < 0 or own >= len(rows):
            continue
        if ahead < 0:
            ahead, there = own, rows[own] == t
        if own == ahead and (rows[own] == t) == there:
            standing[i] = 1.0
        else:
            count = _left(i, member, way, topology, 0, w, tasks, count)
    turn, steps, spacing = 0, 0, np.full(NODES, np.inf)
    row = ahead
    while 0 <= row < len(rows):
        left = 0
        for i in range(LANES):
            left += standing[i] > 0.5
        if left < min(_WORTH, (width + 1) // 2):
            break
        last, trial = nodes[(1 - turn) % ROLES, size - 1], nodes[-turn % ROLES, size - 1]
        lead = 0
        while standing[lead] == 0.0:
            lead += 1
        away = rows[row] - w[last, lead]
        parts = math.ceil(abs(away) / (_LARGEST * table.steps[1]))
        goal = rows[row] if parts <= 1 else w[last, lead] + away / parts
        for i in range(LANES):
            w[trial, i] = goal
        steps += 1
        _weighted(w, topology, turn, steps, spacing)
        settled(topology, turn, w, standing, LANES)
        bad, good = 0, topology.noted[-turn % ROLES, GOOD]
        for i in range(LANES):
            bad += standing[i] > w[good, i]
        if bad:
            for i in range(width):
                if standing[i] > 0.5 and not w[good, i] > 0.5:
                    standing[i] = 0.0
                    left -= 1
                    count = _left(i, base + i, way, topology, turn, w, tasks, count)
        if parts <= 1:
            _kept(
                found.first + base,
                width,
                row,
                topology,
                turn,
                w,
                standing,
                left == width,
                table,
                found,
            )
            row += 2 * way - 1
        if away != 0.0:
            turn = (turn + 1) % ROLES
        else:
            steps = 0
    if 0 <= row < len(rows):
        for i in range(width):
            if standing[i] > 0.5:
                count = _left(i, base + i, way, topology, turn, w, tasks, count)
    return count


@compiled_for(
    types.int64(
        TOPOLOGY, types.Array(types.float64, 2, "C"),
        types.Array(types.float64, 2, "C"), types.Array(types.float64, 2, "C"),
        types.Array(types.boolean, 1, "C"), TABLE, TASKS, FOUND,
    )
)  # fmt: skip
def in_step(topology, w, design, node, begun, table, tasks, found):  # type: ignore[no-untyped-def]
    """Lead mechanisms through the rows of the table as far as they go together.

    Parameters
    ----------
    topology : Topology
    w : (registers, LANES) workspace with constants and options in place
    design : (C, M) coefficients
    node, begun : (S, M), (M,) where they start, and whether they do
    table : Table
    tasks : Tasks
        Room for 2 M; filled with what is left to do.
    found : Found

    Returns
    -------
    int
        How many tasks.
    """
    count = 0
    for base in range(0, node.shape[1], LANES):
        width = min(LANES, node.shape[1] - base)
        for lane in range(LANES):
            loaded(w, lane, topology.coefficients, design, base + min(lane, width - 1))
        for way in (1, 0):
            count = _one_way(
                base,
                way,
                topology,
                w,
                begun,
                node,
                table,
                tasks,
                count,
                found,
            )
    return count
