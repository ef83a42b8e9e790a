"""The stroke of a quantity: how far it moves between its smallest and its largest value."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    RowSlopes,
    at_extreme,
)

__all__ = ["STROKE"]


def _stroke(rows: MotionRows, _: tuple[float, ...]) -> Array:
    found: Array = np.fmax.reduce(rows.value, axis=-1) - np.fmin.reduce(rows.value, axis=-1)
    return found


def _slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    return RowSlopes(value=at_extreme(rows, 1.0) - at_extreme(rows, -1.0))


STROKE = (
    MotionQuantity(
        word="stroke", about="largest less smallest value", evaluate=_stroke, slopes=_slopes
    ),
)
