"""The four common points of two conics, complex ones included, for many pairs at once."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.rounding import EPSILON

__all__ = ["common_points", "quartic_roots"]

_MOST_STEPS = 60  # of Weierstrass's iteration: double roots converge linearly
_POLISHES = 4  # Newton steps: quadratic from the four or more digits of a root
# a start that is no root of unity, and not symmetric to the real axis
_START = 0.7 + 0.5j


def common_points(first: Array, second: Array) -> ComplexArray:
    """The points where two conics meet.

    Parameters
    ----------
    first, second : (B, 3, 3)
        Symmetric matrices: a conic is yᵀ Q y = 0.

    Returns
    -------
    (B, 4, 3) complex
        Of length 1. Where points coincide, or conics share a line, several are the same, or no
        points at all: check them.
    """
    a1, b1, c1 = _in_last_but_one(first)
    a2, b2, c2 = _in_last_but_one(second)
    # eq. (142): the resultant of two quadratics in t, whose coefficients are polynomials in s
    ab, ac = a1 * b2 - a2 * b1, a1 * c2 - a2 * c1
    bc = _times(b1, c2) - _times(b2, c1)
    s = quartic_roots(_times(ac, ac) - _times(ab, bc))
    values = [_value(polynomial, s) for polynomial in (ab, ac)]
    with np.errstate(divide="ignore", invalid="ignore"):
        y = np.stack([s, -values[1] / values[0], np.ones_like(s)], axis=-1)
        y /= np.linalg.norm(y, axis=-1, keepdims=True)
    y = np.where(np.isfinite(y).all(axis=-1, keepdims=True), y, 0.6)
    for _ in range(_POLISHES):
        y = _improved(y, first[:, None], second[:, None])
    return y


def _in_last_but_one(conic: Array) -> tuple[Array, Array, Array]:
    """The coefficients of t², t, 1 for y = (s, t, 1), as polynomials in s: (B, 1), (B, 2), (B, 3),
    highest power first.
    """
    q = conic
    linear = np.stack([2.0 * q[:, 0, 1], 2.0 * q[:, 1, 2]], axis=-1)
    constant = np.stack([q[:, 0, 0], 2.0 * q[:, 0, 2], q[:, 2, 2]], axis=-1)
    return q[:, 1, 1][:, None], linear, constant


def _times(a: Array, b: Array) -> Array:
    """Products of polynomials (B, m), (B, n)."""
    product = np.zeros((len(a), a.shape[1] + b.shape[1] - 1))
    for k in range(a.shape[1]):
        product[:, k : k + b.shape[1]] += a[:, k, None] * b
    return product


def _value(polynomial: Array, s: ComplexArray) -> ComplexArray:
    total = np.zeros_like(s)
    for k in range(polynomial.shape[1]):
        total = total * s + polynomial[:, k, None]
    return total


def quartic_roots(coefficients: Array) -> ComplexArray:
    """The roots (B, 4) of polynomials (B, 5), highest power first: Weierstrass's iteration.

    A leading coefficient of zero gives roots that are not finite or far off.
    """
    with np.errstate(all="ignore"):
        monic = coefficients[:, 1:] / coefficients[:, :1]
        # roots are scaled to about 1: the largest is at most twice this
        size = np.max(np.abs(monic) ** (1.0 / np.arange(1, 5)), axis=1)[:, None]
        size = np.where(size > 0, size, 1.0)
        scaled = monic / size ** np.arange(1, 5)
        roots = np.broadcast_to(_START ** np.arange(4), (len(monic), 4)).copy()
        for _ in range(_MOST_STEPS):
            value = np.ones_like(roots)
            for k in range(4):
                value = value * roots + scaled[:, k, None]
            others = np.ones_like(roots)
            for k in range(1, 4):
                others = others * (roots - np.roll(roots, k, axis=1))
            step = np.where(others != 0, value / others, 0.0)
            roots = roots - step
            if not (np.abs(step) > 4.0 * EPSILON).any():
                break
        return roots * size


def _improved(y: ComplexArray, first: Array, second: Array) -> ComplexArray:
    """One Newton step (B, 4, 3) on both conics, across y."""
    p, q = (first @ y[..., None])[..., 0], (second @ y[..., None])[..., 0]
    f = np.sum(y * p, axis=-1), np.sum(y * q, axis=-1)
    # eq. (143): the change z with 2 p·z = -f0, 2 q·z = -f1, ȳ·z = 0, by Cramer's rule
    n = y.conj()
    pq = np.cross(p, q)
    with np.errstate(all="ignore"):
        numerator = f[0][..., None] * np.cross(q, n) + f[1][..., None] * np.cross(n, p)
        step = -0.5 * numerator / np.sum(pq * n, axis=-1)[..., None]
    moved = y + np.where(np.isfinite(step), step, 0.0)
    size = np.linalg.norm(moved, axis=-1, keepdims=True)
    return np.asarray(moved / size)
