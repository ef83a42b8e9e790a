"""The wishes of a task in numbers: radians, lengths, and complex points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from linkwork.design.loops.travel import Range
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

_LEAST = 1e-300  # in place of 0, of which no multiple is large

__all__ = ["Wishes", "distances_to_segments"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Wishes:
    """What a design must satisfy over its whole motion.

    Parameters
    ----------
    ordered : bool
        Whether the positions are passed in their order.
    range : Range, optional
        The driven range; by default from the first position to the last.
    beyond : float
        How far the range by default reaches before the first and behind the last position [rad].
    transmission : float
        The smallest transmission angle allowed [rad].
    region : (K,) complex
        The corners of the polygon that contains the fixed pivots; none: anywhere [length].
    shortest, longest, ratio : float
        Bounds of all lengths, and of the longest over the shortest.
    obstacles : (M, 3)
        Circles x, y, radius, which no link may meet [length].
    points, reach : (N,) complex, (N,)
        The wanted points, and how far each may be missed; none: not asked here [length].
    """

    ordered: bool = True
    range: Range | None = None
    beyond: float = 0.0
    transmission: float = 0.0
    region: ComplexArray = field(default_factory=lambda: np.zeros(0, dtype=complex))
    shortest: float = 0.0
    longest: float = np.inf
    ratio: float = np.inf
    obstacles: Array = field(default_factory=lambda: np.zeros((0, 3)))
    points: ComplexArray = field(default_factory=lambda: np.zeros(0, dtype=complex))
    reach: Array = field(default_factory=lambda: np.zeros(0))

    def allows(self, shortest: Array, longest: Array) -> BoolArray:
        """Whether lengths (D,) are within the bounds."""
        return np.asarray(
            (shortest >= self.shortest)
            & (longest <= self.longest)
            # a ratio of infinity allows a length of zero
            & (longest <= self.ratio * np.maximum(shortest, _LEAST))
        )

    def exceeds(self, guided: ComplexArray, error: Array) -> BoolArray:
        """Which positions of guided points (D, N) miss theirs by more than allowed, beyond errors
        (D,).
        """
        if not self.reach.size:
            return np.zeros(guided.shape, dtype=bool)
        away = np.abs(guided - self.points)
        rounding = 8.0 * UNIT_ROUNDOFF * np.abs(guided)
        return np.asarray(~(away <= self.reach + rounding + error[:, None]))

    def within_region(self, points: ComplexArray, error: Array) -> BoolArray:
        """Whether points (D,) are inside the region, or on its border to their errors."""
        if not self.region.size:
            return np.ones(len(points), dtype=bool)
        start, end = self.region, np.roll(self.region, -1)
        z = points[:, None]
        # a ray to the right crosses the border an odd number of times from inside
        spans = (start.imag > z.imag) != (end.imag > z.imag)
        with np.errstate(all="ignore"):
            along = (z.imag - start.imag) / (end.imag - start.imag)
            crosses = spans & (z.real < start.real + along * (end.real - start.real))
        inside = crosses.sum(axis=1) % 2 == 1
        return np.asarray(inside | (distances_to_segments(z, start, end).min(axis=1) <= error))


def distances_to_segments(z: ComplexArray, start: ComplexArray, end: ComplexArray) -> Array:
    """The distances of points from segments; all broadcast."""
    along = end - start
    square = along.real**2 + along.imag**2
    part = (z - start) * along.conj()
    with np.errstate(all="ignore"):
        share = np.where(square > 0, part.real / square, 0.0)
    return np.asarray(np.abs(z - start - np.clip(share, 0.0, 1.0) * along))
