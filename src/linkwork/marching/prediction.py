"""Predictions of a march: the polynomial through the last nodes and their derivatives."""

from __future__ import annotations

from linkwork.foundation.arrays import Array

__all__ = ["FAR", "SAME", "hermite_weights", "is_same_spacing", "keep_spacing", "trusted_nodes"]

SAME = 1e-9  # relative: steps so nearly equal share the weights of their prediction
FAR = 2.5  # times the step before: beyond this distance fewer nodes are trusted


def trusted_nodes(t: float, times: Array, known: int) -> int:
    """The number of the ``known`` last nodes, at ``times`` (K,), that predict well at t."""
    step, used = abs(t - times[0]), min(known, len(times))
    for k in range(len(times) - 1, 0, -1):
        # a polynomial far outside its nodes is worse than one through fewer of them
        if used > k and step > FAR * abs(times[k - 1] - times[k]):
            used = k
    return used


def hermite_weights(t: float, times: Array, i: int, count: int) -> tuple[float, float]:
    """Weights at t of the i-th of ``count`` nodes' value and derivative in Hermite's polynomial.

    With the Lagrange basis L_i these are (1 - 2 (t - t_i) L_i'(t_i)) L_i² and (t - t_i) L_i².
    """
    basis, slope = 1.0, 0.0
    for j in range(len(times)):
        if j < count and j != i:
            basis *= (t - times[j]) / (times[i] - times[j])
            slope += 1.0 / (times[i] - times[j])
    square = basis * basis  # eq. (18)
    return (1.0 - 2.0 * slope * (t - times[i])) * square, (t - times[i]) * square


def is_same_spacing(step: float, times: Array, spacing: Array) -> bool:
    """Whether the step and the distances between nodes at ``times`` (K,) equal ``spacing`` (K,)."""
    near = SAME * abs(step)
    # "not <=" instead of ">": a spacing of NaN or infinity equals no other one
    other = int(not abs(step - spacing[0]) <= near)
    for k in range(1, len(times)):
        other += not abs(times[k - 1] - times[k] - spacing[k]) <= near
    return other == 0


def keep_spacing(step: float, times: Array, spacing: Array) -> None:
    """Store in ``spacing`` (K,) the step and the distances between nodes at ``times`` (K,)."""
    spacing[0] = step
    for k in range(1, len(times)):
        spacing[k] = times[k - 1] - times[k]
