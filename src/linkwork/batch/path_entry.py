"""Move designs whose start is off the table's path of inputs to that path."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from linkwork.batch.designs import Designs
from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF
from linkwork.kernels.march.sweep_kernel import Steps, SweepKernel

__all__ = ["lead_to_rows"]

_CHUNK = 1 << 22  # distances held at a time


def lead_to_rows(
    designs: Designs,
    rows: Array,
    kernel: SweepKernel,
    coefficients: Mapping[str, Array],
    which: IndexArray,
    threads: int,
) -> tuple[Array, IndexArray]:
    """Lead designs from their starts to the nearest row, straight from inputs to inputs.

    Parameters
    ----------
    rows : (R, p)
        Inputs of the table's rows on its path, two or more inputs.
    coefficients : Mapping[str, (D,)]
        By register.
    which : (M,)
        The designs.

    Returns
    -------
    v : (n, M)
        Unknowns at the rows, NaN where the way does not lead there; proved with the kernel's steps.
    nearest : (M,)
        The rows.
    """
    n, count = kernel.table.unknowns, len(which)
    own = designs.start[which, n:]
    nearest = _nearest(designs, rows, which)
    rate = rows[nearest] - own
    given = {name: values[which] for name, values in coefficients.items()}
    for j in range(own.shape[1]):
        given[f"u{j}.origin"], given[f"u{j}.rate"] = own[:, j].copy(), rate[:, j].copy()
        given[f"u{j}.spread"] = 4.0 * UNIT_ROUNDOFF * (np.abs(own[:, j]) + np.abs(rate[:, j]))
    v, radius = np.empty((n, 2, count)), np.empty((2 if kernel.certified else 0, count))
    found = kernel.result(v, radius)
    # each design has a path of its own, from its start (0) to its row (1)
    ends = np.array([0.0, 1.0])
    kernel.run(given, designs.start[which, :n].T, np.zeros(count), ends, Steps(), found, threads)
    return np.where(found.reached[1], v[:, 1], np.nan), nearest


def _nearest(designs: Designs, rows: Array, which: IndexArray) -> IndexArray:
    """The row whose inputs differ least, lengths relative to the longest link, (M,)."""
    n = designs.base.compiled.solver.unknowns
    turns = designs.base.compiled.table.is_angle[n:]
    found = np.empty(len(which), dtype=np.intp)
    # all distances at once would not fit into memory for a million designs
    step = max(1, _CHUNK // rows.size)
    for begin in range(0, len(which), step):
        mine = which[begin : begin + step]
        weights = np.where(turns, 1.0, designs.length_scale[mine, None])
        away = np.abs(rows - designs.start[mine, None, n:]) / weights[:, None, :]
        found[begin : begin + step] = away.max(axis=2).argmin(axis=1)
    return found
