"""Many mechanisms in step: 64 at a time go from row to row of the table together.

All lanes have the same inputs, so the weights of a prediction are shared and results are written as
whole rows. A lane whose step is not good leaves the others and becomes a task of
:mod:`linkwork.families.march.independent`, which has steps of its own size.
"""

from __future__ import annotations

import math

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.record.recorder import LANES, ROLES
from linkwork.families.compiled.code_cache import say_that_it_compiles
from linkwork.families.compiled.compiling import (
    compiled_for,
    inlined,
    memcpy,
    njit_no_refcount,
    numbers,
    prefetch,
    truths,
    types,
)
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
    correct_and_judge,
    load_all_lanes,
    row_from,
    update_weights,
)

say_that_it_compiles("march.lockstep")

_LINE = 64  # bytes of a cache line
_LARGEST = 0.5  # of the largest step: further apart, rows have nodes between them
_WORTH = LANES // 2  # with fewer lanes left each continues with steps of its own


@njit_no_refcount
def _leave_lockstep(
    lane: int,
    member: int,
    way: int,
    topology: Topology,
    turn: int,
    w: Array,
    tasks: Tasks,
    count: int,
) -> int:
    """Make a lane a task of its own, from its last node; return how many tasks there are now."""
    tasks.member[count], tasks.way[count] = member, way
    nodes = topology.nodes
    for j in range(nodes.shape[1]):
        tasks.node[j, count] = w[nodes[(1 - turn) % ROLES, j], lane]
    return count + 1


@njit_no_refcount
def _update_lane_weights(
    w: Array,
    topology: Topology,
    turn: int,
    steps: int,
    together: bool,
    spacing: Array,
    times: Array,
) -> None:
    """The weights of the prediction: for each lane by itself until all have the same nodes behind.

    ``together``: whether they have started at the same t. ``spacing`` (4,): of the trial and the
    nodes before, for which the weights were computed. ``times`` (4,): workspace.
    """
    nodes, weights = topology.nodes, topology.weights
    last, trial = nodes.shape[1] - 1, nodes[-turn % ROLES, nodes.shape[1] - 1]
    shared = together or steps > NODES
    for lane in range(1 if shared else LANES):
        for role in range(1, ROLES):
            times[role - 1] = w[nodes[(role - turn) % ROLES, last], lane]
        step = w[trial, lane] - times[0]
        if not shared:
            spacing[:] = np.inf  # each lane's own
        changed = update_weights(w, lane, weights, times, step, steps, spacing)
        if shared and changed:
            for j in range(len(weights)):
                w[weights[j], 1:] = w[weights[j], 0]


@njit_no_refcount
def _address(array: Array, j: int, row: int, first: int) -> int:
    strides = array.strides
    return array.ctypes.data + j * strides[0] + row * strides[1] + first * strides[2]


@njit_no_refcount
def _prefetch_row(first: int, width: int, row: int, table: InputTable, found: MarchResult) -> None:
    """Prefetch the places of a row into the cache while the row is computed."""
    target = found.unknowns
    for j in range(table.unknowns):
        place = _address(target, j, row, first)
        for line in range(0, width * target.strides[2], _LINE):
            prefetch(place + line)


@njit_no_refcount
def _store_row(
    first: int,
    width: int,
    row: int,
    topology: Topology,
    turn: int,
    w: Array,
    standing: Array,
    all_stand: bool,
    table: InputTable,
    found: MarchResult,
) -> None:
    """Store a row for all lanes that take part."""
    target, radius, reached = found.unknowns, found.radius, found.reached
    place, error = topology.nodes, topology.noted[RADIUS]
    proofs = radius.shape[0] > 0
    if all_stand:
        for j in range(table.unknowns):
            source = place[-turn % ROLES, j]
            if target.strides[2] == w.itemsize:
                memcpy(_address(target, j, row, first), w[source].ctypes.data, width)
                continue
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


@njit_no_refcount
def _set_out(
    base: int,
    way: int,
    topology: Topology,
    w: Array,
    begun: BoolArray,
    node: Array,
    rows: Array,
    standing: Array,
    tasks: Tasks,
    count: int,
) -> tuple[int, bool, int]:
    """Find the lanes that march together in this direction; the others become tasks.

    Returns
    -------
    ahead, together, count : int, bool, int
        The first row, -1 if no lane marches; whether all lanes start at the same t; how many tasks.
    """
    size, width = topology.nodes.shape[1], min(LANES, node.shape[1] - base)
    for role in range(1, ROLES):
        load_all_lanes(w, topology.nodes[role], node, base, width)
    t = topology.nodes[1, size - 1]
    ahead, there, together = -1, False, True
    standing[:] = 0.0
    for i in range(LANES):
        together &= w[t, i] == w[t, 0]
    for i in range(width):
        if not begun[base + i]:
            continue
        above = row_from(w[t, i], rows)
        own = above if way == 1 else above - 1
        if own < 0 or own >= len(rows):
            continue
        if ahead < 0:
            ahead, there = own, rows[own] == w[t, i]
        if own == ahead and (rows[own] == w[t, i]) == there:
            standing[i] = 1.0
        else:
            count = _leave_lockstep(i, base + i, way, topology, 0, w, tasks, count)
    return ahead, together, count


@njit_no_refcount
def _aim_at_row(
    base: int,
    width: int,
    row: int,
    topology: Topology,
    turn: int,
    w: Array,
    standing: Array,
    table: InputTable,
    found: MarchResult,
) -> tuple[float, int]:
    """The trial's t: of the row, or on the way to it. How far the row is; in how many steps, -1
    where a step would be lost in rounding.
    """
    last = topology.nodes.shape[1] - 1
    t0, t1 = topology.nodes[-turn % ROLES, last], topology.nodes[(1 - turn) % ROLES, last]
    lead = 0
    while standing[lead] == 0.0:
        lead += 1
    away = table.rows[row] - w[t1, lead]
    # equal parts instead of one long and one short step: the weights of the prediction stay
    parts = math.ceil(abs(away) / (_LARGEST * table.steps[1]))
    w[t0, :] = table.rows[row] if parts <= 1 else w[t1, lead] + away / parts
    if parts > 1 and w[t0, lead] == w[t1, lead]:
        return away, -1
    if parts <= 1:
        _prefetch_row(found.first + base, width, row, table, found)
    return away, parts


@inlined
def _march_one_way(
    base: int,
    way: int,
    topology: Topology,
    w: Array,
    begun: BoolArray,
    node: Array,
    table: InputTable,
    tasks: Tasks,
    count: int,
    found: MarchResult,
) -> int:
    """64 mechanisms in one direction; how many tasks there are now."""
    width, standing = min(LANES, node.shape[1] - base), np.zeros(LANES)
    spacing, times = np.full(NODES, np.inf), np.zeros(NODES)
    row, together, count = _set_out(
        base, way, topology, w, begun, node, table.rows, standing, tasks, count
    )
    turn, steps, good = int(np.int64(0)), int(np.int64(0)), topology.noted[GOOD]
    # with most lanes gone, marching them one by one wastes less
    left = int(standing.sum())
    while 0 <= row < len(table.rows) and left >= min(_WORTH, (width + 1) // 2):
        away, parts = _aim_at_row(base, width, row, topology, turn, w, standing, table, found)
        if parts < 0:
            break
        steps += 1
        _update_lane_weights(w, topology, turn, steps, together, spacing, times)
        correct_and_judge(topology, turn, w, standing, True, LANES)
        bad = 0
        for i in range(LANES):
            bad += standing[i] > w[good, i]
        if bad:
            for i in range(width):
                if standing[i] > 0.5 and not w[good, i] > 0.5:
                    standing[i] = 0.0
                    left -= 1
                    count = _leave_lockstep(i, base + i, way, topology, turn, w, tasks, count)
        if parts <= 1:
            first, all_stand = found.first + base, left == width
            _store_row(first, width, row, topology, turn, w, standing, all_stand, table, found)
            row += 2 * way - 1
        if away != 0.0:
            turn = (turn + 1) % ROLES
        else:
            steps = int(np.int64(0))
    if 0 <= row < len(table.rows):
        for i in range(width):
            if standing[i] > 0.5:
                count = _leave_lockstep(i, base + i, way, topology, turn, w, tasks, count)
    return count


@compiled_for(
    types.int64(
        TOPOLOGY, numbers(2), numbers(2), numbers(2), truths(1), INPUT_TABLE, TASKS, MARCH_RESULT
    )
)
def in_step(
    topology: Topology,
    w: Array,
    design: Array,
    node: Array,
    begun: BoolArray,
    table: InputTable,
    tasks: Tasks,
    found: MarchResult,
) -> int:
    """Lead mechanisms through the rows of the table as far as they go together.

    Parameters
    ----------
    topology : Topology
    w : (registers, LANES) workspace with constants and options in place
    design : (C, M) coefficients
    node, begun : (S, M), (M,) where they start, and whether they do
    table : InputTable
    tasks : Tasks
        Room for 2 M tasks; filled with those that are left.
    found : MarchResult

    Returns
    -------
    int
        How many tasks.
    """
    count = int(np.int64(0))  # no constant, for which callees would be compiled as well
    for base in range(0, node.shape[1], LANES):
        width = min(LANES, node.shape[1] - base)
        load_all_lanes(w, topology.coefficients, design, base, width)
        for way in (1, 0):
            count = _march_one_way(base, way, topology, w, begun, node, table, tasks, count, found)
    return count
