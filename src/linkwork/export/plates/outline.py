"""Closed outlines of straight lines and circular arcs."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.link_symbols import convex_outline
from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["Outline", "circle", "rounded"]

_FLAT = 1e-12  # bulge below which a side is straight
_ARC = math.tau / 256  # of an arc, in one side of its polygon: 0.01 % of a circle's area


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """A closed counter-clockwise curve: side k leads from corner k to the next one.

    ``corners`` (K,) [mm]; ``bulges`` (K,): the tangent of a quarter of the side's angle, 0 for a
    line, positive for an arc to the left.
    """

    corners: ComplexArray
    bulges: Array

    @property
    def ends(self) -> ComplexArray:
        """The corner at which each side ends."""
        return np.roll(self.corners, -1)

    @property
    def area(self) -> float:
        """The enclosed area [mm²]."""
        chord = np.abs(self.ends - self.corners)
        angle = 4.0 * np.arctan(self.bulges)
        bent = np.abs(self.bulges) > _FLAT
        radius = np.zeros(len(chord))
        radius[bent] = chord[bent] / (2.0 * np.sin(angle[bent] / 2.0))
        segments = 0.5 * radius**2 * (angle - np.sin(angle))
        return float(0.5 * (self.corners.conj() * self.ends).imag.sum() + segments.sum())

    @property
    def as_circle(self) -> tuple[complex, float] | None:
        """Centre and radius, if the outline is a circle."""
        if len(self.corners) != 2 or not np.allclose(self.bulges, 1.0, rtol=0.0, atol=_FLAT):
            return None
        first, second = self.corners.tolist()
        return (first + second) / 2.0, abs(second - first) / 2.0

    def moved(self, origin: complex, turn: complex) -> Outline:
        """The outline turned by the unit vector ``turn`` and moved by ``origin``."""
        return Outline(corners=origin + turn * self.corners, bulges=self.bulges)

    def grown(self, by: float) -> Outline:
        """The parallel curve at the distance ``by`` [mm], outside if positive.

        Exact where sides are tangent to each other; at other corners the tangents are shifted.
        """
        if by == 0.0:
            return self
        quarter = np.exp(2j * np.arctan(self.bulges))
        chord = self.ends - self.corners
        along = chord / np.abs(chord)
        leaving, arriving = along / quarter, np.roll(along * quarter, 1)
        shift = -1j * (leaving + arriving) / (1.0 + (leaving * arriving.conj()).real)
        return Outline(corners=self.corners + by * shift, bulges=self.bulges)

    def polygon(self) -> ComplexArray:
        """Corners of the inscribed polygon, without the repeated first one."""
        parts = []
        for start, end, bulge in zip(self.corners, self.ends, self.bulges, strict=True):
            angle = 4.0 * math.atan(bulge)
            count = max(1, math.ceil(abs(angle) / _ARC)) if abs(bulge) > _FLAT else 1
            if count == 1:
                parts.append(np.array([start]))
                continue
            # the centre is to the left of an arc with a positive bulge
            radius = (end - start) / (2.0 * math.sin(angle / 2.0))
            centre = start + 1j * radius * np.exp(-0.5j * angle)
            parts.append(centre + (start - centre) * np.exp(1j * angle * np.arange(count) / count))
        return np.concatenate(parts)


def circle(center: complex, radius: float) -> Outline:
    """A circle [mm]."""
    return Outline(corners=np.array([center + radius, center - radius]), bulges=np.ones(2))


def rounded(points: Iterable[complex], radius: float) -> Outline:
    """The outline at a distance around the convex hull of points: a bar around two [mm]."""
    hull = convex_outline(points)
    distinct = [z for k, z in enumerate(hull) if k == 0 or z != hull[0]]
    if len(distinct) == 1:
        return circle(distinct[0], radius)
    z = np.array(distinct)
    along = np.roll(z, -1) - z
    along /= np.abs(along)
    before = np.roll(along, 1)
    turn = np.angle(along / before) if len(z) > 2 else np.full(2, math.pi)
    corners = np.stack([z - 1j * radius * before, z - 1j * radius * along], axis=1).ravel()
    bulges = np.stack([np.tan(turn / 4.0), np.zeros(len(z))], axis=1).ravel()
    return Outline(corners=corners, bulges=bulges)
