"""The verbs of marching, compiled for lanes, and the bounds of a kernel's iterations."""

from __future__ import annotations

from linkwork.foundation.arrays import Array
from linkwork.kernels.program.compiling import njit_no_refcount
from linkwork.marching import prediction, step_size

__all__ = [
    "START_STEPS",
    "STEPS",
    "aim",
    "grow",
    "hermite_weights",
    "is_lost",
    "is_same_spacing",
    "keep_spacing",
    "row_from",
    "stride",
    "trusted_nodes",
]

STEPS = 6  # of Newton-Raphson for one block of a trial
START_STEPS = 50  # of Newton-Raphson for one block, from a guess

aim = njit_no_refcount(step_size.aim)
stride = njit_no_refcount(step_size.stride)
is_lost = njit_no_refcount(step_size.is_lost)
grow = njit_no_refcount(step_size.grow)
trusted_nodes = njit_no_refcount(prediction.trusted_nodes)
hermite_weights = njit_no_refcount(prediction.hermite_weights)
is_same_spacing = njit_no_refcount(prediction.is_same_spacing)
keep_spacing = njit_no_refcount(prediction.keep_spacing)


@njit_no_refcount
def row_from(t: float, rows: Array) -> int:
    """The first of the increasing rows that is not below t; how many there are if none is."""
    # NumPy's search would take the compiler a second
    low, high = 0, len(rows)
    while low < high:
        middle = (low + high) // 2
        if rows[middle] < t:
            low = middle + 1
        else:
            high = middle
    return low
