"""The length of the path of a point over the rows of a motion.

L = ∫ |F'| du, by Gauss' rule with four points between neighbouring rows, where F' is the cubic
through its values and slopes there. Where a derivative is missing, as at a dead point, the
chord is used; a missing row adds nothing.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    RowSlopes,
    cubic,
    cubic_weights,
)

__all__ = ["PATH_LENGTH"]

_POINTS = 4  # of Gauss' rule


def _length(rows: MotionRows, _: tuple[float, ...]) -> Array:
    step = np.diff(rows.input)
    begin, end = rows.first[..., :-1], rows.first[..., 1:]
    slopes = step * rows.second[..., :-1], step * rows.second[..., 1:]
    total = np.zeros(begin.shape)
    for place, weight in zip(*np.polynomial.legendre.leggauss(_POINTS), strict=True):
        rate = cubic(0.5 * (1.0 + place), (begin, end), slopes)
        total += 0.5 * weight * np.abs(rate)  # eq. (62)
    chord = np.abs(np.diff(rows.value, axis=-1))
    parts = np.where(np.isfinite(total), total * np.abs(step), chord)
    found: Array = np.where(np.isfinite(chord).any(axis=-1), np.nansum(parts, axis=-1), np.nan)
    return found


def _slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    """Derivatives of eq. (62), row by row."""
    step = np.diff(rows.input)
    begin, end = rows.first[:-1], rows.first[1:]
    bends = step * rows.second[:-1], step * rows.second[1:]
    value, first, second = (np.zeros(len(rows.value), dtype=complex) for _ in range(3))
    smooth = np.isfinite(begin + end + bends[0] + bends[1])
    for place, weight in zip(*np.polynomial.legendre.leggauss(_POINTS), strict=True):
        s = 0.5 * (1.0 + place)
        rate = cubic(s, (begin, end), bends)
        unit = 0.5 * weight * np.abs(step) * np.where(smooth, rate / np.abs(rate), 0.0)
        ends, slopes = cubic_weights(s)
        for shift in (0, 1):
            at = slice(shift, len(first) - 1 + shift)
            first[at] += ends[shift] * unit
            second[at] += slopes[shift] * step * unit
    chord = np.diff(rows.value)
    away = np.where(smooth | np.isnan(chord), 0.0, chord / np.abs(chord))
    value[1:] += away
    value[:-1] -= away
    return RowSlopes(value=value, first=first, second=second)


PATH_LENGTH = (
    MotionQuantity(
        word="path_length",
        about="length of the point's path over the rows found",
        evaluate=_length,
        of_point=True,
        needs=2,
        slopes=_slopes,
    ),
)
