"""The length of the path of a point over a motion.

L = ∫ |F'| du, by Gauss' rule with five points between neighbouring rows, where F is the quintic
through places and both derivatives there. A motion adds rows until its steps are short enough.
Where a derivative is missing, as at a dead point, the chord is used; a missing row adds nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array
from linkwork.foundation.rounding import EPSILON
from linkwork.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    Places,
    RowSlopes,
    cubic,
)
from linkwork.results.quantities.extreme_places import NOWHERE, joined_places

__all__ = ["PATH_LENGTH"]

_POINTS = 5  # of Gauss' rule
_EXACT = 1e-13  # of the length
_ORDERS = 7.0 / 5.0  # of the error of a step by the quintic, to that by the cubic of the derivative
_ROUNDING = 64.0  # of places, in the length of a step
_AT_ONCE = 48  # steps that are halved, the worst ones: next to dead points there are more and more
_SHORT = 1e-4  # of the length: chords next to a dead point


def _length(rows: MotionRows, _: tuple[float, ...]) -> Array:
    chord = np.abs(np.diff(rows.value, axis=-1))
    total = _parts(rows)[0]
    parts = np.where(np.isfinite(total), total, chord)
    found: Array = np.where(np.isfinite(chord).any(axis=-1), np.nansum(parts, axis=-1), np.nan)
    return found


def _ends(rows: MotionRows) -> tuple[AnyArray, ...]:
    """Rise, slopes and bends at both ends of steps, by the part of a step, (…, R - 1) each."""
    step = np.diff(rows.input)
    first, second = step * rows.first[..., :-1], step * rows.first[..., 1:]
    bends = step**2 * rows.second[..., :-1], step**2 * rows.second[..., 1:]
    return (np.diff(rows.value, axis=-1), first, second, *bends)


def _weights(s: float) -> tuple[float, ...]:
    """What :func:`_ends` add to the derivative of the quintic at a part of a step, eq. (20)."""
    return (
        30.0 * s**2 * (1.0 - s) ** 2,
        1.0 + s**2 * (-18.0 + s * (32.0 - 15.0 * s)),
        s**2 * (-12.0 + s * (28.0 - 15.0 * s)),
        s * (1.0 + s * (-4.5 + s * (6.0 - 2.5 * s))),
        s**2 * (1.5 + s * (-4.0 + 2.5 * s)),
    )


def _gauss(points: int = _POINTS) -> Any:
    places, weights = np.polynomial.legendre.leggauss(points)
    return zip(0.5 * (1.0 + places), 0.5 * weights, strict=True)


def _parts(rows: MotionRows) -> tuple[Array, Array]:
    """The lengths of steps, and how far those by a point less and the cubic of F' are."""
    # eq. (62), by Gauss points in each step
    ends = _ends(rows)
    total, other = np.zeros(ends[0].shape), np.zeros(ends[0].shape)
    for s, weight in _gauss():
        total += weight * np.abs(sum(w * x for w, x in zip(_weights(s), ends, strict=True)))
    for s, weight in _gauss(_POINTS - 1):
        other += weight * np.abs(cubic(s, (ends[1], ends[2]), (ends[3], ends[4])))
    return total, np.abs(total - other)


def _slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    """Derivatives of the length, row by row."""
    step, ends = np.diff(rows.input), _ends(rows)
    value, first, second = (np.zeros(len(rows.value), dtype=complex) for _ in range(3))
    smooth = np.isfinite(sum(ends))
    for s, weight in _gauss():
        weights = _weights(s)
        rate = sum(w * x for w, x in zip(weights, ends, strict=True))
        unit = weight * np.where(smooth, rate / np.abs(rate), 0.0)
        value[1:] += weights[0] * unit
        value[:-1] -= weights[0] * unit
        for shift in (0, 1):
            at = slice(shift, len(first) - 1 + shift)
            first[at] += weights[1 + shift] * step * unit
            second[at] += weights[3 + shift] * step**2 * unit
    chord = np.diff(rows.value)
    away = np.where(smooth | np.isnan(chord), 0.0, chord / np.abs(chord))
    value[1:] += away
    value[:-1] -= away
    return RowSlopes(value=value, first=first, second=second)


def _places(rows: MotionRows, _: tuple[float, ...]) -> Places:
    """The middles of steps that are too long, and places close to dead points."""
    if rows.joined is None:
        return NOWHERE
    part, missed = _parts(rows)
    chord = np.abs(np.diff(rows.value))
    whole = np.nansum(chord)
    with np.errstate(all="ignore"):
        # where the path turns back neither rule is of its order
        back = (rows.first[:-1] * rows.first[1:].conj()).real <= 0.0
        error = np.where(back, part, part * (missed / part) ** _ORDERS)
        rounding = _ROUNDING * EPSILON * np.nanmax(np.abs(rows.value))
        inexact = (error * len(part) > _EXACT * whole) & (back | (missed > rounding))
        worst = np.where(rows.joined & inexact, error, 0.0)
        long = np.argsort(-worst, kind="stable")[: min(_AT_ONCE, np.count_nonzero(worst))]
        near = rows.joined & ~np.isfinite(part) & (chord > _SHORT * whole)
    row = np.flatnonzero(near)
    # the end without rates is the dead point
    ahead = np.where(np.isfinite(rows.first[row]), 0.875, 0.125)
    return joined_places((long, np.full(len(long), 0.5)), (row, ahead))


PATH_LENGTH = (
    MotionQuantity(
        word="path_length",
        about="length of the point's path",
        evaluate=_length,
        of_point=True,
        needs=2,
        slopes=_slopes,
        places=_places,
    ),
)
