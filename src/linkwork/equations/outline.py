"""Smooth curves through given points: cubic splines parametrised by chord length."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, ComplexArray
from linkwork.foundation.elementwise import plain_value
from linkwork.foundation.precise import PI, Precise
from linkwork.kernels.piecewise import Piecewise

__all__ = ["Outline", "spline"]

_SAMPLES = 16  # samples per piece for the nearest point
_FINE = 64  # samples per piece for the smallest curvature


@dataclass(frozen=True, kw_only=True, eq=False)
class Outline:
    """x(u) and y(u); u is an angle from 0 to 2π if the curve is closed, else chord length."""

    x: Piecewise
    y: Piecewise

    @classmethod
    def through(cls, points: Sequence[complex], *, closed: bool) -> Outline:
        """The curve through points in order.

        A closed curve has two continuous derivatives everywhere and is counter-clockwise; an open
        curve has no curvature at its ends and continues straight ("natural" spline).
        """
        z = np.array(points)
        if closed:
            # twice the area: negative if the points run clockwise
            area = (z.conj() * np.roll(z, -1)).imag.sum()
            z = z if area >= 0 else np.concatenate([z[:1], z[:0:-1]])
            z = np.append(z, z[0])
        chords = abs(_differences(_exactly(z)))
        sums = list(accumulate(map(Precise, chords.high, chords.low), initial=Precise(0.0)))
        if closed:
            turn = PI * 2.0 / sums[-1]
            # the last one exactly, so that the period is one turn
            sums = [*(part * turn for part in sums[:-1]), PI * 2.0]
        u = Precise(*np.array([(part.high, part.low) for part in sums]).T)
        return cls(x=spline(u, z.real, closed), y=spline(u, z.imag, closed))

    def at(self, u: Array) -> ComplexArray:
        """Points x + iy."""
        z: ComplexArray = self.x(u) + 1j * self.y(u)
        return z

    def samples(self, count: int = 0) -> Array:
        """Parameters along the whole curve, both ends included."""
        breaks = self.x.breaks
        return np.linspace(breaks[0], breaks[-1], count or _SAMPLES * (len(breaks) - 1) + 1)

    def bend(self, u: Array) -> Array:
        """Curvature [1/length], positive where the curve turns to the left."""
        x, y = self.x.jet(u), self.y.jet(u)
        across: Array = x[1] * y[2] - y[1] * x[2]
        bend: Array = across / np.hypot(x[1], y[1]) ** 3
        return bend

    def deepest(self) -> tuple[complex, float]:
        """Parameter of the smallest (most concave) curvature of a closed curve, and this curvature.

        The minimum of 64 samples per piece; it is not proved.
        """
        u = self.samples(_FINE * (len(self.x.breaks) - 1) + 1)
        bend = self.bend(u)
        k = int(bend.argmin())
        return complex(self.at(u[k : k + 1])[0]), float(bend[k])

    def nearest(self, point: complex) -> float:
        """The parameter of the sample nearest to a point."""
        u = self.samples()
        return float(u[np.abs(self.at(u) - plain_value(point)).argmin()])


def spline(u: Array | Precise, values: Array, closed: bool) -> Piecewise:
    """The cubic spline with two continuous derivatives (de Boor, A Practical Guide to Splines).

    Its coefficients are rounded once.
    """
    u = u if isinstance(u, Precise) else _exactly(u)
    h = _differences(u)
    chords = _differences(_exactly(values)) / h
    low, high = (_each(h, np.roll, 1), h) if closed else (h.part(slice(-1)), h.part(slice(1, None)))
    bent = chords - _each(chords, np.roll, 1) if closed else _differences(chords)
    middle, ends = (low + high) * 2.0, (0, 1) if closed else (1, 1)
    solve = _solve_cyclic if closed else _solve_open
    second = _exactly(np.zeros(len(bent.high)))
    for _ in range(2):  # once, and for what rounding has left
        around = _each(second, np.pad, 1, "wrap" if closed else "constant")
        before, after = around.part(slice(-2)), around.part(slice(2, None))
        left = bent * 6.0 - (low * before + middle * second + high * after)  # eq. (69)
        second = second + solve(low.high, middle.high, high.high, left.high)
    second = _each(second, np.pad, ends, "wrap" if closed else "constant")
    begin, end = second.part(slice(-1)), second.part(slice(1, None))
    slope = chords - h * (begin * 2.0 + end) / 6.0
    powers = [values[:-1], slope.high, begin.high / 2.0, ((end - begin) / (h * 6.0)).high]
    none = np.zeros((len(powers[0]), 3))
    return Piecewise(breaks=u.high, powers=np.stack(powers, axis=1), sines=none, periodic=closed)


def _exactly(numbers: AnyArray) -> Precise:
    return Precise(numbers, np.zeros_like(numbers))


def _each(numbers: Precise, change: Callable[..., Any], *how: object) -> Precise:
    """Both parts of numbers moved to other places."""
    return Precise(change(numbers.high, *how), change(numbers.low, *how))


def _differences(numbers: Precise) -> Precise:
    return numbers.part(slice(1, None)) - numbers.part(slice(-1))


def _solve_open(low: Array, middle: Array, high: Array, right: Array) -> Array:
    return _solve_tridiagonal(low, middle, high, right[:, None])[:, 0]


def _solve_tridiagonal(low: Array, middle: Array, high: Array, right: Array) -> Array:
    """x (K, R) of low_k x_{k-1} + middle_k x_k + high_k x_{k+1} = right_k, (K, R).

    Elimination without pivoting, since the matrix is diagonally dominant.
    """
    middle, right = middle.copy(), right.copy()
    for k in range(1, len(middle)):
        factor = low[k] / middle[k - 1]
        middle[k] -= factor * high[k - 1]
        right[k] -= factor * right[k - 1]
    for k in range(len(middle) - 1, -1, -1):
        if k + 1 < len(middle):
            right[k] -= high[k] * right[k + 1]
        right[k] /= middle[k]
    return right


def _solve_cyclic(low: Array, middle: Array, high: Array, right: Array) -> Array:
    """Solve the cyclic system, in which the first and the last unknown are neighbours: x (K,)."""
    corner = np.zeros(len(middle) - 1)
    corner[0], corner[-1] = low[0], corner[-1] + high[-2]
    inner = np.stack([right[:-1], corner], axis=1)
    own, by_last = _solve_tridiagonal(low[:-1], middle[:-1], high[:-1], inner).T
    last = right[-1] - low[-1] * own[-1] - high[-1] * own[0]
    last /= middle[-1] - low[-1] * by_last[-1] - high[-1] * by_last[0]
    return np.append(own - by_last * last, last)
