"""The verbs of marching, compiled for lanes, and the bounds of a kernel's iterations."""

from __future__ import annotations

from linkwork.kernels.program.compiling import uncounted
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
START_STEPS = 50  # likewise, from a guess

aim = uncounted(step_size.aim)
stride = uncounted(step_size.stride)
is_lost = uncounted(step_size.is_lost)
grow = uncounted(step_size.grow)
trusted_nodes = uncounted(prediction.trusted_nodes)
hermite_weights = uncounted(prediction.hermite_weights)
is_same_spacing = uncounted(prediction.is_same_spacing)
keep_spacing = uncounted(prediction.keep_spacing)
