"""The largest value of polynomials through neighbouring values of many functions."""

from __future__ import annotations

import numpy as np

from linkwork.core.foundation.arrays import Array

_NEWTON = 3
_OTHER = 0.05  # of the term before the last one: terms that shrink more are chance


def interpolated_peaks(
    x: Array, y: Array, low: Array, high: Array, start: Array
) -> tuple[Array, Array, Array]:
    """Where polynomials through values y (L, m) at x (L, m) are largest between two limits.

    Newton-Raphson on the derivative from ``start``; an end of the range where it leads out of that.

    Returns
    -------
    t, value, term : (L,) each
        Places, values there, and what the last point adds to them at most.
    """
    differences = list(y.T)
    for k in range(1, len(differences)):
        for j in reversed(range(k, len(differences))):
            change = differences[j] - differences[j - 1]
            differences[j] = change / (x[:, j] - x[:, j - k])
    t = start
    for _ in range(_NEWTON):
        value, first, second = (np.zeros(len(t)) for _ in range(3))
        for k in reversed(range(x.shape[1])):  # Horner, with both derivatives
            away = t - x[:, k]
            second = second * away + 2.0 * first
            first = first * away + value
            value = value * away + differences[k]
        change = np.where(second < 0.0, -first / second, np.where(first > 0.0, high, low) - t)
        t = np.clip(np.where(np.isnan(change), t, t + change), low, high)
    value, product = np.zeros(len(t)), np.ones(len(t))
    for k in reversed(range(x.shape[1])):
        value = value * (t - x[:, k]) + differences[k]
    for k in range(x.shape[1] - 1):
        before = product
        # close to a point the value is exact, the place is not
        product = product * np.maximum(np.abs(t - x[:, k]), 0.25 * (high - low))
    # next to a symmetric extreme every other one is small
    term = np.maximum(np.abs(differences[-1]) * product, _OTHER * np.abs(differences[-2]) * before)
    return t, value, term


def lagrange_weights(x: Array, t: Array) -> Array:
    """The weights (L, m) of values at x (L, m) in their polynomials at t (L,)."""
    away = t[:, None] - x
    gaps = x[:, :, None] - x[:, None, :]
    here = np.eye(x.shape[1], dtype=bool)
    others = np.where(here, 1.0, np.broadcast_to(away[:, None, :], gaps.shape))
    return np.asarray(others.prod(axis=2) / np.where(here, 1.0, gaps).prod(axis=2))
