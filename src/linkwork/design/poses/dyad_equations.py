"""The condition that a dyad carries a body through poses, as linear rows and two quadrics.

A body has the pose (d, θ): a point of it is at d, and it is turned by θ. A dyad joins it to
ground: RR by a bar between a moving pivot m (in the body's frame) and a fixed pivot p, PR by a
moving pivot on a fixed line, RP by a line of the body through a fixed pivot, PP by two guides. For
all of them, eq. (141),

    a |d|² + 2 Re(A e^{iθ} d̄) - 2 Re(Ḡ d) - 2 Re(B e^{iθ}) + C = 0,    a B = Ḡ A,

linear in x = (a, Re A, Im A, Re G, Im G, Re B, Im B, C). With a ≠ 0: m = A/a, p = G/a; with
a = A = 0: m = B/Ḡ on the line of normal G; with a = G = 0: p = conj(B/A), and a line of the body
of normal A.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, ComplexArray, IndexArray

__all__ = ["COORDINATES", "CURVATURE", "NormalPoses", "quadric_gradients", "quadrics"]

#: The number of coordinates of a dyad, up to a common factor.
COORDINATES = 8
#: Largest second derivative of either quadric in the maximum norm: three products, each twice.
CURVATURE = 6.0
# a|d|² and the other terms: at most five roundings and two of the sine and cosine, each of data
# that were themselves shifted and scaled in two
_ROUNDINGS = 12.0


@dataclass(frozen=True, kw_only=True, eq=False)
class NormalPoses:
    """Poses of N bodies, moved to their centre and divided by their size.

    Parameters
    ----------
    points, turns : (N, K) complex
        d and e^{iθ}; K poses.
    centre : (N,) complex
        The mean of the points that were given [length].
    size : (N,)
        The largest distance of a point from it [length].
    """

    points: AnyArray
    turns: AnyArray
    centre: ComplexArray
    size: Array

    @classmethod
    def of(cls, points: ComplexArray, angles: Array) -> NormalPoses:
        """From points (N, K) [length] and angles (N, K) [rad]."""
        centre = points.mean(axis=1)
        shifted = points - centre[:, None]
        size = np.abs(shifted).max(axis=1)
        # bodies that only turn about their point have no size of their own
        size = np.where(size > 0, size, 1.0)
        return cls(
            points=shifted / size[:, None], turns=np.exp(1j * angles), centre=centre, size=size
        )

    def in_extended_precision(self, points: ComplexArray, angles: Array) -> NormalPoses:
        """The same bodies with the same centre and size, where the processor has more digits."""
        shifted = points.astype(np.clongdouble) - self.centre[:, None]
        return replace(
            self,
            points=np.asarray(shifted / self.size[:, None]),
            turns=np.exp(1j * angles.astype(np.longdouble)),
        )

    def rows(self) -> Array:
        """The linear rows, (N, K, 8)."""
        d, e = self.points, self.turns
        turned = e * d.conj()
        # eq. (141)
        one = np.ones_like(d.real)
        parts = (
            d.real**2 + d.imag**2,
            2.0 * turned.real, -2.0 * turned.imag,
            -2.0 * d.real, -2.0 * d.imag,
            -2.0 * e.real, 2.0 * e.imag,
            one,
        )  # fmt: skip
        return np.stack(parts, axis=-1)

    @staticmethod
    def doubt(entries: Array) -> Array:
        """Bounds of the errors of entries of rows, from their sizes (…, 8), in unit roundoffs."""
        # points are at most 1 from the centre: no factor of an entry exceeds 2
        return np.asarray(_ROUNDINGS * np.maximum(entries, 2.0))

    def take(self, index: IndexArray | slice) -> NormalPoses:
        """Some of the bodies."""
        return NormalPoses(
            points=self.points[index],
            turns=self.turns[index],
            centre=self.centre[index],
            size=self.size[index],
        )


def quadrics(x: AnyArray) -> AnyArray:
    """Both quadrics, (…, 2), at x (…, 8), real or complex: a B - Ḡ A by real and imaginary part."""
    a, p, q, g, h, u, v, _ = np.moveaxis(x, -1, 0)
    return np.stack([a * u - (g * p + h * q), a * v - (g * q - h * p)], axis=-1)


def quadric_gradients(x: AnyArray) -> AnyArray:
    """Their derivatives, (…, 2, 8)."""
    a, p, q, g, h, u, v, _ = np.moveaxis(x, -1, 0)
    o = np.zeros_like(a)
    first = np.stack([u, -g, -h, -p, -q, a, o, o], axis=-1)
    second = np.stack([v, h, -g, -q, p, o, a, o], axis=-1)
    return np.stack([first, second], axis=-2)
