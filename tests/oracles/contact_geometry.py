"""Contacts seen from geometry alone: material points in contact move alike, outlines touch."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import linkwork as lw
from linkwork.core.mechanism.linkage import Linkage

__all__ = ["Seen", "gap_of_face", "gap_of_point"]

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


class Seen:
    """A motion as places, directions and their rates by the input, in radians."""

    def __init__(self, mechanism: lw.Mechanism, motion: lw.Motion) -> None:
        assert isinstance(mechanism.description, Linkage)
        self.linkage, self.motion = mechanism.description, motion

    def at(self, point: str) -> Complex:
        x, y = self.motion.points[point]
        return np.asarray(x.value + 1j * y.value)

    def rate(self, point: str) -> Complex:
        x, y = self.motion.points[point]
        return np.asarray(x.first + 1j * y.first)

    def angle(self, link: str) -> Array:
        if link == "ground":
            return np.zeros(len(self.motion))
        return np.asarray(np.radians(self.motion.links[link].value))

    def spin(self, link: str) -> Array:
        if link == "ground":
            return np.zeros(len(self.motion))
        return np.asarray(self.motion.links[link].first)

    def carried(self, link: str, center: str, place: Complex) -> Complex:
        """The velocity of the link's material that is at a place just now."""
        return self.rate(center) + 1j * self.spin(link) * (place - self.at(center))


def gap_of_point(outline: Complex, points: Complex) -> Array:
    """The distance of every point (K,) from the nearest place of an outline (K, N)."""
    return np.asarray(np.abs(outline - points[:, None]).min(axis=1))


def gap_of_face(outline: Complex, point: Complex, direction: Complex, inside: Complex) -> Array:
    """How far the outline (K, N) is from the line through a point, on the side of ``inside``."""
    away = ((outline - point[:, None]) * direction.conj()[:, None]).imag
    side = np.sign(((inside - point) * direction.conj()).imag)
    return np.asarray((side[:, None] * away).min(axis=1))
