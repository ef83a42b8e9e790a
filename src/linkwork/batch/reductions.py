"""Reductions: one number per design from the values of a quantity at all rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from linkwork.foundation.arrays import Array

__all__ = ["REDUCTIONS"]


def _least(values: Array) -> Array:
    found: Array = np.fmin.reduce(values, axis=1)
    return found


def _most(values: Array) -> Array:
    found: Array = np.fmax.reduce(values, axis=1)
    return found


def _mean(values: Array) -> Array:
    there = ~np.isnan(values)
    with np.errstate(invalid="ignore"):
        mean: Array = np.where(there, values, 0.0).sum(axis=1) / there.sum(axis=1)
    return mean


#: By name: from values (D, R), NaN where there is no position, to (D,). NaN where there is none.
REDUCTIONS: Mapping[str, Callable[[Array], Array]] = {
    "min": _least,
    "max": _most,
    "mean": _mean,
    "stroke": lambda values: _most(values) - _least(values),
}
