"""Many mechanisms along one path of inputs: every lane follows a mechanism of its own.

A lane tries steps of its own size from row to row of the table, upwards from the guess's input and
then downwards; when it is done, or cannot go on, it takes the next mechanism. So no lane waits for
another, whatever their trouble.
"""

from __future__ import annotations

import math

import numpy as np

from linkwork.kernels.lanes.machine import LANES, compiled, compiled_for, run

__all__ = ["PREDICT", "begin", "march"]

_START_STEPS = 50
_STEPS = 6
_GROWTH = 2.0
# where a program stands in the packed code
PREDICT, JUDGE, TAKE, STAND, BLOCKS = 0, 1, 2, 3, 4
# registers every lane program has
T, T1, T0, ACTIVE, GOOD, FIRST, RADIUS = 0, 1, 2, 3, 4, 5, 6


@compiled
def _one(code, spans, w, number):  # type: ignore[no-untyped-def]
    at = spans[number]
    run(code[at[0] : at[1]], w)


@compiled
def _solve(code, spans, w, first, then, live, most):  # type: ignore[no-untyped-def]
    """Newton-Raphson block by block; programs ``first + b`` once, then ``then + b``."""
    for b in range(len(live)):
        _one(code, spans, w, first + b)
        for _ in range(most - 1):
            open_ = 0.0
            for i in range(LANES):
                open_ += w[live[b], i]
            if open_ == 0.0:
                break
            _one(code, spans, w, then + b)


@compiled
def _prove(code, spans, w, blocks):  # type: ignore[no-untyped-def]
    for b in range(BLOCKS + 3 * blocks, len(spans)):
        _one(code, spans, w, b)


@compiled
def _restart(w, lane, common, h, first):  # type: ignore[no-untyped-def]
    w[common[T0], lane] = w[common[T1], lane]
    w[common[FIRST], lane] = 1.0
    h[lane] = first


@compiled
def _load(w, lane, registers, data, member):  # type: ignore[no-untyped-def]
    for j in range(len(registers)):
        w[registers[j], lane] = data[j, member]


@compiled
def begin(code, spans, w, common, live, coefficients, design, guesses, guess, state, node, found):  # type: ignore[no-untyped-def]
    """Solve every mechanism at its guess's input value.

    Parameters
    ----------
    code, spans : all programs in one array; where each begins and ends.
    w : (registers, LANES) workspace with constants and options in place
    common : registers of t, t1, t0, active, good, first, radius
    live : (B,) registers of the blocks' masks
    coefficients, design : (C,) registers and (C, M) what they hold
    guesses, guess : (G,) registers of the last node and the time there, and (G, M)
    state, node : (S,) registers of a node and (S, M) what they hold afterwards
    found : (M,) bool, set
    """
    count = guess.shape[1]
    blocks = len(live)
    for base in range(0, count, LANES):
        for lane in range(LANES):
            member = min(base + lane, count - 1)
            _load(w, lane, coefficients, design, member)
            _load(w, lane, guesses, guess, member)
            w[common[T], lane] = w[common[T1], lane]
            w[common[T0], lane] = w[common[T1], lane]
            w[common[FIRST], lane] = 1.0
            w[common[ACTIVE], lane] = 1.0
        _one(code, spans, w, PREDICT)
        _solve(code, spans, w, BLOCKS + blocks, BLOCKS + blocks, live, _START_STEPS)
        _one(code, spans, w, STAND)
        if len(spans) > BLOCKS + 3 * blocks:
            _prove(code, spans, w, blocks)
            _one(code, spans, w, STAND)  # with the error of the position that was just proved
            _prove(code, spans, w, blocks)
            _one(code, spans, w, JUDGE)
        else:
            w[common[GOOD], :] = 1.0
        for lane in range(min(LANES, count - base)):
            member = base + lane
            fine = w[common[GOOD], lane] > 0.5
            for b in range(blocks):
                fine &= w[live[b], lane] == 0.0
            for j in range(len(state)):
                node[j, member] = w[state[j], lane]
                fine &= math.isfinite(node[j, member])
            found[member] = fine


@compiled_for(
    "void(uint32[:,::1], int64[:,::1], float64[:,::1], int64[::1], int64[::1], int64[::1],"
    "float64[:,::1], int64[::1], float64[:,::1], boolean[::1], float64[::1], float64[::1],"
    "int64[::1], float64[:,:,:], float64[:,:], boolean[:,:], float64[:,:], float64[:,:,:])"
)
def march(  # type: ignore[no-untyped-def]
    code,
    spans,
    w,
    common,
    live,
    coefficients,
    design,
    state,
    node,
    found,
    rows,
    steps,
    unknowns,
    out,
    radius,
    reached,
    end,
    last,
):
    """Follow every mechanism from its start through the rows of the table.

    Parameters
    ----------
    rows : (R,) increasing values of t
    steps : first, largest and smallest step
    unknowns, out : (n,) registers and (n, R, M) their values
    radius : (R, M), (0, M) without proofs
    reached : (R, M) bool, set
    end : (2, M) where a mechanism could go no further: the value of t last reached, NaN where it
        went through all rows; downwards, then upwards
    last : (2, S, M) the node there

    See :func:`begin` for the others.
    """
    count, blocks = design.shape[1], len(live)
    t, t1, good = common[T], common[T1], common[GOOD]
    member = np.full(LANES, -1)
    row = np.zeros(LANES, np.int64)
    way = np.zeros(LANES, np.int64)
    h = np.zeros(LANES)
    following = 0
    busy = LANES
    for i in range(LANES):
        w[common[ACTIVE], i] = 0.0
        member[i] = -2  # to be given work
    while busy > 0:
        for i in range(LANES):
            while member[i] == -2 or (member[i] >= 0 and (row[i] < 0 or row[i] >= len(rows))):
                if member[i] >= 0 and way[i] == 1:
                    way[i] = 0
                else:
                    while following < count and not found[following]:
                        following += 1
                    if following == count:
                        member[i] = -1
                        w[common[ACTIVE], i] = 0.0
                        busy -= 1
                        break
                    member[i] = following
                    following += 1
                    way[i] = 1
                    _load(w, i, coefficients, design, member[i])
                    w[common[ACTIVE], i] = 1.0
                _load(w, i, state, node, member[i])
                _restart(w, i, common, h, steps[0])
                above = np.searchsorted(rows, w[t1, i])
                row[i] = above if way[i] == 1 else above - 1
        if busy <= 0:
            break
        for i in range(LANES):
            if member[i] >= 0:
                away = rows[row[i]] - w[t1, i]
                w[t, i] = (
                    rows[row[i]] if abs(away) <= h[i] else w[t1, i] + math.copysign(h[i], away)
                )
        _one(code, spans, w, PREDICT)
        _solve(code, spans, w, BLOCKS, BLOCKS + 2 * blocks, live, _STEPS)
        _prove(code, spans, w, blocks)
        _one(code, spans, w, JUDGE)
        for i in range(LANES):
            m = member[i]
            if m < 0:
                continue
            still = w[t, i] == w[t1, i] and w[t, i] != rows[row[i]]  # a step lost in rounding
            if w[good, i] > 0.5 and not still:
                if w[t, i] == rows[row[i]]:
                    r = row[i]
                    reached[r, m] = True
                    for j in range(len(unknowns)):
                        out[j, r, m] = w[unknowns[j], i]
                    if radius.shape[0]:
                        radius[r, m] = w[common[RADIUS], i]
                    row[i] += 2 * way[i] - 1
                    if abs(w[t, i] - w[t1, i]) >= 0.5 * h[i]:
                        h[i] = min(_GROWTH * h[i], steps[1])
                else:
                    h[i] = min(_GROWTH * h[i], steps[1])
            else:
                h[i] = 0.5 * abs(w[t, i] - w[t1, i])
                if h[i] < steps[2]:
                    end[way[i], m] = w[t1, i]
                    for j in range(len(state)):
                        last[way[i], j, m] = w[state[j], i]
                    row[i] = len(rows) if way[i] == 1 else -1
        _one(code, spans, w, TAKE)
