"""The stroke of a quantity: how far it moves between its smallest and its largest value."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.quantities.definition import (
    MotionQuantity,
    MotionRows,
    Places,
    RowSlopes,
    at_extreme,
)
from linkwork.results.quantities.extreme_places import extreme_places, joined_places

__all__ = ["STROKE"]


def _stroke(rows: MotionRows, _: tuple[float, ...]) -> Array:
    found: Array = np.fmax.reduce(rows.value, axis=-1) - np.fmin.reduce(rows.value, axis=-1)
    return found


def _slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    return RowSlopes(value=at_extreme(rows, 1.0) - at_extreme(rows, -1.0))


def _places(rows: MotionRows, _: tuple[float, ...]) -> Places:
    return joined_places(extreme_places(rows, 1.0), extreme_places(rows, -1.0))


STROKE = (
    MotionQuantity(
        word="stroke",
        about="largest less smallest value",
        evaluate=_stroke,
        slopes=_slopes,
        places=_places,
        sides=(1.0, -1.0),
    ),
)
