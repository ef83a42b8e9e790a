"""How a march predicts and steps: the same for lanes and for the threads of a graphics card."""

from __future__ import annotations

from linkwork.foundation.arrays import Array
from linkwork.kernels.program.compiling import njit_no_refcount

__all__ = ["GROWTH", "SAME", "START_STEPS", "STEPS", "hermite", "trusted"]

STEPS = 6  # of Newton-Raphson for one block of a trial
START_STEPS = 50  # likewise, from a guess
GROWTH = 2.0  # of steps that are taken
SAME = 1e-9  # relative: steps so nearly equal share the weights of their prediction
_FAR = 2.5  # times the step before: further ahead fewer nodes are trusted


@njit_no_refcount
def trusted(t: float, times: Array, known: int) -> int:
    """How many of the ``known`` last nodes, at ``times`` (4,), predict well at t."""
    step, used = abs(t - times[0]), min(known, len(times))
    for k in range(len(times) - 1, 0, -1):
        if used > k and step > _FAR * abs(times[k - 1] - times[k]):
            used = k
    return used


@njit_no_refcount
def hermite(t: float, times: Array, i: int, count: int) -> tuple[float, float]:
    """Weights at t of the i-th of ``count`` nodes' value and derivative in Hermite's polynomial."""
    basis, slope = 1.0, 0.0
    for j in range(len(times)):
        if j < count and j != i:
            basis *= (t - times[j]) / (times[i] - times[j])
            slope += 1.0 / (times[i] - times[j])
    square = basis * basis
    return (1.0 - 2.0 * slope * (t - times[i])) * square, (t - times[i]) * square
