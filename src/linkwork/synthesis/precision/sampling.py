"""Points inside a polygon from points of the unit square, in equal shares of its area.

Corners cut a polygon into level strips, in each of which its width is linear. A first share chooses
the strip and the height in it by area, a second one the place along the width.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.errors import InputError
from linkwork.synthesis.precision.positions import GivenLength, PrecisionPositions
from linkwork.synthesis.precision.problem import CONDITIONS


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
    points = np.zeros(len(shares), dtype=complex)
    for k, (first, second) in enumerate(shares):
        area = first * parts[-1]
        n = min(int(np.searchsorted(parts, area, side="right")) - 1, len(strips) - 1)
        share = (area - parts[n]) / (parts[n + 1] - parts[n])
        w0, w1 = width[n]
        # the height below which this share of the strip lies
        height = share * (w0 + w1) / (w0 + np.sqrt(w0**2 + share * (w1**2 - w0**2)) or 1.0)
        below, above, left, right = strips[n]
        x = left + height * (right - left)
        points[k] = _along(x, second) + 1j * (below + height * (above - below))
    return points


def _along(ends: Array, share: float) -> float:
    """The place at a share of the intervals between every two ends."""
    widths = np.maximum(ends[1::2] - ends[::2], 0.0)
    length = np.concatenate([[0.0], np.cumsum(widths)])
    n = min(int(np.searchsorted(length, share * length[-1], side="right")) - 1, len(widths) - 1)
    return float(ends[2 * n] + share * length[-1] - length[n])


# ----------------------------------------------------------------------
# Positions that leave freedoms: the missing conditions are drawn at random, task by task.
#
# A fixed pivot takes two conditions, and is drawn first; further points take the rest,
# drawn between positions of the task.


_PIVOTS = 2.0  # times the task's size: the spread of drawn fixed pivots about its centre
_POINTS = 0.2  # and that of drawn points about the way from one position to the next


def positions_with_samples(
    points: ComplexArray,
    angles: Array,
    pivots: ComplexArray,
    samples: int,
    rng: np.random.Generator,
    region: ComplexArray | None = None,
    lengths: Sequence[GivenLength] = (),
) -> Iterator[PrecisionPositions]:
    """Tasks with eight conditions: one if the task gives eight, else ``samples`` without the
    lengths.

    Parameters
    ----------
    points : (J,) complex
        The traced point in the positions [length].
    angles : (J,)
        The coupler's angles [rad], NaN where they are free.
    pivots : (0, 1 or 2,) complex
        Given fixed pivots [length].
    samples : int
    rng : numpy.random.Generator
    region : (K,) complex, optional
        Corners of the rectangle's diagonal, or of a polygon, around drawn pivots [length].
    lengths : sequence of GivenLength, optional

    Raises
    ------
    InputError
        For positions that are equal, too many conditions, or poses alone.
    """
    missing = _missing(points, angles, pivots)
    if missing == len(lengths):
        yield PrecisionPositions.of(points, angles, pivots, lengths)
        return
    drawn = min(2 - len(pivots), missing // 2)
    extra = missing - 2 * drawn
    size = float(np.abs(points - points.mean()).max())
    for _ in range(samples):
        # the centre of a normal distribution, unless there is a region
        z = points.mean() + _PIVOTS * size * rng.normal(size=(drawn, 2)) @ [1.0, 1.0j]
        if region is not None and len(region):
            z = points_in_polygon(_polygon(region), rng.uniform(size=(drawn, 2)))
        before = rng.integers(0, max(1, len(points) - 1), extra)
        way = points[(before + 1) % len(points)] - points[before]
        off = _POINTS * size * rng.normal(size=(extra, 2)) @ [1.0, 1.0j]
        more = points[before] + rng.uniform(size=extra) * way + off
        positions = PrecisionPositions.of(
            np.concatenate([points, more]),
            np.concatenate([angles, np.full(extra, np.nan)]),
            np.concatenate([pivots, z]),
        )
        yield replace(positions, listed=len(points))


def _polygon(region: ComplexArray) -> ComplexArray:
    """The corners of a region; of a rectangle two opposite ones are given."""
    if len(region) != 2:
        return region
    one, other = region
    corners = [one, complex(other.real, one.imag), other, complex(one.real, other.imag)]
    return np.array(corners)


def _missing(points: ComplexArray, angles: Array, pivots: ComplexArray) -> int:
    """How many conditions the positions leave."""
    poses = int((~np.isnan(angles)).sum())
    if len(points) < 2 or len(np.unique(points[np.isnan(angles)])) < len(points) - poses:
        raise InputError("a four-bar needs at least two positions, and points that differ")
    if poses == len(points):
        raise InputError("positions that all have an angle are met by dyads: give a point as well")
    posed, free = max(poses - 1, 0), len(points) - max(poses, 1)
    conditions = 2 * posed + free + 2 * len(pivots)
    if conditions > CONDITIONS:
        raise InputError(
            f"a four-bar meets at most {CONDITIONS} conditions, these are {conditions}: a pose "
            "after the first position and a fixed pivot are two, a point is one"
        )
    return CONDITIONS - conditions
