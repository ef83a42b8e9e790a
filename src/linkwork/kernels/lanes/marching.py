"""Many mechanisms along one path of inputs: every lane follows a mechanism of its own.

A lane tries steps of its own size from row to row of the table, upwards from the guess's input and
then downwards; when it is done, or cannot go on, it takes the next mechanism. So no lane waits for
another, whatever their trouble.

A lane's trial and its last three nodes have four places; the programs for trial and nodes in all
four turns are at hand, so a step that is taken costs no copying. A lane whose step is not taken has
its nodes moved instead.
"""

from __future__ import annotations

import math

import numpy as np

from linkwork.kernels.lanes.machine import LANES, compiled, compiled_for, run

__all__ = ["begin", "march"]

_START_STEPS = 50
_STEPS = 6
_GROWTH = 2.0
_SAME = 1e-9  # relative: steps so nearly equal share the weights of their prediction
_FAR = 2.5  # times the step before: further ahead fewer nodes are trusted
# where a program stands in the packed code
PREDICT, JUDGE, BLOCKS = 0, 1, 2
# registers that every topology has
GOOD, RADIUS, WEIGHTS = 0, 1, 2


@compiled
def _one(code, spans, w, number):  # type: ignore[no-untyped-def]
    run(code[spans[number, 0] : spans[number, 1]], w)


@compiled
def _iterate(code, spans, w, program, live, most):  # type: ignore[no-untyped-def]
    """Newton-Raphson of one block until no lane iterates."""
    for _ in range(most):
        open_ = 0.0
        for i in range(LANES):
            open_ += w[live, i]
        if open_ == 0.0:
            break
        _one(code, spans, w, program)


@compiled
def _prove(code, spans, w, blocks):  # type: ignore[no-untyped-def]
    for b in range(BLOCKS + 3 * blocks, len(spans)):
        _one(code, spans, w, b)


@compiled
def _load(w, lane, registers, data, member):  # type: ignore[no-untyped-def]
    for j in range(len(registers)):
        w[registers[j], lane] = data[j, member]


@compiled
def _copy(w, lane, to, source):  # type: ignore[no-untyped-def]
    for j in range(len(to)):
        w[to[j], lane] = w[source[j], lane]


@compiled
def _tangent(w, lane, weights, h):  # type: ignore[no-untyped-def]
    """Predict from the last node alone."""
    for j in range(6):
        w[weights[j], lane] = 0.0
    w[weights[0], lane] = 1.0
    w[weights[1], lane] = h


@compiled
def _predict_from(w, lane, weights, t, nodes, count):  # type: ignore[no-untyped-def]
    """The weights of the polynomial through ``count`` nodes with their derivatives, at t."""
    for j in range(6):
        w[weights[j], lane] = 0.0
    for i in range(count):
        basis, slope = 1.0, 0.0
        for j in range(count):
            if j != i:
                basis *= (t - nodes[j]) / (nodes[i] - nodes[j])
                slope += 1.0 / (nodes[i] - nodes[j])
        square = basis * basis
        w[weights[2 * i], lane] = (1.0 - 2.0 * slope * (t - nodes[i])) * square
        w[weights[2 * i + 1], lane] = (t - nodes[i]) * square


@compiled
def begin(code, spans, w, common, live, coefficients, design, nodes, guess, node, found):  # type: ignore[no-untyped-def]
    """Solve every mechanism at its guess's input value.

    Parameters
    ----------
    code, spans : all programs in one array, in the first turn; where each begins and ends
    w : (registers, LANES) workspace with constants and options in place
    common : registers of good, radius, a1, b1, a2, b2, a3, b3
    live : (B,) registers of the blocks' masks
    coefficients, design : (C,) registers and (C, M) what they hold
    nodes : (4, S) registers of positions, the time last
    guess, node : (S, M) the guess, and what is found from there
    found : (M,) bool, set
    """
    count, blocks = design.shape[1], len(live)
    proofs = len(spans) > BLOCKS + 3 * blocks
    good = common[GOOD]
    for base in range(0, count, LANES):
        for lane in range(LANES):
            member = min(base + lane, count - 1)
            _load(w, lane, coefficients, design, member)
            _load(w, lane, nodes[1], guess, member)
            _copy(w, lane, nodes[0], nodes[1])
            _copy(w, lane, nodes[2], nodes[1])
            _copy(w, lane, nodes[3], nodes[1])
            _tangent(w, lane, common[WEIGHTS:], 0.0)
            w[good, lane] = 1.0
        _one(code, spans, w, PREDICT)
        for b in range(blocks):
            w[live[b], :] = 1.0
            _iterate(code, spans, w, BLOCKS + blocks + b, live[b], _START_STEPS)
        if proofs:  # the second time with the error of the position that was just proved
            for _ in range(2):
                for lane in range(LANES):
                    _copy(w, lane, nodes[1], nodes[0])
                _prove(code, spans, w, blocks)
            _one(code, spans, w, JUDGE)
        for lane in range(min(LANES, count - base)):
            member = base + lane
            fine = w[good, lane] > 0.5
            for b in range(blocks):
                fine &= w[live[b], lane] == 0.0
            for j in range(nodes.shape[1]):
                node[j, member] = w[nodes[0, j], lane]
                fine &= math.isfinite(node[j, member])
            found[member] = fine


@compiled_for(
    "void(uint32[:,:,::1], int64[:,::1], float64[:,::1], int64[::1], int64[::1], int64[::1],"
    "float64[:,::1], int64[:,::1], float64[:,::1], boolean[::1], float64[::1], float64[::1],"
    "int64, float64[:,:,:], float64[:,:], boolean[:,:], float64[:,:], float64[:,:,:])"
)
def march(  # type: ignore[no-untyped-def]
    codes, spans, w, common, live, coefficients, design, nodes, node, found,
    rows, steps, unknowns, out, radius, reached, end, last,
):  # fmt: skip
    """Follow every mechanism from its start through the rows of the table.

    Parameters
    ----------
    codes : (4, …) all programs in all four turns
    node, found : (S, M), (M,) the starts
    rows : (R,) increasing values of t
    steps : first, largest and smallest step
    unknowns : how many
    out : (n, R, M) the unknowns
    radius : (R, M), (0, M) without proofs
    reached : (R, M) bool, set
    end : (2, M) where a mechanism could go no further: the value of t last reached, NaN where it
        went through all rows; downwards, then upwards
    last : (2, 2 S, M) the last node there and the one before

    See :func:`begin` for the others.
    """
    count, blocks, size = design.shape[1], len(live), nodes.shape[1]
    good, weights = common[GOOD], common[WEIGHTS:]
    member = np.full(LANES, -2)  # to be given work; -1: there is none
    row = np.zeros(LANES, np.int64)
    way = np.zeros(LANES, np.int64)
    known = np.zeros(LANES, np.int64)  # nodes that a prediction can use
    h = np.zeros(LANES)
    spacing = np.zeros((LANES, 3))  # for which the weights were computed
    times = np.zeros(3)
    following, busy, turn = 0, LANES, 0
    for i in range(LANES):
        for role in range(4):
            for j in range(size):
                w[nodes[role, j], i] = 0.0
    while True:
        code = codes[turn]
        t0, t1 = nodes[-turn % 4, size - 1], nodes[(1 - turn) % 4, size - 1]
        t2, t3 = nodes[(2 - turn) % 4, size - 1], nodes[(3 - turn) % 4, size - 1]
        for i in range(LANES):
            while member[i] == -2 or (member[i] >= 0 and (row[i] < 0 or row[i] >= len(rows))):
                if member[i] >= 0 and way[i] == 1:
                    way[i] = 0
                else:
                    while following < count and not found[following]:
                        following += 1
                    if following == count:
                        member[i] = -1
                        busy -= 1
                        break
                    member[i] = following
                    following += 1
                    way[i] = 1
                    _load(w, i, coefficients, design, member[i])
                for role in range(1, 4):
                    _load(w, i, nodes[(role - turn) % 4], node, member[i])
                known[i] = 1
                spacing[i, :] = np.inf  # like no other
                h[i] = steps[0]
                above = np.searchsorted(rows, w[t1, i])
                row[i] = above if way[i] == 1 else above - 1
            if member[i] < 0:
                continue
            goal = rows[row[i]]
            away = goal - w[t1, i]
            step = away if abs(away) <= h[i] else math.copysign(h[i], away)
            w[t0, i] = goal if abs(away) <= h[i] else w[t1, i] + step
            one, two = w[t1, i] - w[t2, i], w[t2, i] - w[t3, i]
            near = _SAME * abs(step)
            if (
                abs(step - spacing[i, 0]) > near
                or abs(one - spacing[i, 1]) > near
                or abs(two - spacing[i, 2]) > near
            ):
                spacing[i, 0], spacing[i, 1], spacing[i, 2] = step, one, two
                used = known[i]
                if used == 3 and abs(step) > _FAR * abs(two):
                    used = 2
                if used >= 2 and abs(step) > _FAR * abs(one):
                    used = 1
                times[0], times[1], times[2] = w[t1, i], w[t2, i], w[t3, i]
                _predict_from(w, i, weights, w[t0, i], times, used)
        if busy == 0:
            break
        _one(code, spans, w, PREDICT)
        for b in range(blocks):
            _one(code, spans, w, BLOCKS + b)
            _iterate(code, spans, w, BLOCKS + 2 * blocks + b, live[b], _STEPS - 1)
        _prove(code, spans, w, blocks)
        _one(code, spans, w, JUDGE)
        for i in range(LANES):
            m = member[i]
            if m < 0:
                continue
            moved = abs(w[t0, i] - w[t1, i])
            lost = moved == 0.0 and w[t0, i] != rows[row[i]]  # a step lost in rounding
            taken = w[good, i] > 0.5 and not lost
            if taken:
                if w[t0, i] == rows[row[i]]:
                    r = row[i]
                    reached[r, m] = True
                    for j in range(unknowns):
                        out[j, r, m] = w[nodes[-turn % 4, j], i]
                    if radius.shape[0]:
                        radius[r, m] = w[common[RADIUS], i]
                    row[i] += 2 * way[i] - 1
                if moved >= 0.5 * h[i]:
                    h[i] = min(_GROWTH * h[i], steps[1])
                known[i] = min(known[i] + 1, 3)
            else:
                h[i] = 0.5 * moved
                if h[i] < steps[2]:
                    end[way[i], m] = w[t1, i]
                    for j in range(size):
                        last[way[i], j, m] = w[nodes[(1 - turn) % 4, j], i]
                        last[way[i], size + j, m] = w[nodes[(2 - turn) % 4, j], i]
                    row[i] = len(rows) if way[i] == 1 else -1
            if not taken or moved == 0.0:  # the trial is no new node: move the others on
                if taken:
                    known[i] = 1
                for role in range(3):
                    _copy(w, i, nodes[(role - turn) % 4], nodes[(role + 1 - turn) % 4])
        turn = (turn + 1) % 4
