"""The stroke of a quantity: how far it moves between its smallest and its largest value."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.results.quantities.definition import MotionQuantity, MotionRows

__all__ = ["STROKE"]


def _stroke(rows: MotionRows, _: tuple[float, ...]) -> Array:
    found: Array = np.fmax.reduce(rows.value, axis=-1) - np.fmin.reduce(rows.value, axis=-1)
    return found


STROKE = (MotionQuantity(word="stroke", about="largest less smallest value", evaluate=_stroke),)
