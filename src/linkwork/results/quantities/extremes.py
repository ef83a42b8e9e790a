"""The smallest and largest value of a quantity over a motion, and its mean over the rows."""

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
from linkwork.results.quantities.extreme_places import extreme_places

__all__ = ["EXTREMES"]


def _least(rows: MotionRows, _: tuple[float, ...]) -> Array:
    found: Array = np.fmin.reduce(rows.value, axis=-1)
    return found


def _most(rows: MotionRows, _: tuple[float, ...]) -> Array:
    found: Array = np.fmax.reduce(rows.value, axis=-1)
    return found


def _mean(rows: MotionRows, _: tuple[float, ...]) -> Array:
    there = ~np.isnan(rows.value)
    with np.errstate(invalid="ignore"):
        mean: Array = np.where(there, rows.value, 0.0).sum(axis=-1) / there.sum(axis=-1)
    return mean


def _least_slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    return RowSlopes(value=at_extreme(rows, -1.0))


def _most_slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    return RowSlopes(value=at_extreme(rows, 1.0))


def _mean_slopes(rows: MotionRows, _: tuple[float, ...]) -> RowSlopes:
    there = ~np.isnan(rows.value)
    return RowSlopes(value=there / max(int(there.sum()), 1))


def _least_places(rows: MotionRows, _: tuple[float, ...]) -> Places:
    return extreme_places(rows, -1.0)


def _most_places(rows: MotionRows, _: tuple[float, ...]) -> Places:
    return extreme_places(rows, 1.0)


EXTREMES = (
    MotionQuantity(
        word="min",
        about="smallest value",
        evaluate=_least,
        slopes=_least_slopes,
        places=_least_places,
        sides=(-1.0,),
    ),
    MotionQuantity(
        word="max",
        about="largest value",
        evaluate=_most,
        slopes=_most_slopes,
        places=_most_places,
        sides=(1.0,),
    ),
    MotionQuantity(
        word="mean",
        about="mean of the values at the rows found",
        evaluate=_mean,
        slopes=_mean_slopes,
    ),
)
