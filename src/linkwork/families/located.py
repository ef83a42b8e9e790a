"""Extremes between the rows of designs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray, solutions
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.model import leading_input
from linkwork.core.results.quantities.definition import Asked, AskedOfMotion, Group
from linkwork.core.results.quantity import Kind
from linkwork.families.building import Designs
from linkwork.families.design_sweep import DesignRows, design_rows, single_motion, with_table
from linkwork.families.located_extremes import Peaks, highest_values, parts_of, peaks_of, step_of
from linkwork.families.values import DesignValues, design_efforts, design_rates, design_speeds

# ----------------------------------------------------------------------
# Extremes of a quantity between the rows of many designs.
#
# Polynomials through the rows next to the highest ones have the same extreme where rows are close.
# Elsewhere they say where the design is solved once more, in place of the farthest row.


# ----------------------------------------------------------------------
# Numbers of the motions of many designs, whose extremes are located between their rows.


_NEWTON_STEPS = 8
_LAST = 1e-8  # weighted: a step that leaves an error of its square
_REACH = 1.0  # weighted, in addition to the change over two rows
_MOVED = 0.1  # weighted: further from the row's parabola a position may be on another branch


def located_number(
    designs: Designs, rows: DesignRows, asked: AskedOfMotion, value: Array, threads: int
) -> Array:
    """A number (D,) that follows from the values of a quantity (D, R) alone."""
    model, (sides, of) = designs.base, (asked.quantity.sides, asked.of)
    lead = leading_input(model.rows)[0]
    at = model.rows[:, lead]
    if not sides or of.group in (Group.EVIDENCE, Group.INPUT) or len(at) < 3:
        return asked.evaluate(at, value)
    step, found = step_of(at, asked.names.inputs[asked.names.lead]), []
    for side in sides:
        extreme: Array = (np.fmax if side > 0.0 else np.fmin).reduce(value, axis=1)
        peaks, best = peaks_of(value, extreme, side, step), side * extreme
        alone = rows.alone[peaks.design]
        word = "max" if side > 0.0 else "min"
        for k in np.unique(peaks.design[alone]).tolist():
            best[k] = side * single_motion(designs, k, rows).value(f"{word}({of.name})")
        own = peaks.take(~alone)

        def solve(which: IndexArray, t: Array, own: Peaks = own, side: float = side) -> Array:
            lanes, row = own.design[which], own.row[which]
            beside = _rows_beside(designs, rows, lanes, row, t - at[row])
            return side * _values(designs.take(lanes), beside, of, threads)

        if len(own.design):
            np.maximum.at(best, own.design, highest_values(own, at, value, side, solve))
        found.append(best)
    return np.asarray(sides[0] * found[0] if len(sides) == 1 else found[0] + found[1])


def _values(designs: Designs, rows: DesignRows, of: Asked, threads: int) -> Array:
    """A quantity of designs (L,) in one row each."""
    assert rows.inputs is not None
    if of.group is Group.DERIVED and of.rate is None:
        efforts = design_efforts(designs, rows, of.name, threads)
        if efforts is not None:
            return np.asarray(efforts[0])
    inputs = rows.inputs / designs.base.input_scale[:, None]
    rates = design_rates(designs, rows, threads) if of.needs else None
    values = DesignValues(designs, inputs, rows.v, rows.turns, rates)
    return np.asarray(of.values(values, design_speeds(designs) if of.needs else None)[0])


def _equations(designs: Designs, lanes: IndexArray, v: Array) -> tuple[Array, Array]:
    """F (L, m) and dF/dv of designs (L,) at variables (L, N)."""
    table = designs.base.compiled.table
    value, slope = table.residual_and_jacobian(v)
    own, by_v = table.loops.value_and_jacobian(v, designs.loops[lanes])
    loops = table.loops.rows
    value[:, : 2 * loops] = np.concatenate([own.real, own.imag], axis=1)
    slope[:, : 2 * loops] = np.concatenate([by_v.real, by_v.imag], axis=1)
    value[:, 2 * loops :] += designs.linear[lanes] - table.linear.constant
    return value, slope


@np.errstate(all="ignore")
def _rows_beside(
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
    v = np.concatenate([guess, inputs], axis=1)
    for _ in range(_NEWTON_STEPS):
        value, slope = _equations(designs, lanes, v)
        step = solutions(slope[:, :, :n], value[:, :, None])[:, :, 0]
        v[:, :n] -= step
        size = np.abs(step / table.variable_scale[:n]).max(axis=1)
        if not (size > _LAST).any():
            break
    known = np.concatenate([rows.v[:, row, lanes].T, inputs - away[:, None] * rate], axis=1)
    signs = [
        np.linalg.slogdet(np.nan_to_num(_equations(designs, lanes, x)[1][:, :, :n]))[0]
        for x in (v, known)
    ]
    scale, change = table.variable_scale[:n], np.nan_to_num(np.abs(after - before))
    moved = np.abs((v[:, :n] - guess) / scale).max(axis=1)
    good = (size <= _LAST) & (moved <= _MOVED) & (signs[0] == signs[1])
    # on another turn it would be farther
    good &= (np.abs(v[:, :n] - known[:, :n]) <= _REACH * scale + change).all(axis=1)
    found = DesignRows.blank(n, 1, len(lanes), certify=False, falling=False)
    found.v[:, 0] = np.where(good[:, None], v[:, :n], np.nan).T
    found.status[0] = np.where(good, Status.CONVERGED.code, Status.LOST.code)
    found.certification[:] = Certification.NOT_ASKED.code
    return DesignRows(**{**vars(found), "inputs": inputs.T[None]})


# ----------------------------------------------------------------------
# The rows of designs, so close that the extremes of smooth quantities show in them.


def closer_rows(designs: Designs, rows: DesignRows, threads: int) -> tuple[Designs, DesignRows]:
    """Designs and their rows; where rows are too far apart, those of a table between them."""
    base = designs.base
    if len(base.rows) < 2:
        return designs, rows
    lead = leading_input(base.rows)[0]
    parts = parts_of(base.rows[:, lead], Kind(base.equations.inputs[lead].kind))
    if parts < 2:
        return designs, rows
    designs = replace(designs, base=with_table(base, base, parts))
    return designs, design_rows(designs, certify=False, threads=threads)
