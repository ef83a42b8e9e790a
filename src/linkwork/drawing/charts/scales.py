"""Ranges and ticks of axes: angles at fractions of a turn, lengths at round numbers; rounding
errors are not magnified.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from linkwork.drawing.charts.chart import Curve
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.arrays import Array

__all__ = ["across_step", "angle_ends", "finite_ends", "level_ends", "round_step"]

_FINE = tuple(d * 10.0**k for k in range(-6, 0) for d in (1, 2, 5))
_DEGREES = (*_FINE, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0)
_RADIANS = (*_FINE[:-1], *(math.pi / part for part in (12, 6, 4, 2)))
_TURNS = (0.5, *(d * 10.0**k for k in range(9) for d in (1, 2, 5)))
_MOST_STEPS = 5
_MOST_ACROSS = 9
_FREE = 0.1  # of a step: a nearer curve runs along an edge,
_ALONG = 0.1  # if at least this share does, and looks like the edge

_TAIL = 0.1  # of the input's range, excluded at either end of the values of unbounded curves
_LEVEL = 1e-9  # of its size: maximum variation of a constant quantity
_LEVEL_ROOM = 0.1  # of its size: range shown above and below a constant


def _steps(unit: AngleUnit) -> tuple[float, ...]:
    own = _DEGREES if unit is AngleUnit.DEGREE else _RADIANS
    return (*own, *(times * unit.turn for times in _TURNS))


def angle_ends(values: Array, unit: AngleUnit) -> tuple[tuple[float, float], float]:
    """The ends of an axis of angles (which may include NaN), and the distance of its ticks.

    Both are multiples of a round fraction of a turn; a constant angle gets a margin of a degree or
    0.05 rad on either side.
    """
    least, most = float(np.nanmin(values)), float(np.nanmax(values))
    smallest = 0.0
    if most - least <= _LEVEL * unit.turn:
        smallest = 1.0 if unit is AngleUnit.DEGREE else 0.05
        least = most = 0.5 * (least + most)
    found = values[np.isfinite(values)]
    for step in _steps(unit):
        if step < smallest:
            continue
        first, last = math.floor(least / step), math.ceil(most / step)
        first -= _along(found / step - first)
        last += _along(last - found / step)
        if last - first <= _MOST_STEPS:
            return (first * step, last * step), step
    return (least, most), 0.0


def _along(away: Array) -> int:
    """An additional step if a curve runs along an edge; ``away`` [steps] are its distances."""
    return int(float((away < _FREE).mean()) > _ALONG)


def across_step(span: float, unit: AngleUnit) -> float:
    """The distance of ticks along an axis of angles."""
    return next((step for step in _steps(unit) if span <= _MOST_ACROSS * step), 0.0)


def round_step(wanted: float) -> float:
    """``wanted`` rounded up to 1, 2 or 5 times a power of ten."""
    power: float = 10.0 ** math.floor(math.log10(wanted))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= wanted)


def level_ends(values: Array, size: float) -> tuple[float, float] | None:
    """The axis range of a quantity that is constant up to rounding; ``None`` if it varies.

    Parameters
    ----------
    values : array
        May include NaN.
    size : float
        The typical size of the quantity; rounding is a small fraction of it.
    """
    least, most = float(np.nanmin(values)), float(np.nanmax(values))
    size = max(size, abs(least), abs(most))
    if most - least > _LEVEL * size:
        return None
    middle = 0.5 * (least + most)
    if abs(middle) <= _LEVEL * size:
        middle = 0.0
    room = _LEVEL_ROOM * (abs(middle) or size)
    return middle - room, middle + room


def finite_ends(curves: Sequence[Curve]) -> tuple[float, float] | None:
    """The axis range of unbounded curves: twice that over most of the input's range."""
    y = np.concatenate([0.5 * (curve.y[1:] + curve.y[:-1]) for curve in curves])
    share = np.concatenate([np.abs(np.diff(curve.x)) for curve in curves])
    order = np.argsort(y)[: int(np.isfinite(y * share).sum())]
    passed = np.cumsum(share[order])
    if not passed.size or not passed[-1]:
        return None
    low, high = np.interp([_TAIL, 1 - _TAIL], passed / passed[-1], y[order])
    room = 0.5 * (high - low)
    return (float(low - room), float(high + room)) if room else None
