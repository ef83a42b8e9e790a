"""One mechanism through a long table: rows side by side in the lanes.

A scout goes through the table in one lane with large steps and without proofs. Between its nodes
finer nodes are set, 64 at a time: predicted by the polynomial through four nodes with their
derivatives, corrected, and each proved from its neighbour, so that all are on the branch of the
start. Rows are found from these nodes in the same way and proved from the nearest one. What does
not go well is left to :mod:`linkwork.kernels.lanes.marching`.
"""

from __future__ import annotations

import math

import numpy as np

from linkwork.kernels.lanes.compiling import compiled, compiled_for, types
from linkwork.kernels.lanes.machine import LANES
from linkwork.kernels.lanes.march_programs import NODES, ROLES
from linkwork.kernels.lanes.stepping import GROWTH
from linkwork.kernels.lanes.tasks import FOUND, TABLE
from linkwork.kernels.lanes.trial import (
    GOOD,
    RADIUS,
    TOPOLOGY,
    chosen,
    judged,
    proved,
    settled,
)

__all__ = ["by_rows", "most_nodes"]

#: Of the largest step: how far finer nodes are apart; half of it and a quarter where that fails.
COARSE = 1.0 / 6.0
_ORDER = 2 * NODES
_FEW = 60  # rows for each of the scout's nodes, below which finer nodes do not pay
_FAR = 1e-7  # of an unknown: as much as a node may be off


def most_nodes(far: float, largest: float) -> int:
    """Room for nodes so far, with steps as large: more are not worth it."""
    return 64 + 4 * math.ceil(far / (COARSE * largest))


@compiled
def _one_way(topology, w, end, steps, coarse):  # type: ignore[no-untyped-def]
    """From the first node of ``coarse`` (K, S) to ``end``; how many nodes were found after it, -1
    where the scout does not get there.
    """
    nodes = topology.nodes
    size = nodes.shape[1]
    for role in range(1, ROLES):
        for j in range(size):
            w[nodes[role, j], 0] = coarse[0, j]
    h, turn, known, count = steps[0], 0, 1, 0
    times, spacing = np.zeros(NODES), np.full(NODES, np.inf)
    alone = np.ones(1)
    while w[nodes[(1 - turn) % ROLES, size - 1], 0] != end:
        if count + 1 == len(coarse):
            return -1
        for role in range(1, ROLES):
            times[role - 1] = w[nodes[(role - turn) % ROLES, size - 1], 0]
        away = end - times[0]
        step = math.copysign(min(abs(away), h), away)
        w[nodes[-turn % ROLES, size - 1], 0] = end if step == away else times[0] + step
        chosen(w, 0, topology.weights, times, step, known, spacing)
        settled(topology, turn, w, alone, False, 1)
        if w[topology.noted[GOOD], 0] > 0.5:
            count += 1
            for j in range(size):
                coarse[count, j] = w[nodes[-turn % ROLES, j], 0]
            known, h = min(known + 1, NODES), min(GROWTH * h, steps[1])
            turn = (turn + 1) % ROLES
        else:
            h = 0.5 * abs(step)
            if h < steps[2]:
                return -1
    return count


@compiled
def _spaced(coarse, first, used, z, apart):  # type: ignore[no-untyped-def]
    """Nodes, each twice, and one over their distances, which all unknowns share.

    ``z`` (8,); ``apart`` (8, 8): by order and number.
    """
    t = coarse.shape[1] - 1
    for k in range(used):
        z[2 * k] = z[2 * k + 1] = coarse[first + k, t]
    for order in range(1, 2 * used):
        for j in range(order, 2 * used):
            apart[order, j] = 1.0 / (z[j] - z[j - order])


@compiled
def _differences(coarse, first, used, unknown, rate, apart, c):  # type: ignore[no-untyped-def]
    """Newton's divided differences through nodes with their derivatives, (8,)."""
    for k in range(used):
        c[2 * k] = c[2 * k + 1] = coarse[first + k, unknown]
    for order in range(1, 2 * used):
        for j in range(2 * used - 1, order - 1, -1):
            if order == 1 and j % 2 == 1:
                c[j] = coarse[first + j // 2, rate]
            else:
                c[j] = (c[j] - c[j - 1]) * apart[order, j]


@compiled
def _polynomial(w, target, t, begin, end, order, z, c):  # type: ignore[no-untyped-def]
    """Newton's polynomial at the values of some lanes."""
    value = c[order - 1]
    for i in range(begin, end):
        w[target, i] = value
    for j in range(order - 2, -1, -1):
        value, place = c[j], z[j]
        for i in range(begin, end):
            w[target, i] = w[target, i] * (w[t, i] - place) + value


@compiled
def _set_rows(topology, w, rows, first, lanes, coarse, count, interval, unknowns, room):  # type: ignore[no-untyped-def]
    """Predict rows in the lanes; the interval of the last one.

    ``coarse`` is in the order of rising t. The prediction goes to role 2, which has all the weight;
    role 1 is the nearest node. ``room`` (10, 8).
    """
    nodes = topology.nodes
    size = nodes.shape[1]
    t, used = nodes[0, size - 1], min(NODES, count)
    z, c, apart = room[0], room[1], room[2:]
    begin = 0
    while begin < lanes:
        while interval < count - 2 and rows[first + begin] > coarse[interval + 1, size - 1]:
            interval += 1
        end = begin + 1
        while end < lanes and rows[first + end] <= coarse[interval + 1, size - 1]:
            end += 1
        last = LANES if end == lanes else end  # lanes behind the last row do as that one
        for i in range(begin, last):
            w[t, i] = rows[first + min(i, lanes - 1)]
        middle = 0.5 * (coarse[interval, size - 1] + coarse[interval + 1, size - 1])
        for j in range(size):
            low, high, target = coarse[interval, j], coarse[interval + 1, j], nodes[1, j]
            for i in range(begin, last):
                w[target, i] = low if w[t, i] <= middle else high
        base = min(max(interval - 1, 0), count - used)
        _spaced(coarse, base, used, z, apart)
        for k in range(unknowns):
            _differences(coarse, base, used, k, unknowns + k, apart, c)
            _polynomial(w, nodes[2, k], t, begin, last, 2 * used, z, c)
        begin = end
    return interval


@compiled
def _all_good(topology, w, lanes):  # type: ignore[no-untyped-def]
    good, bad = topology.noted[GOOD], 0
    for i in range(lanes):
        bad += not w[good, i] > 0.5
    return bad == 0


@compiled
def _scouted(scout, w, start, table, coarse):  # type: ignore[no-untyped-def]
    """Nodes (K, S) in rising order from the first row to the last; how many, 0 for failure."""
    rows = table.rows
    size = coarse.shape[1]
    coarse[0] = start
    below = above = 0
    if rows[0] < start[size - 1]:
        below = _one_way(scout, w, rows[0], table.steps, coarse)
        if below < 0:
            return 0
        for k in range((below + 1) // 2):
            for j in range(size):
                coarse[k, j], coarse[below - k, j] = coarse[below - k, j], coarse[k, j]
    if rows[-1] > start[size - 1]:
        above = _one_way(scout, w, rows[-1], table.steps, coarse[below:])
        if above < 0:
            return 0
    return below + above + 1


@compiled
def _grid(first, start, last, step, t):  # type: ignore[no-untyped-def]
    """Values of t from the first to the last one, the start among them; how many, and which."""
    below, above = math.ceil((start - first) / step), math.ceil((last - start) / step)
    below, above = max(below, 0), max(above, 0)
    for k in range(below):
        t[k] = first + (start - first) * k / below
    t[below] = start
    for k in range(above):
        t[below + 1 + k] = start + (last - start) * (k + 1) / above
    return below + above + 1, below


@compiled
def _linked(topology, w, first, lanes, start, place, n, before):  # type: ignore[no-untyped-def]
    """Prove every node from the one before it; whether that is done.

    While that one's error is not known it is taken to be ``_FAR``, and looked at afterwards.
    ``place``: the lane of the start, whose position is known. ``before`` (S,): the node before the
    first lane, unless that is the ``first`` one of all.
    """
    nodes = topology.nodes
    size = nodes.shape[1]
    if 0 <= place < lanes:
        for k in range(n):
            w[nodes[0, k], place] = start[k]
    for k in range(n + 1):
        j = k if k < n else size - 1
        own, last = nodes[0, j], nodes[1, j]
        w[last, 0] = before[j] if first else w[own, 0]
        for i in range(1, LANES):
            w[last, i] = w[own, i - 1]
    for k in range(n):
        error, size_k = nodes[1, 2 * n + k], 0.0
        for i in range(lanes):
            size_k = max(size_k, abs(w[nodes[0, k], i]))
        w[error, :] = _FAR * max(size_k, 1e-300)
        if first and not before[2 * n + k] <= w[error, 0]:
            return False
    judged(topology, 0, w, LANES)
    for k in range(n):
        for i in range(lanes):
            if not w[nodes[0, 2 * n + k], i] <= w[nodes[1, 2 * n + k], i]:
                return False
    return _all_good(topology, w, lanes)


@compiled
def _refined(topology, w, start, table, step, coarse, count, fine):  # type: ignore[no-untyped-def]
    """Finer nodes (K, S) in rising order between coarse ones; how many, 0 for failure."""
    n, size = table.unknowns, topology.nodes.shape[1]
    begin, t = start[size - 1], np.empty(len(fine))
    low, high = min(table.rows[0], begin), max(table.rows[-1], begin)
    if not (high - low) / step < len(fine) - 4:
        return 0
    many, own = _grid(low, begin, high, step, t)
    standing, work, interval = np.ones(LANES), np.empty((2 + _ORDER, _ORDER)), 0
    for first in range(0, many, LANES):
        lanes = min(LANES, many - first)
        interval = _set_rows(topology, w, t, first, lanes, coarse, count, interval, n, work)
        settled(topology, 0, w, standing, False, LANES)
        before = fine[max(first - 1, 0)]
        if proved(topology):
            if not _linked(topology, w, first, lanes, start, own - first, n, before):
                return 0
        elif not _all_good(topology, w, lanes):
            return 0
        for j in range(size):
            source = topology.nodes[0, j]
            for i in range(lanes):
                fine[first + i, j] = w[source, i]
    return many


@compiled
def _kept(topology, w, begin, end, row, unknowns, found):  # type: ignore[no-untyped-def]
    """Some lanes are rows, the first of them that one."""
    radius, m = topology.noted[RADIUS], found.first
    for j in range(unknowns):
        source = topology.nodes[0, j]
        for i in range(begin, end):
            found.unknowns[j, row + i - begin, m] = w[source, i]
    if found.radius.shape[0]:
        for i in range(begin, end):
            found.radius[row + i - begin, m] = w[radius, i]
    for i in range(begin, end):
        found.reached[row + i - begin, m] = True


@compiled
def _near_each_other(rows, gap):  # type: ignore[no-untyped-def]
    widest = 0.0
    for k in range(len(rows) - 1):
        widest = max(widest, rows[k + 1] - rows[k])
    return widest <= gap


@compiled
def _chained(topology, w, start, table, coarse, count, found):  # type: ignore[no-untyped-def]
    """Rows predicted between coarse nodes, each proved from its neighbour; whether all are.

    The start is a link of the chain: a row, or one more.
    """
    rows, n, size = table.rows, table.unknowns, topology.nodes.shape[1]
    own = np.searchsorted(rows, start[size - 1])
    more = own == len(rows) or rows[own] != start[size - 1]
    t = np.empty(len(rows) + more)
    t[:own], t[own + more :], t[own] = rows[:own], rows[own:], start[size - 1]
    standing, work, interval = np.ones(LANES), np.empty((2 + _ORDER, _ORDER)), 0
    before = start.copy()
    for first in range(0, len(t), LANES):
        lanes, place = min(LANES, len(t) - first), own - first
        interval = _set_rows(topology, w, t, first, lanes, coarse, count, interval, n, work)
        settled(topology, 0, w, standing, False, LANES)
        if not _linked(topology, w, first, lanes, start, place, n, before):
            return False
        for j in range(size):
            before[j] = w[topology.nodes[0, j], lanes - 1]
        if more and 0 <= place < lanes:
            _kept(topology, w, 0, place, first, n, found)
            _kept(topology, w, place + 1, lanes, own, n, found)
        else:
            _kept(topology, w, 0, lanes, first - (more and place < 0), n, found)
    return True


@compiled
def _between(topology, w, table, nodes, count, found):  # type: ignore[no-untyped-def]
    """Rows predicted between nodes, each judged from the nearest; whether all are good."""
    rows, n = table.rows, table.unknowns
    standing, work, interval = np.ones(LANES), np.empty((2 + _ORDER, _ORDER)), 0
    for first in range(0, len(rows), LANES):
        lanes = min(LANES, len(rows) - first)
        interval = _set_rows(topology, w, rows, first, lanes, nodes, count, interval, n, work)
        settled(topology, 0, w, standing, False, LANES)
        if not _all_good(topology, w, lanes):
            return False
        _kept(topology, w, 0, lanes, first, n, found)
    return True


@compiled_for(
    types.boolean(
        TOPOLOGY, TOPOLOGY, types.Array(types.float64, 2, "C"), types.Array(types.float64, 2, "C"),
        types.Array(types.float64, 1, "C"), TABLE, types.Array(types.float64, 3, "C"), FOUND,
    )
)  # fmt: skip
def by_rows(topology, scout, w, own, node, table, room, found):  # type: ignore[no-untyped-def]
    """One mechanism through all rows.

    Parameters
    ----------
    topology : Topology
    scout : Topology
        The same equations without proofs.
    w, own : (registers, LANES)
        Workspaces of the two with constants, options and coefficients in place.
    node : (S,)
        Where it starts.
    table : Table
    room : (3, K, S)
        For nodes.
    found : Found
        The column ``first`` is filled.

    Returns
    -------
    bool
        Whether every row is found; else nothing counts.
    """
    rows, n, size = table.rows, table.unknowns, topology.nodes.shape[1]
    small = scout.nodes.shape[1]
    start = np.zeros(small)
    start[: 2 * n], start[small - 1] = node[: 2 * n], node[size - 1]
    seen = room[0, :, :small].copy()
    count = _scouted(scout, own, start, table, seen)
    if count < 2:
        return False
    coarse, fine = room[1], room[2]
    for k in range(count):
        coarse[k, : 2 * n], coarse[k, size - 1] = seen[k, : 2 * n], seen[k, small - 1]
        if proved(topology):
            coarse[k, 2 * n : size - 1] = 0.0  # no error is known
        else:
            coarse[k, 2 * n : size - 1] = seen[k, 2 * n : size - 1]  # the sign of det J
    for j in range(len(topology.weights)):
        w[topology.weights[j], :] = 1.0 if j == 2 else 0.0  # role 2 is the prediction
    step = COARSE * table.steps[1]
    if len(rows) < _FEW * count:  # another correction costs less than finer nodes
        if not proved(topology):
            return _between(topology, w, table, coarse, count, found)
        near = _near_each_other(rows, 0.5 * step)
        if near and _chained(topology, w, node, table, coarse, count, found):
            return True
    for _ in range(3):
        many = _refined(topology, w, node, table, step, coarse, count, fine)
        if many >= 2:
            return _between(topology, w, table, fine, many, found)
        step *= 0.5
    return False
