"""Points inside a polygon from points of the unit square, in equal shares of its area.

Corners cut a polygon into level strips, in each of which its width is linear. A first share chooses
the strip and the height in it by area, a second one the place along the width.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["points_in_polygon"]


def points_in_polygon(corners: ComplexArray, shares: Array) -> ComplexArray:
    """Points (D,) for shares (D, 2) from 0 to 1; evenly spread ones give evenly spread points.

    ``corners`` (K,) in order; of sides that cross, every second interval is inside, and the spread
    is even approximately.
    """
    levels = np.unique(corners.imag)
    start, end = corners, np.roll(corners, -1)
    low, high = np.minimum(start.imag, end.imag), np.maximum(start.imag, end.imag)
    strips = []
    for below, above in pairwise(levels):
        sides = (low <= below) & (high >= above) & (low < high)
        one, other = start[sides], end[sides]
        slope = (other.real - one.real) / (other.imag - one.imag)
        at = [one.real + (y - one.imag) * slope for y in (below, above)]
        order = np.argsort(at[0] + at[1], kind="stable")
        strips.append((below, above, at[0][order], at[1][order]))
    widths = [[np.sum(x[1::2] - x[::2]) for x in (left, right)] for _, _, left, right in strips]
    width = np.maximum(np.array(widths), 0.0)
    parts = np.concatenate([[0.0], np.cumsum(width.sum(axis=1) * np.diff(levels))])
    found = np.zeros(len(shares), dtype=complex)
    for k, (first, second) in enumerate(shares):
        wanted = first * parts[-1]
        n = min(int(np.searchsorted(parts, wanted, side="right")) - 1, len(strips) - 1)
        share = (wanted - parts[n]) / (parts[n + 1] - parts[n])
        w0, w1 = width[n]
        # the height below which this share of the strip lies
        height = share * (w0 + w1) / (w0 + np.sqrt(w0**2 + share * (w1**2 - w0**2)) or 1.0)
        below, above, left, right = strips[n]
        x = left + height * (right - left)
        found[k] = _along(x, second) + 1j * (below + height * (above - below))
    return found


def _along(ends: Array, share: float) -> float:
    """The place at a share of the intervals between every two ends."""
    widths = np.maximum(ends[1::2] - ends[::2], 0.0)
    length = np.concatenate([[0.0], np.cumsum(widths)])
    n = min(int(np.searchsorted(length, share * length[-1], side="right")) - 1, len(widths) - 1)
    return float(ends[2 * n] + share * length[-1] - length[n])
