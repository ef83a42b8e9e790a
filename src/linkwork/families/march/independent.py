"""Many mechanisms along one path of inputs: every lane follows a mechanism of its own.

A lane tries steps of its own size from row to row of the table; when it is done, or cannot go on,
it takes the next task. So no lane waits for another, whatever their trouble.

Places of nodes change roles all at once (:mod:`linkwork.families.march.step_trial`). A lane whose
step is not taken has its nodes moved instead.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.numerics.marching import HALF
from linkwork.core.record.recorder import LANES, ROLES
from linkwork.families.compiled.code_cache import say_that_it_compiles
from linkwork.families.compiled.compiling import compiled_for, njit_no_refcount, numbers, types
from linkwork.families.march.march_programs import NODES
from linkwork.families.march.step_trial import (
    GOOD,
    INPUT_TABLE,
    MARCH_RESULT,
    RADIUS,
    TASKS,
    TOPOLOGY,
    InputTable,
    MarchResult,
    Tasks,
    Topology,
    aim,
    copy_lane,
    correct_and_judge,
    grow,
    is_lost,
    load_lane,
    row_from,
    stride,
    update_weights,
)

say_that_it_compiles("march.independent")

_NO_TASK_YET, _NO_TASK_LEFT = -2, -1
_VECTOR = 8  # lanes that a processor computes at once


class _Work(NamedTuple):
    """The state of every lane, (LANES,): its task, its next row, its direction (1 upwards).

    ``known``: how many nodes a prediction can use. ``h``: the next step at most. ``spacing``
    (LANES, 4): of the nodes for which the weights of the prediction were computed.
    """

    task: IndexArray
    row: IndexArray
    way: IndexArray
    known: IndexArray
    h: Array
    spacing: Array


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
    """Store the position of a row that is reached."""
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
    """Note that a mechanism stops: its last node and the node before."""
    nodes = topology.nodes
    size, place = nodes.shape[1], found.first + member
    found.end[way, place] = w[nodes[(1 - turn) % ROLES, size - 1], lane]
    for j in range(size):
        found.last[way, j, place] = w[nodes[(1 - turn) % ROLES, j], lane]
        found.last[way, size + j, place] = w[nodes[(2 - turn) % ROLES, j], lane]


@njit_no_refcount
def _give_task(
    w: Array,
    lane: int,
    topology: Topology,
    turn: int,
    design: Array,
    table: InputTable,
    tasks: Tasks,
    count: int,
    following: int,
    work: _Work,
) -> int:
    """Give a lane without work the next task; return the task that follows it."""
    nodes, rows, size = topology.nodes, table.rows, topology.nodes.shape[1]
    while work.task[lane] == _NO_TASK_YET or (
        work.task[lane] >= 0 and not 0 <= work.row[lane] < len(rows)
    ):
        if following == count:
            work.task[lane] = _NO_TASK_LEFT
            break
        work.task[lane], work.way[lane] = following, tasks.way[following]
        load_lane(w, lane, topology.coefficients, design, tasks.member[following])
        for role in range(1, ROLES):
            load_lane(w, lane, nodes[(role - turn) % ROLES], tasks.node, following)
        work.known[lane], work.h[lane] = 1, table.steps[0]
        work.spacing[lane, :] = np.inf  # equal to no spacing, so that weights are computed
        above = row_from(w[nodes[(1 - turn) % ROLES, size - 1], lane], rows)
        work.row[lane] = above if work.way[lane] == 1 else above - 1
        following += 1
    return following


@njit_no_refcount
def _take_or_halve_step(
    w: Array,
    lane: int,
    topology: Topology,
    turn: int,
    member: int,
    table: InputTable,
    work: _Work,
    found: MarchResult,
) -> None:
    """Take the step of a lane if its trial is good, else halve it, and stop below the least."""
    nodes, rows, last = topology.nodes, table.rows, topology.nodes.shape[1] - 1
    t0, t1 = w[nodes[-turn % ROLES, last], lane], w[nodes[(1 - turn) % ROLES, last], lane]
    goal, moved = rows[work.row[lane]], abs(t0 - t1)
    taken = w[topology.noted[GOOD], lane] > 0.5 and not is_lost(t0, t1, goal)
    if taken:
        if t0 == goal:
            _store_row(w, lane, topology, turn, work.row[lane], member, table.unknowns, found)
            work.row[lane] += 2 * work.way[lane] - 1
        # eq. (22): doubled after a whole step
        work.h[lane] = grow(work.h[lane], moved, table.steps[1])
        work.known[lane] = min(work.known[lane] + 1, NODES)
    else:
        work.h[lane] = HALF * moved  # eq. (22): halved after a failure
        if work.h[lane] < table.steps[2]:
            _stop_design(w, lane, topology, turn, work.way[lane], member, found)
            work.row[lane] = len(rows) if work.way[lane] == 1 else -1
    if not taken or moved == 0.0:  # the trial is no new node: move the others on
        if taken:
            work.known[lane] = 1
        for role in range(NODES):
            copy_lane(w, lane, nodes[(role - turn) % ROLES], nodes[(role + 1 - turn) % ROLES])


@compiled_for(
    types.void(TOPOLOGY, numbers(2), numbers(2), INPUT_TABLE, TASKS, types.int64, MARCH_RESULT)
)
def march(
    topology: Topology,
    w: Array,
    design: Array,
    table: InputTable,
    tasks: Tasks,
    count: int,
    found: MarchResult,
) -> None:
    """Work through all tasks.

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
    rows, nodes, size = table.rows, topology.nodes, topology.nodes.shape[1]
    work = _Work(
        np.full(LANES, _NO_TASK_YET),
        np.zeros(LANES, np.int64),
        np.zeros(LANES, np.int64),
        np.zeros(LANES, np.int64),
        np.zeros(LANES),
        np.zeros((LANES, NODES)),
    )
    standing, times = np.ones(LANES), np.zeros(NODES)
    # whole numbers, not constants: callees would be compiled for constants as well
    following, turn = int(np.int64(0)), int(np.int64(0))
    lanes = min(LANES, _VECTOR * ((count + _VECTOR - 1) // _VECTOR))
    # idle lanes compute with these: zeros make no slow or invalid numbers
    w[: nodes.size] = 0.0  # they come first
    for register in topology.noted:
        w[register] = 0.0
    while True:
        t0, t1 = nodes[-turn % ROLES, size - 1], nodes[(1 - turn) % ROLES, size - 1]
        busy = 0
        for i in range(lanes):
            following = _give_task(
                w, i, topology, turn, design, table, tasks, count, following, work
            )
            if work.task[i] == _NO_TASK_LEFT:
                standing[i] = 0.0
                continue
            busy += 1
            goal = rows[work.row[i]]
            step = stride(goal, w[t1, i], work.h[i])
            w[t0, i] = aim(goal, w[t1, i], work.h[i])
            for role in range(1, ROLES):
                times[role - 1] = w[nodes[(role - turn) % ROLES, size - 1], i]
            update_weights(w, i, topology.weights, times, step, work.known[i], work.spacing[i])
        if busy == 0:
            break
        correct_and_judge(topology, turn, w, standing, False, lanes)
        for i in range(lanes):
            if work.task[i] != _NO_TASK_LEFT:
                member = tasks.member[work.task[i]]
                _take_or_halve_step(w, i, topology, turn, member, table, work, found)
        turn = (turn + 1) % ROLES
