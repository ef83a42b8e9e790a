"""Real functions given piece by piece: polynomials plus one sine, joined smoothly.

    f(x) = Σ_k c_k t^k + A sin(ω t + ψ),     t = x - b,  b ≤ x < next b

Motion laws of cams and cubic splines are of this kind. A function either repeats itself after its
period, or continues as a straight line beyond its ends.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace
from functools import cached_property
from math import comb, cos, sin

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.rounding import EXTENDED_EPSILON, UNIT_ROUNDOFF

__all__ = ["Piecewise"]

_PARTS = 32  # of each piece, in which its bend is bounded


@dataclass(frozen=True, kw_only=True, eq=False)
class Piecewise:
    """A function with continuous slope, K pieces.

    Parameters
    ----------
    breaks : (K + 1,)
        Where pieces begin and the last one ends, increasing.
    powers : (K, D + 1)
        c_k of every piece, lowest power first.
    sines : (K, 3)
        A, ω, ψ of every piece.
    periodic : bool
        Whether it repeats itself after ``breaks[-1] - breaks[0]``.
    corners : tuple of int
        The joints, counted from that of the first two pieces, at which its slope changes: bounds
        hold on either side of them, not across.
    """

    breaks: Array
    powers: Array
    sines: Array
    periodic: bool = True
    corners: tuple[int, ...] = ()

    @property
    def period(self) -> float:
        """How long all pieces are together."""
        return float(self.breaks[-1] - self.breaks[0])

    def slope(self) -> Piecewise:
        """The derivative as a function; beyond open ends it continues as a straight line.

        Its slope is continuous only if the second derivative of this one is.
        """
        k = np.arange(1, self.powers.shape[1])
        a, w, p = self.sines.T
        return Piecewise(
            breaks=self.breaks,
            powers=self.powers[:, 1:] * k,
            sines=np.stack([a * w, w, p + np.pi / 2.0], axis=1),
            periodic=self.periodic,
        )

    def slope_before_joints(self) -> Array:
        """The derivative at the end of all pieces but the last, (K - 1,)."""
        t = np.diff(self.breaks)[:-1]
        degrees = np.arange(1, self.powers.shape[1])
        a, w, p = self.sines[:-1].T
        straight = (self.powers[:-1, 1:] * degrees * t[:, None] ** (degrees - 1.0)).sum(axis=1)
        found: Array = straight + a * w * np.cos(w * t + p)
        return found

    def times(self, factor: float) -> Piecewise:
        """The function with all values multiplied."""
        return replace(
            self, powers=factor * self.powers, sines=self.sines * np.array([factor, 1.0, 1.0])
        )

    def locate(self, x: Array) -> tuple[IndexArray, Array, Array]:
        """Piece of each x, t inside it, and how far x lies beyond an open end."""
        low, high = self.breaks[0], self.breaks[-1]
        if self.periodic:
            inside = low + np.mod(x - low, self.period)
            beyond = np.zeros_like(x)
        else:
            inside = np.clip(x, low, high)
            beyond = x - inside
        piece = np.clip(np.searchsorted(self.breaks, inside, side="right") - 1, 0, None)
        piece = np.minimum(piece, len(self.breaks) - 2)
        return piece, inside - self.breaks[piece], beyond

    def jet(self, x: Array) -> tuple[Array, Array, Array]:
        """Value, first and second derivative at any x; the second from the right at a joint."""
        shape, x = np.shape(x), np.ravel(np.asarray(x, dtype=float))
        piece, t, beyond = self.locate(x)
        c = self.powers[piece]
        value, first, second = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
        for k in range(c.shape[1] - 1, -1, -1):
            second = second * t + 2.0 * first
            first = first * t + value
            value = value * t + c[:, k]
        a, w, p = self.sines[piece].T
        sine, cosine = a * np.sin(w * t + p), a * w * np.cos(w * t + p)
        first = first + cosine
        value = value + sine + first * beyond
        second = np.where(beyond == 0.0, second - w**2 * sine, 0.0)
        return value.reshape(shape), first.reshape(shape), second.reshape(shape)

    @cached_property
    def _lists(self) -> tuple[list[float], list[list[float]], list[list[float]]]:
        """Breaks, powers from the highest on, and sines."""
        return self.breaks.tolist(), self.powers[:, ::-1].tolist(), self.sines.tolist()

    def jet_at(self, x: float) -> tuple[float, float, float]:
        """:meth:`jet` at one number."""
        breaks, powers, sines = self._lists
        low, high = breaks[0], breaks[-1]
        inside = low + (x - low) % (high - low) if self.periodic else min(max(x, low), high)
        beyond = 0.0 if self.periodic else x - inside
        piece = min(max(bisect_right(breaks, inside) - 1, 0), len(powers) - 1)
        t = inside - breaks[piece]
        value = first = second = 0.0
        for c in powers[piece]:
            second = second * t + 2.0 * first
            first = first * t + value
            value = value * t + c
        a, w, p = sines[piece]
        sine, cosine = a * sin(w * t + p), a * w * cos(w * t + p)
        first += cosine
        return value + sine + first * beyond, first, 0.0 if beyond else second - w * w * sine

    def __call__(self, x: Array) -> Array:
        """The value at any x."""
        return self.jet(x)[0]

    @cached_property
    def bend(self) -> float:
        """No smaller than |f''| anywhere."""
        count = self.powers.shape[1]
        lengths = np.diff(self.breaks)
        half = lengths / (2.0 * _PARTS)
        largest = np.zeros(len(lengths))
        for part in range(_PARTS):
            middle = (2 * part + 1) * half
            total = np.zeros(len(lengths))
            for j in range(count - 2):  # Taylor coefficients of f'' about the middle of the part
                coefficient = np.zeros(len(lengths))
                for k in range(count - 1, j + 1, -1):
                    coefficient = coefficient * middle + self.powers[:, k] * (
                        k * (k - 1) * comb(k - 2, j)
                    )
                total += np.abs(coefficient) * half**j
            largest = np.maximum(largest, total)
        sine = np.abs(self.sines[:, 0]) * self.sines[:, 1] ** 2
        own = float((largest + sine).max(initial=0.0)) * (1.0 + 1e-9)
        return own + self.gaps[1] / self.period

    @cached_property
    def gaps(self) -> tuple[float, float]:
        """How far this function and its slope may be from one that really is smooth.

        Coefficients are rounded, so pieces meet only nearly. With jumps J of the value and D of the
        slope at the joints, adding a function of no more than Σ|J| + P Σ|D|, whose slope is no more
        than 2 Σ|D| + Σ|J|/P and whose second derivative is Σ D/P, leaves none (P: all pieces).
        """
        exact = np.longdouble
        unit = EXTENDED_EPSILON
        c, (a, w, p) = self.powers.astype(exact), self.sines.T.astype(exact)
        t = np.diff(self.breaks.astype(exact))
        degrees = np.arange(c.shape[1])
        powers = t[:, None] ** degrees
        slopes = c[:, 1:] * degrees[1:]
        phase = w * t + p
        value = (c * powers).sum(axis=1) + a * np.sin(phase)
        slope = (slopes * powers[:, :-1]).sum(axis=1) + a * w * np.cos(phase)
        factor = unit * (2.0 * c.shape[1] + 8.0)
        slack = factor * (np.abs(c) * powers).sum(axis=1) + unit * np.abs(a) * (8 + np.abs(phase))
        steep = factor * (np.abs(slopes) * powers[:, :-1]).sum(axis=1)
        steep += unit * np.abs(a * w) * (8 + np.abs(phase))
        begin, rate = c[:, 0] + a * np.sin(p), c[:, 1] + a * w * np.cos(p)
        jumps = np.abs(value - np.roll(begin, -1)) + 2.0 * (slack + np.roll(slack, -1))
        bends = np.abs(slope - np.roll(rate, -1)) + 2.0 * (steep + np.roll(steep, -1))
        bends[list(self.corners)] = 0.0
        last = None if self.periodic else -1
        jump, bend = float(jumps[:last].sum()), float(bends[:last].sum())
        return jump + self.period * bend, 2.0 * bend + jump / self.period

    def rounding(self, x: Array) -> tuple[Array, Array]:
        """Bounds of the error of computing the value and the first derivative at x (B,)."""
        piece, t, beyond = self.locate(x)
        c, degrees = np.abs(self.powers[piece]), np.arange(self.powers.shape[1])
        t = np.abs(t)
        powers = t[:, None] ** degrees
        a, w, p = np.abs(self.sines[piece].T)
        phase = 8.0 + w * t + p
        slope_powers = (c[:, 1:] * degrees[1:]) * powers[:, :-1]
        moved = 2.0 * (np.abs(x) + self.period + np.abs(self.breaks).max())
        factor = 2.0 * self.powers.shape[1] + 8.0
        slope_error = factor * slope_powers.sum(axis=1) + a * w * phase + self.bend * moved
        steepest = np.abs(self.jet(x)[1]) + UNIT_ROUNDOFF * slope_error
        value_error = factor * (c * powers).sum(axis=1) + a * phase + steepest * moved
        value_error += (factor * steepest + slope_error) * np.abs(beyond)
        apart, steeper = self.gaps
        return apart + UNIT_ROUNDOFF * value_error + steeper * np.abs(
            beyond
        ), steeper + UNIT_ROUNDOFF * slope_error
