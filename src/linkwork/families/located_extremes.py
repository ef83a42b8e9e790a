"""Extremes between the rows of many designs, by the polynomials through neighbouring rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.rounding import EPSILON, EQUAL_ROWS
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.results.quantities.definition import CLOSE_ROWS
from linkwork.core.results.quantity import Kind
from linkwork.families.interpolated_peak import interpolated_peaks, lagrange_weights

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
