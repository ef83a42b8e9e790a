"""The largest value of polynomials through neighbouring values of many functions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    EQUAL_ROWS,
    Array,
    BoolArray,
    IndexArray,
    solutions,
)
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.model import leading_input
from linkwork.core.results.quantities.definition import CLOSE_ROWS, Asked, AskedOfMotion, Group
from linkwork.core.results.quantity import Kind
from linkwork.families.building import Designs
from linkwork.families.design_sweep import DesignRows, design_rows, single_motion, with_table
from linkwork.families.values import DesignValues, design_efforts, design_rates, design_speeds

_NEWTON = 3
_OTHER = 0.05  # of the term before the last one: terms that shrink more are chance


def interpolated_peaks(
    x: Array, y: Array, low: Array, high: Array, start: Array
) -> tuple[Array, Array, Array]:
    """Where polynomials through values y (L, m) at x (L, m) are largest between two limits.

    Newton-Raphson on the derivative from ``start``; an end of the range where it leads out of that.

    Returns
    -------
    t, value, term : (L,) each
        Places, values there, and what the last point adds to them at most.
    """
    differences = list(y.T)
    for k in range(1, len(differences)):
        for j in reversed(range(k, len(differences))):
            change = differences[j] - differences[j - 1]
            differences[j] = change / (x[:, j] - x[:, j - k])
    t = start
    for _ in range(_NEWTON):
        value, first, second = (np.zeros(len(t)) for _ in range(3))
        for k in reversed(range(x.shape[1])):  # Horner, with both derivatives
            away = t - x[:, k]
            second = second * away + 2.0 * first
            first = first * away + value
            value = value * away + differences[k]
        change = np.where(second < 0.0, -first / second, np.where(first > 0.0, high, low) - t)
        t = np.clip(np.where(np.isnan(change), t, t + change), low, high)
    value, product = np.zeros(len(t)), np.ones(len(t))
    for k in reversed(range(x.shape[1])):
        value = value * (t - x[:, k]) + differences[k]
    for k in range(x.shape[1] - 1):
        before = product
        # close to a point the value is exact, the place is not
        product = product * np.maximum(np.abs(t - x[:, k]), 0.25 * (high - low))
    # next to a symmetric extreme every other one is small
    term = np.maximum(np.abs(differences[-1]) * product, _OTHER * np.abs(differences[-2]) * before)
    return t, value, term


def lagrange_weights(x: Array, t: Array) -> Array:
    """The weights (L, m) of values at x (L, m) in their polynomials at t (L,)."""
    away = t[:, None] - x
    gaps = x[:, :, None] - x[:, None, :]
    here = np.eye(x.shape[1], dtype=bool)
    others = np.where(here, 1.0, np.broadcast_to(away[:, None, :], gaps.shape))
    return np.asarray(others.prod(axis=2) / np.where(here, 1.0, gaps).prod(axis=2))


# ----------------------------------------------------------------------
# Extremes between the rows of many designs, by the polynomials through neighbouring rows.


_ROWS = 9  # of a polynomial


_PASSES = 80


_BOLD = 4  # passes that solve where polynomials are largest, before steps are halved


_SURE = 40  # passes after which values beyond _POLE belong to a pole


_SOME = 24


_POLE = 1e3  # times the values of rows: unless it is exact, there is a pole and no extreme


_SHARP = 2.0  # of the range of values: how much an extreme may bend per step squared


_EXACT = 1e-12  # of the values: what the last row adds, ten times what the next one would


_ROUNDED = 1e-11  # the same at a place that is solved: values are rounded


_SAME_PLACE = 1e-6  # of a step: a place so near to a solved one has the same value to rounding


@dataclass(frozen=True, kw_only=True, eq=False)
class Peaks:
    """Rows (L,) of designs (L,) next to which the largest value of the design may lie.

    ``window`` (L, m): the rows around each.
    """

    design: IndexArray
    row: IndexArray
    window: IndexArray

    def take(self, which: IndexArray | BoolArray) -> Peaks:
        """Some of them."""
        return Peaks(design=self.design[which], row=self.row[which], window=self.window[which])


def step_of(at: Array, kind: Kind) -> float:
    """The largest step between inputs (R,), in radians or parts of their range."""
    step = float(np.abs(np.diff(at)).max())
    return step if kind is Kind.ANGLE else step / (float(np.ptp(at)) or 1.0)


def parts_of(at: Array, kind: Kind) -> int:
    """Into how many parts the steps between inputs (R,) are divided to show all extremes."""
    whole = FULL_TURN if kind is Kind.ANGLE else 1.0
    return max(1, math.ceil(step_of(at, kind) * CLOSE_ROWS / whole - EQUAL_ROWS))


def peaks_of(value: Array, best: Array, side: float, step: float) -> Peaks:
    """The peaks of values (D, R), with a negative side the dips, that may exceed the best (D,).

    ``step``: see :func:`step_of`. Peaks that no row shows are not seen:
    two extremes between neighbouring rows.
    """
    count = value.shape[1]
    size = min(_ROWS, count)
    some = value[:, :: max(1, count // _SOME)]  # about the range
    worst = (np.fmin if side > 0.0 else np.fmax).reduce(some, axis=1)
    margin = min(_SHARP * step**2, 1.0) * (best - worst) + 8.0 * EPSILON * side * np.abs(best)
    # families lie in memory row by row
    high = (best - margin <= value.T) if side > 0.0 else (best - margin >= value.T)
    row, design = np.divmod(np.flatnonzero(high), len(value))
    here, before, after = (side * value[design, np.clip(row + k, 0, count - 1)] for k in (0, -1, 1))
    may = (here >= np.where(np.isnan(before), here, before)) & (
        here >= np.where(np.isnan(after), here, after)
    )
    design, row = design[may], row[may]
    known = np.isfinite(value)
    window, there = np.zeros((len(row), size), dtype=np.intp), np.zeros(len(row), dtype=bool)
    for shift in sorted(range(size), key=lambda k: abs(k - size // 2)):
        left = np.flatnonzero(~there)  # rows next to those without a position are off the middle
        if not len(left):
            break
        window[left] = np.clip(row[left] - shift, 0, count - size)[:, None] + np.arange(size)
        there[left] = known[design[left, None], window[left]].all(axis=1)
    return Peaks(design=design, row=row, window=window).take(there)


def highest_values(
    peaks: Peaks, at: Array, value: Array, side: float, solve: Callable[[IndexArray, Array], Array]
) -> Array:
    """The largest value at every peak, with a negative side less the smallest one, (L,).

    Parameters
    ----------
    at : (R,)
        Increasing or decreasing inputs of the rows.
    value : (D, R)
    solve : callable
        Values times the side at inputs (K,) of peaks by their number (K,), NaN where there is no
        position.
    """
    x, y = at[peaks.window], side * value[peaks.design[:, None], peaks.window]
    step = np.abs(np.diff(at)).min()
    highest, most = y.max(axis=1), _POLE * np.abs(y).max(axis=1)
    left, exact = np.arange(len(x)), np.zeros(len(x), dtype=bool)
    for k in range(_PASSES):
        own, size = x[left], np.abs(y[left]).max(axis=1)
        each, top = np.arange(len(left)), y[left].argmax(axis=1)
        here, best = own[each, top], y[left, top]
        low = np.where(own < here[:, None], own, -np.inf).max(axis=1)
        high = np.where(own > here[:, None], own, np.inf).min(axis=1)
        low, high = np.where(np.isinf(low), here, low), np.where(np.isinf(high), here, high)
        with np.errstate(all="ignore"):
            t, peak, term = interpolated_peaks(own, y[left], low, high, here)
        near = np.abs(t[:, None] - own).min(axis=1) <= _SAME_PLACE * step
        exact[left] = known = term <= np.where(near, _ROUNDED, _EXACT) * size
        highest[left] = np.where(known, np.fmax(peak, best), best)
        # next to a sharp extreme or a pole steps are halved until polynomials are exact
        middle = 0.5 * (here + np.where(high - here > here - low, high, low))
        t = np.where(near | (k >= _BOLD), middle, t)
        open_ones = ~known & ((best <= most[left]) | (k < _SURE))
        open_ones &= np.abs(t - here) > 4.0 * EPSILON * np.abs(here)
        left, t = left[open_ones], t[open_ones]
        found = solve(left, t) if len(left) else t
        good = np.isfinite(found)
        left, t = left[good], t[good]
        if not len(left):
            break
        away = np.abs(x[left] - t[:, None]).argmax(axis=1)
        x[left, away], y[left, away] = t, found[good]
    highest = np.fmax(highest, y.max(axis=1))
    return np.where((highest > most) & ~exact, np.inf, highest)


def interpolated_extremes(
    at: Array, value: Array, sides: Sequence[float], step: float
) -> tuple[Array, Array]:
    """An extreme of values (D, R), or the sum of several with their sides, on the polynomials
    through the rows next to it, (D,); the weights of the rows in it, (D, R).
    """
    numbers, weights = np.zeros(len(value)), np.zeros(value.shape)
    for side in sides:
        row = np.where(np.isnan(value), -np.inf, side * value).argmax(axis=1)
        each = np.arange(len(value))
        number, weight = value[each, row], np.zeros(value.shape)
        weight[each, row] = 1.0
        peaks = peaks_of(value, number, side, step)
        x, y = at[peaks.window], side * value[peaks.design[:, None], peaks.window]
        beside = [at[np.clip(peaks.row + k, 0, len(at) - 1)] for k in (-1, 1)]
        with np.errstate(all="ignore"):
            t, peak, _ = interpolated_peaks(x, y, np.minimum(*beside), np.maximum(*beside),
                                            at[peaks.row])  # fmt: skip
        order = np.lexsort((peak, peaks.design))
        # the highest peak of each design
        last = order[np.diff(peaks.design[order], append=len(value)) > 0]
        own = peaks.take(last)
        number[own.design], weight[own.design] = side * peak[last], 0.0
        weight[own.design[:, None], own.window] = lagrange_weights(x[last], t[last])
        factor = side if len(sides) > 1 else 1.0
        numbers, weights = numbers + factor * number, weights + factor * weight
    return numbers, weights


# ----------------------------------------------------------------------
# Extremes between the rows of designs.


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
