"""Positions of designs close to rows of theirs, each at an input of its own."""

from __future__ import annotations

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.batch.rows import DesignRows
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.stacked_systems import solutions
from linkwork.foundation.status import Status
from linkwork.motion.leading_input import leading_input

__all__ = ["rows_beside"]

_NEWTON_STEPS = 8
_LAST = 1e-8  # weighted: a step that leaves an error of its square
_MOVED = 0.1  # weighted: further from the row's parabola a position may be on another branch


@np.errstate(all="ignore")
def rows_beside(
    designs: Designs, rows: DesignRows, lanes: IndexArray, row: IndexArray, away: Array
) -> DesignRows:
    """One row of designs (L,), inputs ``away`` (L,) from their rows (L,), within a step of them.

    Newton-Raphson from the parabola through three rows; a position with another sign of det J, or
    far from the parabola, counts as none.
    """
    model, n = designs.base, len(rows.v)
    table, (lead, rate) = model.compiled.table, leading_input(model.rows)
    middle = np.clip(row, 1, len(model.rows) - 2)
    t = model.rows[:, lead]
    begin = t[row] + FULL_TURN * rows.turns[row, lanes]
    # a straight line through the table: the inputs follow the leading one
    inputs = model.rows[0] + (begin + away - t[0])[:, None] * rate
    before, here, after = (rows.v[:, middle + k, lanes].T for k in (-1, 0, 1))
    s = ((t[row] + away - t[middle]) / (t[middle + 1] - t[middle]))[:, None]
    guess = here + 0.5 * s * (after - before) + 0.5 * s**2 * (after + before - 2.0 * here)
    guess = np.where(np.isfinite(guess), guess, rows.v[:, row, lanes].T)
    own = designs.loops[lanes], designs.linear[lanes]
    v = np.concatenate([guess, inputs], axis=1)
    for _ in range(_NEWTON_STEPS):
        value, slope = table.residual_and_jacobian(v, *own)
        step = solutions(slope[:, :, :n], value[:, :, None])[:, :, 0]
        v[:, :n] -= step
        size = np.abs(step / table.variable_scale[:n]).max(axis=1)
        if not (size > _LAST).any():
            break
    known = np.concatenate([rows.v[:, row, lanes].T, inputs - away[:, None] * rate], axis=1)
    signs = [
        np.linalg.slogdet(np.nan_to_num(table.residual_and_jacobian(x, *own)[1][:, :, :n]))[0]
        for x in (v, known)
    ]
    moved = np.abs((v[:, :n] - guess) / table.variable_scale[:n]).max(axis=1)
    good = (size <= _LAST) & (moved <= _MOVED) & (signs[0] == signs[1])
    found = DesignRows.blank(n, 1, len(lanes), certify=False, falling=False)
    found.v[:, 0] = np.where(good[:, None], v[:, :n], np.nan).T
    found.status[0] = np.where(good, Status.CONVERGED.code, Status.LOST.code)
    found.certification[:] = Certification.NOT_ASKED.code
    return DesignRows(**{**vars(found), "inputs": inputs.T[None]})
