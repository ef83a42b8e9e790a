"""Predicting rows side by side in the lanes, from the nodes of a march or from earlier rows."""

from __future__ import annotations

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, CountArray
from linkwork.core.numerics.marching import HALF, SAME
from linkwork.core.record.recorder import LANES, ROLES
from linkwork.families.compiled.code_cache import say_that_it_compiles
from linkwork.families.compiled.compiling import (
    compiled,
    compiled_for,
    compiled_within,
    njit_no_refcount,
    types,
)
from linkwork.families.march.march_programs import NODES
from linkwork.families.march.step_trial import (
    GOOD,
    INPUT_TABLE,
    MARCH_RESULT,
    RADIUS,
    TOPOLOGY,
    InputTable,
    MarchResult,
    Topology,
    aim,
    correct_and_judge,
    correct_from_guess,
    grow,
    proves_trials,
    row_from,
    stride,
    update_weights,
)

KNOTS = 6  # rows from which the next ones are predicted, at most
_APART = 0.2  # of a step: a node that is closer to another one adds rounding, not accuracy


@njit_no_refcount
def hermite_weights_of_lanes(
    times: AnyArray, count: int, t: AnyArray, lanes: int, cells: Array
) -> None:
    """Weights at t (lanes,) of values and derivatives at ``count`` times, (2 count, lanes), in
    Hermite's polynomial.
    """
    for j in range(count):
        scale, slope = 1.0, 0.0
        for k in range(count):
            if k != j:
                scale *= times[j] - times[k]
                slope += 1.0 / (times[j] - times[k])
        for i in range(lanes):
            basis = 1.0 / scale
            for k in range(count):
                if k != j:
                    basis *= t[i] - times[k]
            away, square = t[i] - times[j], basis * basis
            # eq. (18)
            cells[2 * j, i], cells[2 * j + 1, i] = (
                (1.0 - 2.0 * slope * away) * square,
                away * square,
            )


@compiled_within
def predict_from_nodes(
    topology: Topology, turn: int, w: Array, lanes: int, used: int, unknowns: int, cells: Array
) -> None:
    """Guesses for the first rows by the polynomial through the nodes behind them, which are the
    same in all lanes, in the place of the oldest one.

    A node close to a later one is left out.
    """
    nodes, last = topology.nodes, topology.nodes.shape[1] - 1
    times, places, count = np.zeros(NODES), np.zeros(NODES, np.int64), 0
    t, near = nodes[-turn % ROLES, last], nodes[(1 - turn) % ROLES, last]
    for k in range(used):
        time, apart = w[nodes[(k + 1 - turn) % ROLES, last], 0], True
        for j in range(count):
            # close nodes have huge weights of opposite signs, which magnify rounding
            apart &= abs(time - times[j]) > _APART * abs(w[t, 0] - w[near, 0])
        if apart:
            times[count], places[count] = time, (k + 1 - turn) % ROLES
            count += 1
    hermite_weights_of_lanes(times, count, w[t], lanes, cells)
    for k in range(unknowns):
        guess = nodes[(ROLES - 1 - turn) % ROLES, k]
        for i in range(lanes):
            w[guess, i] = 0.0
        for j in range(count):
            value, rate = w[nodes[places[j], k], 0], w[nodes[places[j], unknowns + k], 0]
            for i in range(lanes):
                w[guess, i] += cells[2 * j, i] * value + cells[2 * j + 1, i] * rate


@compiled_within
def choose_knots(width: int) -> CountArray:
    """The lanes of this many rows from which the next rows are predicted, the last one first."""
    count = min(KNOTS, width)
    knots = np.empty(count, np.int64)
    for j in range(count):
        knots[j] = width - 1 - j * (width // count)
    return knots


@njit_no_refcount
def predict_from_rows(
    topology: Topology,
    turn: int,
    w: Array,
    lanes: int,
    knots: CountArray,
    cells: Array,
    unknowns: int,
) -> None:
    """Guesses by the polynomial through rows before, in the place of the oldest node."""
    nodes = topology.nodes
    for k in range(unknowns):
        guess, x = nodes[(ROLES - 1 - turn) % ROLES, k], nodes[(1 - turn) % ROLES, k]
        d = nodes[(1 - turn) % ROLES, unknowns + k]
        for i in range(lanes):
            w[guess, i] = 0.0
        for j in range(len(knots)):
            value, rate = w[x, knots[j]], w[d, knots[j]]
            for i in range(lanes):
                w[guess, i] += cells[2 * j, i] * value + cells[2 * j + 1, i] * rate


# ----------------------------------------------------------------------
# Proving rows that are side by side in the lanes, and that they lie on one branch.


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


# ----------------------------------------------------------------------
# One mechanism through a long, even table: rows side by side in the lanes.
#
# A scout marches in one lane from the start to the first row, and on until it has left four nodes.
# Then the lanes are consecutive rows, predicted from six of the rows before them. All this is
# without proofs. Afterwards every row is proved, and that it lies on the branch of the row before
# it; at last that the start lies on the branch of the row next to it. Designs for which this fails
# are left to :mod:`linkwork.kernels.march.independent`.


say_that_it_compiles("rowwise")

DONE, LEFT, NOT_NEAR = 1, 0, -1

_STRIDE = 0.6  # of the largest step: as far reach rows that are computed together
_VECTOR = 8  # lanes that a processor computes at once
_FEWEST = 4  # with fewer the march is as quick
_ANY = 1 << 30  # nodes: as many as the way takes
_CLOSE = 0.1  # a guess this near needs no small steps
_BEND = 0.1  # without proofs, from row to row: a change of rates times the distance,
_ROUGH = 0.03  # and the change that rates do not explain, part of the way and of a largest step


@njit_no_refcount
def _gap(rows: Array) -> float:
    """From row to row; 0 where it is not the same everywhere."""
    # from end to end, so that the rounding of one distance is not multiplied
    gap: float = (rows[-1] - rows[0]) / (len(rows) - 1)
    for k in range(len(rows)):
        if abs(rows[k] - (rows[0] + k * gap)) > SAME * gap:
            return 0.0
    return gap


@njit_no_refcount
def _set_out(topology: Topology, w: Array, node: Array) -> None:
    """A node (S,) into the first lane, as the only one."""
    for role in range(1, ROLES):
        for j in range(len(node)):
            w[topology.nodes[role, j], 0] = node[j]


@njit_no_refcount
def _store_node(topology: Topology, turn: int, w: Array, lane: int, node: Array) -> None:
    """The trial of a lane as a node (S,)."""
    for j in range(len(node)):
        node[j] = w[topology.nodes[-turn % ROLES, j], lane]


@compiled_within
def _solve_start(topology: Topology, w: Array, guess: Array, scale: Array, node: Array) -> bool:
    """The position at a guess (n + 1,) close to it, into ``node`` (S,); whether it is close."""
    nodes, n, last = topology.nodes, len(scale), topology.nodes.shape[1] - 1
    for role in range(1, ROLES):
        for j in range(last):
            w[nodes[role, j], 0] = guess[j] if j < n else 0.0
        w[nodes[role, last], 0] = guess[n]
    w[nodes[0, last], 0] = guess[n]
    if topology.trial == 0 or correct_from_guess(topology, 0, w, np.ones(1), 1, n) == 0:
        return False
    _store_node(topology, 0, w, 0, node)
    near = 0
    for k in range(n):
        near += abs(node[k] - guess[k]) <= _CLOSE * scale[k]
    return near == n


@compiled_within
def _march_to(
    topology: Topology, w: Array, turn: int, known: int, end: float, steps: Array, enough: int
) -> tuple[int, int]:
    """In the first lane to ``end``, or until ``enough`` nodes are behind: how often roles have
    moved on, and how many nodes there are; none where it does not get there.
    """
    nodes, last = topology.nodes, topology.nodes.shape[1] - 1
    h = steps[0]
    times, spacing, alone = np.zeros(NODES), np.full(NODES, np.inf), np.ones(1)
    while known < enough and w[nodes[(1 - turn) % ROLES, last], 0] != end:
        for role in range(1, ROLES):
            times[role - 1] = w[nodes[(role - turn) % ROLES, last], 0]
        step = stride(end, times[0], h)
        w[nodes[-turn % ROLES, last], 0] = aim(end, times[0], h)
        update_weights(w, 0, topology.weights, times, step, known, spacing)
        correct_and_judge(topology, turn, w, alone, False, 1)
        if w[topology.noted[GOOD], 0] > 0.5:
            known, h = known + 1, grow(h, abs(step), steps[1])
            turn = (turn + 1) % ROLES
        else:
            h = HALF * abs(step)
            if h < steps[2]:
                return turn, 0
    return turn, known


@compiled_within
def _find_nodes(
    topology: Topology, w: Array, node: Array, row: int, table: InputTable
) -> tuple[int, int]:
    """Nodes from a node to a row and some behind that; the same as :func:`_march_to`."""
    rows, steps = table.rows, table.steps
    _set_out(topology, w, node)
    turn, known = _march_to(topology, w, int(np.int64(0)), int(np.int64(1)), rows[row], steps, _ANY)
    if known and known < NODES:
        turn, known = _march_to(topology, w, turn, known, rows[-1], steps, NODES)
    return turn, known


@compiled
def _is_smooth(
    topology: Topology,
    turn: int,
    w: Array,
    lanes: int,
    before: Array,
    is_first: bool,
    scale: Array,
    gap: float,
    largest: float,
) -> bool:
    """Whether rows follow from the rates of the rows before them, and det J keeps its sign.

    ``before`` (S,): the row before the first lane, unless that is the first one of all.
    """
    nodes, n, rough, trial = topology.nodes, len(scale), 0, -turn % ROLES
    for k in range(n):
        x, d = nodes[trial, k], nodes[trial, n + k]
        most, least = _BEND * scale[k], scale[k] * gap / largest
        x0, d0 = before[k], before[n + k]
        for i in range(lanes):
            if i > 0 or not is_first:
                bend, way = gap * abs(w[d, i] - d0), 0.5 * gap * (w[d, i] + d0)
                off = abs(w[x, i] - x0 - way)
                rough += not (bend <= most and off <= bend + _ROUGH * (abs(way) + least))
            x0, d0 = w[x, i], w[d, i]
    for k in range(2 * n, nodes.shape[1] - 1):
        side, sign = nodes[trial, k], before[k]
        for i in range(lanes):
            rough += not sign * w[side, i] > 0.0
    return rough == 0


@compiled_within
def _solve_stretch(
    topology: Topology,
    w: Array,
    first: int,
    width: int,
    before: Array,
    table: InputTable,
    scale: Array,
    gap: float,
    trusting: bool,
    found: MarchResult,
    counts: CountArray,
) -> int:
    """Solve rows from ``first`` on, ``width`` at once; return the first row that is not found.

    ``before`` (S,): the start, or the row before the first one; set to the last row.
    ``trusting``: whether rows will be proved.
    """
    rows, n, nodes = table.rows, table.unknowns, topology.nodes
    size = nodes.shape[1]
    standing, cells, knots = np.ones(LANES), np.empty((2 * KNOTS, LANES)), choose_knots(width)
    turn, known = _find_nodes(topology, w, before, first, table)
    if known == 0:
        return first
    for role in range(ROLES):
        for j in range(size):
            register = nodes[role, j]
            for i in range(1, width):
                w[register, i] = w[register, 0]
    for j in range(len(topology.weights)):
        # the guess has the place of the oldest node
        for i in range(width):
            w[topology.weights[j], i] = 1.0 if j == 2 * NODES - 2 else 0.0
    block = 0
    while first < len(rows):
        lanes, t = min(width, len(rows) - first), nodes[-turn % ROLES, size - 1]
        for i in range(lanes):
            w[t, i] = rows[first + i]
        if block == 0:
            predict_from_nodes(topology, turn, w, lanes, min(known, NODES - 1), n, cells)
        else:
            if block == 1:
                hermite_weights_of_lanes(
                    (knots - width) * gap, len(knots), np.arange(width) * gap, width, cells
                )
            predict_from_rows(topology, turn, w, lanes, knots, cells, n)
        count = correct_from_guess(topology, turn, w, standing, lanes, n)
        if count == 0:
            return first
        if not trusting and not _is_smooth(
            topology, turn, w, lanes, before, first == 0, scale, gap, table.steps[1]
        ):
            return first
        keep_rows(topology, turn, w, lanes, first, n, found)
        for i in range(lanes):
            counts[first + i] = count
        _store_node(topology, turn, w, lanes - 1, before)
        turn = (turn + 1) % ROLES
        first, block = first + lanes, block + 1
    return first


@compiled_for(
    types.int64(
        TOPOLOGY, TOPOLOGY, types.Array(types.float64, 2, "C"), types.Array(types.float64, 2, "C"),
        types.Array(types.float64, 1, "C"), types.boolean, INPUT_TABLE,
        types.Array(types.float64, 1, "C"), MARCH_RESULT, types.Array(types.int64, 1, "C"),
    )
)  # fmt: skip
def by_rows(
    topology: Topology,
    scout: Topology,
    w: Array,
    own: Array,
    begin: Array,
    solved: bool,
    table: InputTable,
    scale: Array,
    found: MarchResult,
    counts: CountArray,
) -> int:
    """One mechanism through all rows.

    Parameters
    ----------
    topology : Topology
    scout : Topology
        The same equations without proofs.
    w, own : (registers, LANES)
        Workspaces of the two with constants, options and coefficients in place.
    begin : (S,)
        Where it starts: a node of the scout if it is ``solved``, else a guess of the unknowns, and
        t behind it.
    solved : bool
    table : InputTable
    scale : (n,)
        Weights of the unknowns: 1 of an angle.
    found : MarchResult
        The column ``first`` is filled.
    counts : (R,)
        Filled: how many corrections each row took.

    Returns
    -------
    int
        :data:`DONE`; :data:`NOT_NEAR` if the guess is not near a position, :data:`LEFT` if not
        every row is found: then nothing counts.
    """
    rows, gap = table.rows, _gap(table.rows)
    width = 0 if gap == 0.0 else int(min(float(LANES), _STRIDE * table.steps[1] / gap))
    # whole vectors: a rest costs as much as a full one
    width -= width % _VECTOR if width > _VECTOR else 0
    start = np.zeros(scout.nodes.shape[1])
    if solved:
        for j in range(len(start)):
            start[j] = begin[j]
    else:
        for j in range(len(scout.weights)):
            own[scout.weights[j], 0] = 1.0 if j == 2 * NODES - 2 else 0.0
        if not _solve_start(scout, own, begin, scale, start):
            return NOT_NEAR
    before, certify, first = start.copy(), proves_trials(topology), int(np.int64(0))
    while first < len(rows):
        if width < _FEWEST:
            return LEFT
        reached = _solve_stretch(
            scout, own, first, width, before, table, scale, gap, certify, found, counts
        )
        # where predictions over many rows fail, fewer rows at once may do
        first, width = reached, width // 2
    if certify and not prove_rows(topology, w, start, table, scale, found, counts):
        return LEFT
    for row in range(len(rows)):
        found.reached[row, found.first] = True
    return DONE
