"""Many mechanisms along one path of inputs: every lane follows a mechanism of its own.

A lane tries steps of its own size from row to row of the table; when it is done, or cannot go on,
it takes the next task. So no lane waits for another, whatever their trouble.

Places of nodes change roles all at once (:mod:`trial`). A lane whose step is not taken has its
nodes moved instead.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.kernels.march.march_programs import NODES
from linkwork.kernels.march.step_control import aim, grow, is_lost, stride
from linkwork.kernels.march.step_trial import (
    GOOD,
    RADIUS,
    TOPOLOGY,
    Topology,
    copy_lane,
    correct_and_judge,
    load_lane,
    update_weights,
)
from linkwork.kernels.march.work_arrays import (
    INPUT_TABLE,
    MARCH_RESULT,
    TASKS,
    InputTable,
    MarchResult,
    Tasks,
)
from linkwork.kernels.program.compiling import compiled_for, njit_no_refcount, types
from linkwork.kernels.program.interpreter import LANES
from linkwork.kernels.program.program import ROLES
from linkwork.marching.step_size import HALF

__all__ = ["march"]


@njit_no_refcount
def _store_row(
    w: Array,
    lane: int,
    topology: Topology,
    turn: int,
    row: int,
    member: int,
    unknowns: int,
    found: MarchResult,
) -> None:
    """A row is reached."""
    place = found.first + member
    found.reached[row, place] = True
    for j in range(unknowns):
        found.unknowns[j, row, place] = w[topology.nodes[-turn % ROLES, j], lane]
    if found.radius.shape[0]:
        found.radius[row, place] = w[topology.noted[RADIUS], lane]


@njit_no_refcount
def _stop_design(
    w: Array, lane: int, topology: Topology, turn: int, way: int, member: int, found: MarchResult
) -> None:
    """A mechanism goes no further."""
    nodes = topology.nodes
    size, place = nodes.shape[1], found.first + member
    found.end[way, place] = w[nodes[(1 - turn) % ROLES, size - 1], lane]
    for j in range(size):
        found.last[way, j, place] = w[nodes[(1 - turn) % ROLES, j], lane]
        found.last[way, size + j, place] = w[nodes[(2 - turn) % ROLES, j], lane]


@compiled_for(
    types.void(
        TOPOLOGY, types.Array(types.float64, 2, "C"),
        types.Array(types.float64, 2, "C"), INPUT_TABLE, TASKS, types.int64, MARCH_RESULT,
    )
)  # fmt: skip
def march(
    topology: Topology,
    w: Array,
    design: Array,
    table: InputTable,
    tasks: Tasks,
    count: int,
    found: MarchResult,
) -> None:
    """Go all ways that are asked for.

    Parameters
    ----------
    topology : Topology
    w : (registers, LANES) workspace with constants and options in place
    design : (C, M) coefficients
    table : InputTable
    tasks : Tasks
        The first ``count`` of them.
    found : MarchResult
    """
    rows, steps, nodes = table.rows, table.steps, topology.nodes
    weights, size = topology.weights, nodes.shape[1]
    task = np.full(LANES, -2)  # to be given work; -1: there is none
    row = np.zeros(LANES, np.int64)
    way = np.zeros(LANES, np.int64)
    known = np.zeros(LANES, np.int64)  # nodes that a prediction can use
    h, standing = np.zeros(LANES), np.ones(LANES)
    spacing, times = np.zeros((LANES, NODES)), np.zeros(NODES)
    following, busy, turn = 0, LANES, 0
    w[: nodes.size] = 0.0  # they come first
    for register in topology.noted:
        w[register] = 0.0
    while True:
        t0, t1 = nodes[-turn % ROLES, size - 1], nodes[(1 - turn) % ROLES, size - 1]
        good = topology.noted[GOOD]
        for i in range(LANES):
            while task[i] == -2 or (task[i] >= 0 and (row[i] < 0 or row[i] >= len(rows))):
                if following == count:
                    task[i] = -1
                    standing[i] = 0.0
                    busy -= 1
                    break
                task[i] = following
                following += 1
                way[i] = tasks.way[task[i]]
                load_lane(w, i, topology.coefficients, design, tasks.member[task[i]])
                for role in range(1, ROLES):
                    load_lane(w, i, nodes[(role - turn) % ROLES], tasks.node, task[i])
                known[i] = 1
                spacing[i, :] = np.inf  # like no other
                h[i] = steps[0]
                above = np.searchsorted(rows, w[t1, i])
                row[i] = above if way[i] == 1 else above - 1
            if task[i] < 0:
                continue
            goal = rows[row[i]]
            step = stride(goal, w[t1, i], h[i])
            w[t0, i] = aim(goal, w[t1, i], h[i])
            for role in range(1, ROLES):
                times[role - 1] = w[nodes[(role - turn) % ROLES, size - 1], i]
            update_weights(w, i, weights, times, step, known[i], spacing[i])
        if busy == 0:
            break
        correct_and_judge(topology, turn, w, standing, False, LANES)
        for i in range(LANES):
            if task[i] < 0:
                continue
            m = tasks.member[task[i]]
            moved = abs(w[t0, i] - w[t1, i])
            taken = w[good, i] > 0.5 and not is_lost(w[t0, i], w[t1, i], rows[row[i]])
            if taken:
                if w[t0, i] == rows[row[i]]:
                    _store_row(w, i, topology, turn, row[i], m, table.unknowns, found)
                    row[i] += 2 * way[i] - 1
                h[i] = grow(h[i], moved, steps[1])
                known[i] = min(known[i] + 1, NODES)
            else:
                h[i] = HALF * moved
                if h[i] < steps[2]:
                    _stop_design(w, i, topology, turn, way[i], m, found)
                    row[i] = len(rows) if way[i] == 1 else -1
            if not taken or moved == 0.0:  # the trial is no new node: move the others on
                if taken:
                    known[i] = 1
                for role in range(NODES):
                    copy_lane(w, i, nodes[(role - turn) % ROLES], nodes[(role + 1 - turn) % ROLES])
        turn = (turn + 1) % ROLES
