"""The limits of one loop with an input: what verdicts need of it, with bounds of all errors."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from linkwork.design.loops.candidates import Candidates
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

__all__ = ["PRODUCT", "DrivenLoops", "angle_error", "cross", "dot", "doubt_of", "phase_of"]

# roundings of a vector between two points, its length, and sums of four lengths
_VECTOR = 16.0 * UNIT_ROUNDOFF
#: Of a product of two vectors, with errors ε: |v| ε + |w| ε + ε² and its own roundings.
PRODUCT = 2.25


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenLoops:
    """D loops at N positions.

    Parameters
    ----------
    turns : bool
        Whether the input is an angle.
    input : (D, N)
        The input at the positions [rad or length].
    input_error : (D,)
        A bound of its error.
    origin : (D,)
        φ0 [rad]; the place of s = 0 along the line for a slider [length].
    q0, q1, low, high : (D,)
        The limits above.
    upper, lower : (D,)
        By how much the loop exceeds each limit on a whole turn: the limit is reached where this is
        positive [length].
    limit_error : (D,)
        A bound of the error of ``upper`` and ``lower``.
    side, half : (D, N)
        Signs: the side of the loop; on which half of the circle, or of the line, the input is.
    sign_error : (D,)
        A bound of the errors of both.
    q_error : (D,)
        A bound of the errors of q and of its limits.
    cosine : tuple of (D,)
        c0, c1: the cosine of the transmission angle is c0 + c1 q, or that is its square.
    offset : (D,)
        h: for a line that is driven at A the cosine is h/√q; else 0.
    squared : bool
        Whether the cosine's square is given.
    """

    turns: bool
    input: Array
    input_error: Array
    origin: Array
    q0: Array
    q1: Array
    low: Array
    high: Array
    upper: Array
    lower: Array
    limit_error: Array
    side: Array
    half: Array
    sign_error: Array
    q_error: Array
    cosine: tuple[Array, Array]
    offset: Array
    squared: bool = False

    @property
    def is_free(self) -> BoolArray:
        """Whether no limit is reached: an angle turns fully, a slider goes to any place."""
        return (self.upper <= 0) & (self.lower <= 0)

    @property
    def is_split(self) -> BoolArray:
        """Whether inputs of one circuit are on one half."""
        both = (self.upper > 0) & (self.lower > 0)
        return both if self.turns else self.lower > 0

    def take(self, index: IndexArray) -> DrivenLoops:
        """Some of the loops, in the order of ``index``."""
        arrays = {
            f.name: getattr(self, f.name)[index]
            for f in fields(self)
            if f.name not in ("turns", "cosine", "squared")
        }
        c0, c1 = self.cosine
        return replace(self, cosine=(c0[index], c1[index]), **arrays)

    def extremes(self, first: Array, last: Array) -> Array:
        """q where it may be least or largest between places (D,), (D,): (D, K)."""
        begin, end = np.minimum(first, last), np.maximum(first, last)
        places = [begin, end]
        for pole in (0.0, np.pi) if self.turns else (0.0,):
            # the next pole from the beginning on, if it is in the range: q is extreme there
            ahead = np.mod(pole - begin, FULL_TURN) if self.turns else pole - begin
            margin = 4.0 * self.input_error
            inside = (ahead >= -margin) & (ahead <= end - begin + margin)
            places.append(np.where(inside, pole, begin))
        return self.q(np.stack(places, axis=1))

    def least_transmission(self, first: Array, last: Array) -> Array:
        """A lower bound of min(μ, π - μ) between places (D,), (D,) [rad]."""
        c0, c1 = self.cosine
        q = self.extremes(first, last)
        # a link of no length has no transmission angle
        with np.errstate(all="ignore"):
            largest = np.abs(c0[:, None] + c1[:, None] * q).max(axis=1) + np.abs(c1) * self.q_error
            if self.squared:
                largest = np.sqrt(largest)
            if self.offset.any():
                nearest = np.maximum(q.min(axis=1) - self.q_error, 0.0)
                largest = np.maximum(largest, self.offset / np.sqrt(nearest))
        return np.asarray(np.arccos(np.clip(largest, 0.0, 1.0)))

    def q(self, place: Array) -> Array:
        """q at places (D, K), measured from the origin."""
        # eq. (144)
        if self.turns:
            return np.asarray(self.q0[:, None] + self.q1[:, None] * np.cos(place))
        return np.asarray(self.q0[:, None] + place**2)


def cross(v: ComplexArray, w: ComplexArray) -> Array:
    """v × w."""
    return np.asarray(v.real * w.imag - v.imag * w.real)


def dot(v: ComplexArray, w: ComplexArray) -> Array:
    """v · w."""
    return np.asarray(v.real * w.real + v.imag * w.imag)


def doubt_of(given: Candidates, size: Array) -> Array:
    """A bound of the errors of vectors between pivots."""
    far = np.maximum(np.abs(given.fixed_a), np.abs(given.moving_a).max(axis=1))
    return np.asarray(2.0 * given.error + _VECTOR * (size + far))


def angle_error(length: Array, doubt: Array) -> Array:
    """A bound of the errors of directions of vectors."""
    with np.errstate(all="ignore"):
        # asin x ≤ 1.05 x for x ≤ 1/2
        part = doubt / length
        return np.where(part < 0.5, 1.05 * part + _VECTOR, np.inf)


def phase_of(v: ComplexArray) -> Array:
    return np.asarray(np.arctan2(v.imag, v.real))
