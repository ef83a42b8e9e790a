"""Smooth curves through given points: cubic splines by the length of their chords."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.kernels.piecewise import Piecewise

__all__ = ["Outline"]

_SAMPLES = 16  # of every piece, among which the nearest place is sought


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """x(u) and y(u); u is an angle from 0 to 2π if the curve is closed, else its chords' length."""

    x: Piecewise
    y: Piecewise

    @classmethod
    def through(cls, points: Sequence[complex], *, closed: bool) -> Outline:
        """The curve through points in their order.

        A closed one has two continuous derivatives everywhere and runs counter-clockwise; an open
        one is straight at its ends and goes on straight beyond them ("natural" spline).
        """
        z = np.array(points)
        if closed:
            area = (z.conj() * np.roll(z, -1)).imag.sum()
            z = z if area >= 0 else np.concatenate([z[:1], z[:0:-1]])
            z = np.append(z, z[0])
        u = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(z)))])
        if closed:
            u = u * (2.0 * np.pi / u[-1])
            u[-1] = 2.0 * np.pi
        return cls(x=_spline(u, z.real, closed), y=_spline(u, z.imag, closed))

    def at(self, u: Array) -> ComplexArray:
        """Points x + iy."""
        z: ComplexArray = self.x(u) + 1j * self.y(u)
        return z

    def samples(self, count: int = 0) -> Array:
        """Places along the whole curve, both ends included."""
        breaks = self.x.breaks
        return np.linspace(breaks[0], breaks[-1], count or _SAMPLES * (len(breaks) - 1) + 1)

    def nearest(self, point: complex) -> float:
        """The place of a sample that lies nearest to a point."""
        u = self.samples()
        return float(u[np.abs(self.at(u) - point).argmin()])


def _spline(u: Array, values: Array, closed: bool) -> Piecewise:
    """The cubic spline with two continuous derivatives (de Boor, A Practical Guide to Splines)."""
    h = np.diff(u)
    chords = np.diff(values) / h
    count = len(h) if closed else len(u)
    matrix, right = np.zeros((count, count)), np.zeros(count)  # for second derivatives
    if closed:
        for k in range(count):
            matrix[k, k] += 2.0 * (h[k - 1] + h[k])
            matrix[k, k - 1] += h[k - 1]
            matrix[k, (k + 1) % count] += h[k]
            right[k] = 6.0 * (chords[k] - chords[k - 1])
    else:
        matrix[0, 0] = matrix[-1, -1] = 1.0
        for k in range(1, count - 1):
            matrix[k, k - 1 : k + 2] = h[k - 1], 2.0 * (h[k - 1] + h[k]), h[k]
            right[k] = 6.0 * (chords[k] - chords[k - 1])
    second = np.linalg.solve(matrix, right)
    if closed:
        second = np.append(second, second[0])
    powers = np.stack(
        [
            values[:-1],
            chords - h * (2.0 * second[:-1] + second[1:]) / 6.0,
            second[:-1] / 2.0,
            np.diff(second) / (6.0 * h),
        ],
        axis=1,
    )
    return Piecewise(breaks=u, powers=powers, sines=np.zeros((len(h), 3)), periodic=closed)
