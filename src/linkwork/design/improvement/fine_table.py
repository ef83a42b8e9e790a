"""Rows between those of a coarse table, for numbers of a motion that take several rows."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from linkwork.batch.located_extremes import step_of
from linkwork.foundation.arrays import Array
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["fine_table"]

_LARGEST = math.radians(3.0)  # polynomials through nine rows so far apart miss 1e-11 of an extreme


def fine_table(model: Model, motion: Motion, table: Array) -> tuple[Array, Array] | None:
    """Leading inputs (N,) and unknowns (N, n) of the table with further rows between its own.

    ``None`` where the table is fine enough, or is not found as a whole.
    """
    if len(table) < 2 or motion.between is None or not motion.between.joined.all():
        return None
    parts = math.ceil(step_of(table, Kind(model.equations.inputs[0].kind)) / _LARGEST)
    if parts < 2 or motion.added.any():
        return None
    row, part = np.divmod(np.arange((len(table) - 1) * parts), parts)
    at = np.append(table[row] + part / parts * np.diff(table)[row], table[-1])
    inner = np.flatnonzero(part)
    q = np.concatenate([motion.q[row], motion.q[-1:]])
    q[inner] = cast("Motion", motion.between(row[inner], at[inner])).q
    return (at, q) if np.isfinite(q).all() else None
