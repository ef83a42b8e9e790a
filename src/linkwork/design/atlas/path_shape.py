"""The shape of a closed curve: Fourier coefficients of points at equal steps of arc length.

Steps of arc length leave out the timing. Place and size go with the mean and the norm of the
coefficients c_k; a turn multiplies all of them by one number of length 1, another first point
multiplies c_k by e^{iks}; the opposite sense of travel exchanges c_k and c_-k, a mirror image also
conjugates them. The distance of two shapes is the least over all of these, eq. (157).
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray

__all__ = ["HARMONICS", "WAYS", "coefficients", "distances", "in_ways", "points_by_arc_length"]

_POINTS = 64
_MOST = 8
#: k of the coefficients of a shape.
HARMONICS = np.concatenate([np.arange(1, _MOST + 1), np.arange(-_MOST, 0)])
#: Whether a curve is travelled in the opposite sense, and mirrored.
WAYS = ((False, False), (True, False), (False, True), (True, True))
_SHIFTS = 64  # first points that are tried before the best one is refined
_REFINEMENTS = 4


def points_by_arc_length(z: ComplexArray) -> ComplexArray:
    """Points (D, 64) at equal steps of arc length along closed polygons z (D, N)."""
    closed = np.concatenate([z, z[:, :1]], axis=1)
    length = np.cumsum(np.abs(np.diff(closed, axis=1)), axis=1)
    length = np.concatenate([np.zeros((len(z), 1)), length], axis=1)
    share = np.arange(_POINTS) / _POINTS
    found = np.empty((len(z), _POINTS), dtype=complex)
    for k, (along, points) in enumerate(zip(length, closed, strict=True)):
        found[k] = np.interp(share * along[-1], along, points)
    return found


def coefficients(z: ComplexArray) -> tuple[ComplexArray, ComplexArray, Array]:
    """The shapes (D, 16) of closed polygons (D, N), their centres (D,) and sizes (D,).

    The size is the root of the mean square distance from the centre, as far as the harmonics make
    it; shapes have the norm 1, NaN for curves that are one point.
    """
    c = np.fft.fft(points_by_arc_length(z), axis=1) / _POINTS
    own = c[:, HARMONICS]
    size = np.sqrt((np.abs(own) ** 2).sum(axis=1))
    with np.errstate(all="ignore"):
        return own / size[:, None], c[:, 0], size


def in_ways(shape: ComplexArray) -> ComplexArray:
    """A shape (16,) in each of the WAYS, (4, 16)."""
    back = shape[::-1]  # c_-k, by the order of the harmonics
    return np.stack([shape, back, back.conj(), shape.conj()])


def distances(shapes: ComplexArray, wanted: ComplexArray) -> tuple[Array, Array, Array]:
    """The distances (D,) of shapes (D, 16) from a wanted one (16,), turned and begun as is best.

    Returns
    -------
    distance, shift, turn : (D,)
        The root of the mean square of the gaps, relative to the size; e^{i(ks + turn)} times the
        shape's c_k is nearest to the wanted shape, for the shift s [rad].
    """
    products = shapes.conj() * wanted
    grid = np.arange(_SHIFTS) * (2.0 * np.pi / _SHIFTS)
    # f(s) = Σ c̄_k w_k e^{-iks}: its largest length is the best agreement
    s = grid[np.abs(products @ np.exp(-1j * np.outer(HARMONICS, grid))).argmax(axis=1)]
    for _ in range(_REFINEMENTS):
        terms = products * np.exp(-1j * s[:, None] * HARMONICS)
        f, d = terms.sum(axis=1), (terms * (-1j * HARMONICS)).sum(axis=1)
        dd = (terms * -(HARMONICS**2)).sum(axis=1)
        # Newton's method for the maximum of |f|²
        slope = (f.conj() * d).real
        bend = np.abs(d) ** 2 + (f.conj() * dd).real
        with np.errstate(all="ignore"):
            step = np.where(bend < 0, -slope / bend, 0.0)
        s = s + np.clip(step, -grid[1], grid[1])
    f = (products * np.exp(-1j * s[:, None] * HARMONICS)).sum(axis=1)
    # eq. (157)
    square = 2.0 - 2.0 * np.abs(f)
    return np.sqrt(np.maximum(square, 0.0)), s, np.angle(f)
