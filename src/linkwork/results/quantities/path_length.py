"""The length of the path of a point over the rows of a motion.

L = ∫ |F'| du, by Gauss' rule with four points between neighbouring rows, where F' is the cubic
through its values and slopes there. Where a derivative is missing, as at a dead point, the
chord is used; a missing row adds nothing.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.quantities.definition import MotionQuantity, MotionRows, cubic

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


PATH_LENGTH = (
    MotionQuantity(
        word="path_length",
        about="length of the point's path over the rows found",
        evaluate=_length,
        of_point=True,
        needs=2,
    ),
)
