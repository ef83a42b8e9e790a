"""Many mechanisms along one path of inputs, in lockstep: one row of the table after the other."""

from __future__ import annotations

import numpy as np

from linkwork.kernels.lanes.machine import LANES, compiled, run

__all__ = ["march"]

_START_STEPS = 50
_STEPS = 6


@compiled
def _solve(code, spans, w, first, then, blocks, live, most):  # type: ignore[no-untyped-def]
    """Newton-Raphson block by block; programs ``first + b`` once, then ``then + b``."""
    for b in range(blocks):
        at = spans[first + b]
        run(code[at[0] : at[1]], w)
        at = spans[then + b]
        for _ in range(most - 1):
            open_ = 0.0
            lanes = w[live[b]]
            for i in range(LANES):
                open_ += lanes[i]
            if open_ == 0.0:
                break
            run(code[at[0] : at[1]], w)


@compiled
def march(code, spans, w, rows, start, blocks, names, live, unknowns, out, reached):  # type: ignore[no-untyped-def]
    """Solve LANES mechanisms from their guesses along all rows.

    Parameters
    ----------
    code, spans : programs in one array and where each begins and ends: predict, judge, take,
        stand, keep, back, then for every block begin, damped, iterate.
    w : (registers, LANES)
        Coefficients in their places, guesses in the registers of the last node.
    rows : (R,) increasing values of t. ``start``: the guess's own.
    names : registers of t, t1, active, good, first
    live, unknowns : registers of the blocks' masks, of the unknowns
    out : (n, R, LANES) the unknowns
    reached : (R, LANES) bool
    """
    t, t1, active, good, first = names[0], names[1], names[2], names[3], names[4]
    w[t, :] = start
    w[t1, :] = start
    w[first, :] = 1.0
    _one(code, spans, w, 0)
    _solve(code, spans, w, 6 + blocks, 6 + blocks, blocks, live, _START_STEPS)
    for b in range(blocks):
        for i in range(LANES):
            w[active, i] *= 1.0 - w[live[b], i]
    _one(code, spans, w, 3)
    for b in range(6 + 3 * blocks, len(spans)):
        _one(code, spans, w, b)
    _one(code, spans, w, 3)
    _one(code, spans, w, 4)
    begun = w[active].copy()
    above = np.searchsorted(rows, start)
    for way in range(2):
        if way == 1:
            _one(code, spans, w, 5)
            w[active, :] = begun
        count = len(rows) - above if way == 0 else above
        for k in range(count):
            row = above + k if way == 0 else above - 1 - k
            w[t, :] = rows[row]
            _one(code, spans, w, 0)
            _solve(code, spans, w, 6, 6 + 2 * blocks, blocks, live, _STEPS)
            for b in range(6 + 3 * blocks, len(spans)):
                _one(code, spans, w, b)
            _one(code, spans, w, 1)
            _one(code, spans, w, 2)
            w[active, :] = w[good]
            left = 0.0
            for i in range(LANES):
                reached[row, i] = w[good, i] > 0.5
                left += w[good, i]
            for j in range(len(unknowns)):
                out[j, row] = w[unknowns[j]]
            if left == 0.0:
                break


@compiled
def _one(code, spans, w, number):  # type: ignore[no-untyped-def]
    at = spans[number]
    run(code[at[0] : at[1]], w)
