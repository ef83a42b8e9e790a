"""Dyads through five poses by loop closure: Sandor's and Erdman's compatibility equations.

A dyad is a crank w and a vector z of the body: w (e^{iβj} - 1) + z (e^{iαj} - 1) = δj. Of poses 1,
2, 3, j this has solutions if a1 + a2 x2 + a3 x3 + a4 xj = 0, x = e^{iβ}. For j = 4, 5 the unknown
xj is eliminated by |xj| = 1, then x3 by a resultant. Its polynomial in x2, of degree six, has two
trivial roots: β = 0 and β = α. It shares nothing with null spaces and conics.
"""

from __future__ import annotations

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray

__all__ = ["crank_turns"]

_NODES = 32  # on the circle; the polynomial's degree is at most 8 either way
_DEGREE = 8


def crank_turns(points: ComplexArray, angles: Array) -> ComplexArray:
    """All values e^{iβ2}, complex ones included, sorted by their distance from the circle.

    ``points`` (5,), ``angles`` (5,). The trivial ones, 1 and e^{iα2}, are left out.
    """
    delta, alpha = points[1:] - points[0], np.exp(1j * (angles[1:] - angles[0])) - 1.0
    x = np.exp(2j * np.pi * np.arange(_NODES) / _NODES)
    first, second = (_quadratic(delta, alpha, j, x) for j in (2, 3))
    a1, b1, c1 = first
    a2, b2, c2 = second
    values = (a1 * c2 - a2 * c1) ** 2 - (a1 * b2 - a2 * b1) * (b1 * c2 - b2 * c1)
    # a Laurent polynomial: its coefficients are those of a discrete Fourier transform
    c = np.fft.fft(values) / _NODES
    powers = np.array([c[k % _NODES] for k in range(_DEGREE, -_DEGREE - 1, -1)])
    large = np.flatnonzero(np.abs(powers) > 1e-11 * np.abs(powers).max())
    roots = np.roots(powers[large[0] : large[-1] + 1])
    for trivial in (1.0, 1.0 + alpha[0]):
        roots = np.delete(roots, np.abs(roots - trivial).argmin())
    return np.asarray(roots[np.argsort(np.abs(np.abs(roots) - 1.0))])


def _quadratic(
    delta: ComplexArray, alpha: ComplexArray, j: int, x: ComplexArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """|a1 + a2 x2 + a3 x3|² = |a4|² as a quadratic in x3, at values of x2 on the circle."""

    def minor(k: int, m: int) -> complex:
        return complex(alpha[k] * delta[m] - alpha[m] * delta[k])

    # the determinant of columns (x - 1, α, δ), expanded along the first
    a2, a3, a4 = minor(1, j), -minor(0, j), minor(0, 1)
    a1 = -(a2 + a3 + a4)
    s, t = a1 + a2 * x, np.conj(a1) + np.conj(a2) / x
    return a3 * t, s * t + abs(a3) ** 2 - abs(a4) ** 2, np.conj(a3) * s
