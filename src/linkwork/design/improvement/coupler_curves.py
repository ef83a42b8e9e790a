"""Coupler points of many four-bars and slider-cranks, with derivatives by their dimensions.

Each lane has its own dimensions (P,) and crank angles (N,). The loop A + c e^{iψ} - B closes by a
triangle; its derivatives follow from the loop differentiated once, eq. (153).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, ComplexArray, IndexArray

__all__ = ["CouplerCurves", "FourBarCurves", "LoopPoints", "SliderCrankCurves"]


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopPoints:
    """Moving pivots and the coupler point, (D, N) each; NaN where the loop is open."""

    moving_a: ComplexArray
    moving_b: ComplexArray
    guided: ComplexArray


class CouplerCurves(ABC):
    """One kind of mechanism with a crank at A0; the last two dimensions are P in the coupler.

    Parameters
    ----------
    side : (D,)
        The signs of the loops, 1 or -1.
    """

    #: Dimensions in their order; A0 first.
    names: ClassVar[tuple[str, ...]]
    #: The dimensions that are lengths of links.
    lengths: ClassVar[tuple[int, ...]]

    def __init__(self, side: Array) -> None:
        self.side = side

    def take(self, index: IndexArray) -> Self:
        """Some of the lanes."""
        return type(self)(self.side[index])

    @abstractmethod
    def points(self, x: Array, t: Array) -> LoopPoints:
        """The loop for dimensions (D, P) at crank angles (D, N)."""

    @abstractmethod
    def with_derivatives(
        self, x: Array, t: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """P (D, N), its derivatives by the dimensions (D, N, P) and by the angle (D, N)."""

    @abstractmethod
    def cosines(self, x: Array, t: Array) -> tuple[Array, Array, Array]:
        """The cosine of the transmission angle (D, N), by x (D, N, P) and by the angle (D, N)."""

    @abstractmethod
    def extreme(self, x: Array) -> Array:
        """A crank angle, (D,), at which the cosine of the transmission angle is largest or
        smallest; it is the other one half a turn away, and monotone between both.
        """

    @abstractmethod
    def limits(self, x: Array) -> tuple[Array, Array]:
        """What is positive while the crank cannot turn fully, (D, K), and by x, (D, K, P)."""

    @abstractmethod
    def moved(self, x: Array, shift: ComplexArray, factor: ComplexArray) -> Array:
        """Dimensions turned and enlarged by factors (D,) about 0, then moved; the crank angle
        grows by the angle of the factor.
        """

    @abstractmethod
    def shapes(self, x: Array) -> tuple[Array, ComplexArray]:
        """Lengths (D, K) and directions (D, M) that are the same for the same mechanism with P,
        however its dimensions (D, P) describe it.
        """


class FourBarCurves(CouplerCurves):
    """A0, B0, crank a, coupler c, rocker b, P = A + (p + iq) e^{iψ}."""

    names = ("A0.x", "A0.y", "B0.x", "B0.y", "crank", "coupler", "rocker", "p", "q")
    lengths = (4, 5, 6)

    def points(self, x: Array, t: Array) -> LoopPoints:
        """The loop for dimensions (D, P) at crank angles (D, N)."""
        a, e, _ = self._closed(x, t, np.exp(1j * t))
        z = (x[:, 7] + 1j * x[:, 8])[:, None]
        return LoopPoints(moving_a=a, moving_b=a + x[:, 5, None] * e, guided=a + z * e)

    def _closed(
        self, x: Array, t: Array, u: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """A, the direction of the coupler, and B - B0."""
        a0, b0 = (x[:, 0] + 1j * x[:, 1])[:, None], (x[:, 2] + 1j * x[:, 3])[:, None]
        c, b = x[:, 5, None], x[:, 6, None]
        moving = a0 + x[:, 4, None] * u
        base = b0 - moving
        square = base.real**2 + base.imag**2
        along = 0.5 * (square + c**2 - b**2)
        with np.errstate(all="ignore"):
            across = np.sqrt(square * c**2 - along**2)
            e = base * (along + 1j * self.side[:, None] * across) / (square * c)
        return moving, e, c * e - base

    @np.errstate(all="ignore")  # there are no numbers where the loop is open
    def with_derivatives(
        self, x: Array, t: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """P (D, N), its derivatives by the dimensions (D, N, P) and by the angle (D, N)."""
        u = np.exp(1j * t)
        moving, e, rocker = self._closed(x, t, u)
        a, c, b = (x[:, k, None] for k in (4, 5, 6))
        z = (x[:, 7] + 1j * x[:, 8])[:, None]
        # eq. (153): dψ = (b db - R · (dA - dB0 + e dc)) / (R · i c e)
        turned = 1j * z * e / (c * (rocker.imag * e.real - rocker.real * e.imag))
        by_x = np.empty((*t.shape, 9), dtype=complex)
        by_x[..., 2], by_x[..., 3] = turned * rocker.real, turned * rocker.imag
        by_x[..., 0], by_x[..., 1] = 1.0 - by_x[..., 2], 1j - by_x[..., 3]
        by_x[..., 4] = u - turned * _dot(rocker, u)
        by_x[..., 5] = -turned * _dot(rocker, e)
        by_x[..., 6] = turned * b
        by_x[..., 7], by_x[..., 8] = e, 1j * e
        swing = 1j * a * u
        return moving + z * e, by_x, swing - turned * _dot(rocker, swing)

    @np.errstate(all="ignore")
    def cosines(self, x: Array, t: Array) -> tuple[Array, Array, Array]:
        """(b² + c² - |A - B0|²) / 2bc."""
        u = np.exp(1j * t)
        a, c, b = (x[:, k, None] for k in (4, 5, 6))
        base = (x[:, 2] - x[:, 0] + 1j * (x[:, 3] - x[:, 1]))[:, None] - a * u
        square = base.real**2 + base.imag**2
        cosine = (b**2 + c**2 - square) / (2.0 * b * c)
        by_x = np.zeros((*t.shape, 9))
        by_x[..., 0], by_x[..., 1] = base.real / (b * c), base.imag / (b * c)
        by_x[..., 2], by_x[..., 3] = -by_x[..., 0], -by_x[..., 1]
        by_x[..., 4] = _dot(base, u) / (b * c)
        by_x[..., 5], by_x[..., 6] = 1.0 / b - cosine / c, 1.0 / c - cosine / b
        return cosine, by_x, a * _dot(base, 1j * u) / (b * c)

    def extreme(self, x: Array) -> Array:
        """The direction from A0 to B0."""
        return np.asarray(np.arctan2(x[:, 3] - x[:, 1], x[:, 2] - x[:, 0]))

    def limits(self, x: Array) -> tuple[Array, Array]:
        """g + a - (b + c) and |b - c| - |g - a|, which end the branch, and by x."""
        ground = x[:, 2:4] - x[:, :2]
        g = np.hypot(ground[:, 0], ground[:, 1])
        a, c, b = x[:, 4], x[:, 5], x[:, 6]
        found = np.stack([g + a - (b + c), np.abs(b - c) - np.abs(g - a)], axis=1)
        by_x = np.zeros((*found.shape, 9))
        with np.errstate(all="ignore"):
            along = ground / g[:, None]
        far, near = np.sign(b - c), np.sign(g - a)
        by_x[:, 0, :2], by_x[:, 0, 2:4] = -along, along
        by_x[:, 0, 4], by_x[:, 0, 5], by_x[:, 0, 6] = 1.0, -1.0, -1.0
        by_x[:, 1, :2], by_x[:, 1, 2:4] = near[:, None] * along, -near[:, None] * along
        by_x[:, 1, 4], by_x[:, 1, 5], by_x[:, 1, 6] = near, -far, far
        return found, by_x

    def moved(self, x: Array, shift: ComplexArray, factor: ComplexArray) -> Array:
        """Dimensions turned and enlarged by factors (D,) about 0, then moved."""
        found = np.array(x)
        for k in (0, 2):
            place = shift + factor * (x[:, k] + 1j * x[:, k + 1])
            found[:, k], found[:, k + 1] = place.real, place.imag
        found[:, 4:] *= np.abs(factor)[:, None]
        return found

    def shapes(self, x: Array) -> tuple[Array, ComplexArray]:
        """All dimensions, and the side."""
        return x, self.side[:, None].astype(complex)


class SliderCrankCurves(CouplerCurves):
    """A0, crank a, rod c, offset h and direction φ of B's line, P = A + (p + iq) e^{iψ}."""

    names = ("A0.x", "A0.y", "crank", "coupler", "offset", "direction", "p", "q")
    lengths = (2, 3)

    def points(self, x: Array, t: Array) -> LoopPoints:
        """The loop for dimensions (D, P) at crank angles (D, N)."""
        moving, e = self._closed(x, np.exp(1j * t))
        z = (x[:, 6] + 1j * x[:, 7])[:, None]
        return LoopPoints(
            moving_a=moving, moving_b=moving + x[:, 3, None] * e, guided=moving + z * e
        )

    def _closed(self, x: Array, u: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """A, and the direction of the rod."""
        a, c, h = (x[:, k, None] for k in (2, 3, 4))
        line = np.exp(1j * x[:, 5])[:, None]
        with np.errstate(all="ignore"):
            height = (h - a * (u * line.conj()).imag) / c
            e = line * (self.side[:, None] * np.sqrt(1.0 - height**2) + 1j * height)
        return (x[:, 0] + 1j * x[:, 1])[:, None] + a * u, e

    @np.errstate(all="ignore")  # there are no numbers where the loop is open
    def with_derivatives(
        self, x: Array, t: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """P (D, N), its derivatives by the dimensions (D, N, P) and by the angle (D, N)."""
        u = np.exp(1j * t)
        moving, e = self._closed(x, u)
        a, c = x[:, 2, None], x[:, 3, None]
        z = (x[:, 6] + 1j * x[:, 7])[:, None]
        line = np.exp(1j * x[:, 5])[:, None]
        # eq. (153) with the normal of the line instead of the rocker
        turned = 1j * z * e / (c * _dot(line, e))
        by_x = np.empty((*t.shape, 8), dtype=complex)
        by_x[..., 0], by_x[..., 1] = 1.0, 1j
        normal = 1j * line
        by_x[..., 2] = u - turned * _dot(normal, u)
        by_x[..., 3] = -turned * _dot(normal, e)
        by_x[..., 4] = turned
        by_x[..., 5] = turned * _dot(line, a * u + c * e)
        by_x[..., 6], by_x[..., 7] = e, 1j * e
        swing = 1j * a * u
        return moving + z * e, by_x, swing - turned * _dot(normal, swing)

    @np.errstate(all="ignore")
    def cosines(self, x: Array, t: Array) -> tuple[Array, Array, Array]:
        """The height of the rod over its length."""
        u = np.exp(1j * t)
        a, c, h = (x[:, k, None] for k in (2, 3, 4))
        across = u * np.exp(-1j * x[:, 5])[:, None]
        cosine = (h - a * across.imag) / c
        by_x = np.zeros((*t.shape, 8))
        by_x[..., 2], by_x[..., 3] = -across.imag / c, -cosine / c
        by_x[..., 4], by_x[..., 5] = 1.0 / c, a * across.real / c
        return cosine, by_x, -a * across.real / c

    def extreme(self, x: Array) -> Array:
        """The normal of the line."""
        return np.asarray(x[:, 5] + 0.25 * FULL_TURN)

    def limits(self, x: Array) -> tuple[Array, Array]:
        """a ± h - c, which end the branch, and by x."""
        a, c, h = x[:, 2], x[:, 3], x[:, 4]
        found = np.stack([a + h - c, a - h - c], axis=1)
        by_x = np.zeros((*found.shape, 8))
        by_x[:, :, 2], by_x[:, :, 3] = 1.0, -1.0
        by_x[:, 0, 4], by_x[:, 1, 4] = 1.0, -1.0
        return found, by_x

    def moved(self, x: Array, shift: ComplexArray, factor: ComplexArray) -> Array:
        """Dimensions turned and enlarged by factors (D,) about 0, then moved."""
        found, size = np.array(x), np.abs(factor)
        place = shift + factor * (x[:, 0] + 1j * x[:, 1])
        found[:, 0], found[:, 1] = place.real, place.imag
        for k in (2, 3, 4, 6, 7):
            found[:, k] *= size
        found[:, 5] += np.angle(factor)
        return found

    def shapes(self, x: Array) -> tuple[Array, ComplexArray]:
        """All lengths, the foot of A0 on the line, and the line's direction from it towards B.

        A line that is turned by 180° with -h and the other side is the same one.
        """
        line = np.exp(1j * x[:, 5])
        foot = 1j * x[:, 4] * line
        lengths = np.column_stack([x[:, [0, 1, 2, 3, 6, 7]], foot.real, foot.imag])
        return lengths, (self.side * line)[:, None]


def _dot(v: ComplexArray, w: ComplexArray) -> Array:
    return np.asarray(v.real * w.real + v.imag * w.imag)
