"""The verbs of marching, compiled for lanes, and the bounds of a kernel's iterations."""

from __future__ import annotations

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
