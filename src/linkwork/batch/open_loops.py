"""Designs whose loops cannot close at the start, told from lengths alone."""

from __future__ import annotations

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.foundation.arrays import BoolArray

__all__ = ["stay_open"]

_SURE = 1e-6  # of the longest link: far more than a solver leaves of a closed loop


def stay_open(designs: Designs) -> BoolArray:
    """Whether a loop of a design lacks length to close at the inputs of its start, (D,).

    The terms of a loop are sides of a polygon; those that only inputs turn, or the same unknowns,
    form one side. No polygon has a side longer than all others together.
    """
    loops, n = designs.base.compiled.table.loops, designs.base.compiled.table.unknowns
    weights = loops.weight_matrix
    vectors = designs.loops * np.exp(1j * (designs.start[:, n:] @ weights[n:]))
    found = np.zeros(len(designs), dtype=bool)
    for row in range(loops.rows):
        terms = np.flatnonzero(loops.row == row)
        # a sliding length can be as long as it must be
        if (loops.length[terms] >= 0).any():
            continue
        _, side = np.unique(weights[:n, terms], axis=1, return_inverse=True)
        sums = vectors[:, terms] @ (side.ravel()[:, None] == np.arange(side.max() + 1))
        lengths = np.abs(sums)
        lack = 2.0 * lengths.max(axis=1) - lengths.sum(axis=1)
        found |= lack > _SURE * designs.length_scale
    return found
