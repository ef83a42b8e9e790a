"""Positions that leave freedoms: the missing conditions are drawn at random, task by task.

A fixed pivot takes two conditions, and is drawn first; what is left is met by further points, drawn
between positions of the task.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from linkwork.design.precision.polygon_points import points_in_polygon
from linkwork.design.precision.positions import GivenLength, PrecisionPositions
from linkwork.design.precision.problem import CONDITIONS
from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.errors import InputError

__all__ = ["positions_with_samples"]

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
    """Tasks with eight conditions, one if the given ones are that many, else ``samples`` without
    the lengths.

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
        found = PrecisionPositions.of(
            np.concatenate([points, more]),
            np.concatenate([angles, np.full(extra, np.nan)]),
            np.concatenate([pivots, z]),
        )
        yield replace(found, wanted=len(points))


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
    given = 2 * posed + free + 2 * len(pivots)
    if given > CONDITIONS:
        raise InputError(
            f"a four-bar meets at most {CONDITIONS} conditions, these are {given}: a pose after "
            "the first position and a fixed pivot are two, a point is one"
        )
    return CONDITIONS - given
