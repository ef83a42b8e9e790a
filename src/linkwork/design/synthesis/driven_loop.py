"""One loop and its input: where it can move, with bounds of the errors of every sign.

With the input φ (an angle) or s (a slider's displacement) the loop closes where

    low ≤ q ≤ high,    q = q0 + q1 cos(φ - φ0)  or  q = q0 + s²,                         eq. (144)

| loop | q | low, high | the side of the loop: sign of |
|---|---|---|---|
| four-bar driven at A0 | \\|A - B0\\|² | (b - c)², (b + c)² | (B - A) × (B - B0) |
| slider-crank driven at A0 | distance of A from the line | -c, c | (B - A) · line |
| slider-crank driven at B | \\|B - A0\\|² | (a - c)², (a + c)² | (A - B) × (A - A0) |
| inverted slider-crank driven at A0 | \\|A - B0\\|² | h², ∞ | (B0 - A) · line |
| inverted slider-crank driven at B0 | (A - A0) across the line | -a, a | (A - A0) · line |

h is the distance of A from the line of the coupler, which slides through B0.

A loop changes its side only at a limit, which is a dead point. Each limit that is reached cuts the
circle of inputs around one of its poles φ0, φ0 + π: two limits leave two circuits, one limit one
circuit, none two circuits that differ in their side.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from linkwork.design.synthesis.candidates import Candidates, Drive, LoopKind
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

__all__ = ["DrivenLoops", "cross", "dot", "driven_loops"]

# roundings of a vector between two points, its length, and sums of four lengths
_VECTOR = 16.0 * UNIT_ROUNDOFF
# of a product of two vectors, with errors ε: |v| ε + |w| ε + ε² and its own roundings
_PRODUCT = 2.25


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
        c0, c1: the cosine of the transmission angle is c0 + c1 q.
    offset : (D,)
        h: for an inverted slider-crank driven at A0 the cosine is h/√q; else 0.
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

    @property
    def is_free(self) -> BoolArray:
        """Whether the input turns fully."""
        return (self.upper <= 0) & (self.lower <= 0) & self.turns

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
            if f.name not in ("turns", "cosine")
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


def driven_loops(given: Candidates, drive: Drive) -> DrivenLoops:
    """The loops of designs with one driven link."""
    if given.kind is LoopKind.FOUR_BAR:
        return _four_bars(given if drive is Drive.A0 else given.driven_at_b())
    if given.kind is LoopKind.INVERTED:
        return _inverted(given) if drive is Drive.A0 else _driven_blocks(given)
    return _slider_cranks(given) if drive is Drive.A0 else _driven_sliders(given)


def _four_bars(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    coupler = given.moving_b - given.moving_a
    rocker = given.moving_b - given.fixed_b[:, None]
    ground = given.fixed_b - given.fixed_a
    a, b, c = (np.abs(v[:, 0]) for v in (crank, rocker, coupler))
    g = np.abs(ground)
    size = np.maximum(np.maximum(a, b), np.maximum(c, g))
    doubt = _doubt(given, size)
    toward = _phase(ground)
    with np.errstate(all="ignore"):
        cosine = (b**2 + c**2) / (2.0 * b * c), -1.0 / (2.0 * b * c)
    return DrivenLoops(
        turns=True,
        input=_phase(crank),
        input_error=_angle_error(a, doubt),
        origin=toward + np.pi,
        q0=a**2 + g**2,
        q1=2.0 * a * g,
        low=(b - c) ** 2,
        high=(b + c) ** 2,
        upper=(a + g) - (b + c),
        lower=np.abs(b - c) - np.abs(a - g),
        limit_error=4.0 * doubt,
        side=cross(coupler, rocker),
        half=cross(crank, ground[:, None]),
        sign_error=_PRODUCT * size * doubt,
        q_error=4.0 * _PRODUCT * size * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _slider_cranks(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    rod = given.moving_b - given.moving_a
    normal = 1j * given.direction
    a, c = np.abs(crank[:, 0]), np.abs(rod[:, 0])
    height = dot(normal, given.fixed_a - given.fixed_b)
    size = np.maximum(np.maximum(a, c), np.abs(given.fixed_a - given.fixed_b))
    doubt = _doubt(given, size)
    toward = _phase(normal)
    with np.errstate(all="ignore"):
        cosine = np.zeros_like(c), 1.0 / c
    return DrivenLoops(
        turns=True,
        input=_phase(crank),
        input_error=_angle_error(a, doubt),
        origin=toward,
        q0=height,
        q1=a,
        low=-c,
        high=c,
        upper=height + a - c,
        lower=a - height - c,
        limit_error=4.0 * doubt,
        side=dot(rod, given.direction[:, None]),
        half=cross(normal[:, None], crank),
        sign_error=_PRODUCT * doubt,
        q_error=4.0 * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _driven_sliders(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    rod = given.moving_a - given.moving_b
    a, c = np.abs(crank[:, 0]), np.abs(rod[:, 0])
    to_crank = given.fixed_a - given.fixed_b
    height = dot(1j * given.direction, to_crank)
    size = np.maximum(np.maximum(a, c), np.abs(given.moving_b - given.fixed_b[:, None]).max(axis=1))
    size = np.maximum(size, np.abs(to_crank))
    doubt = _doubt(given, size)
    foot = dot(given.direction, to_crank)
    s = dot(given.direction[:, None], given.moving_b - given.fixed_b[:, None])
    with np.errstate(all="ignore"):
        cosine = (a**2 + c**2) / (2.0 * a * c), -1.0 / (2.0 * a * c)
    return DrivenLoops(
        turns=False,
        input=s,
        input_error=4.0 * doubt,
        origin=foot,
        q0=height**2,
        q1=np.ones_like(a),
        low=(a - c) ** 2,
        high=(a + c) ** 2,
        # a slider far enough away reaches the outer limit always
        upper=np.full_like(a, np.inf),
        lower=np.abs(a - c) - np.abs(height),
        limit_error=4.0 * doubt,
        side=cross(rod, crank),
        half=size[:, None] * (s - foot[:, None]),
        sign_error=_PRODUCT * size * doubt,
        q_error=4.0 * _PRODUCT * size * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _inverted(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    ground = given.fixed_b - given.fixed_a
    to_block, lines = given.fixed_b[:, None] - given.moving_a, given.lines
    a, g = np.abs(crank[:, 0]), np.abs(ground)
    h = np.abs(cross(lines[:, 0], to_block[:, 0]))
    size = np.maximum(np.maximum(a, g), np.abs(to_block).max(axis=1))
    doubt = 2.0 * _doubt(given, size)
    return DrivenLoops(
        turns=True,
        input=_phase(crank),
        input_error=_angle_error(a, doubt),
        origin=_phase(ground) + np.pi,
        q0=a**2 + g**2,
        q1=2.0 * a * g,
        low=h**2,
        high=np.full_like(h, np.inf),
        # a block on an endless line limits one side only
        upper=np.full_like(h, -np.inf),
        lower=h - np.abs(a - g),
        limit_error=4.0 * doubt,
        side=size[:, None] * dot(lines, to_block),
        half=cross(crank, ground[:, None]),
        sign_error=_PRODUCT * size * doubt,
        q_error=4.0 * _PRODUCT * size * doubt,
        cosine=(np.zeros_like(h), np.zeros_like(h)),
        # rounding alone makes an offset of zero positive
        offset=h + doubt,
    )


def _driven_blocks(given: Candidates) -> DrivenLoops:
    crank = given.moving_a - given.fixed_a[:, None]
    ground = given.fixed_a - given.fixed_b
    to_block, lines = given.fixed_b[:, None] - given.moving_a, given.lines
    a, g = np.abs(crank[:, 0]), np.abs(ground)
    # A is h to the right of the line, A0 is g cos(φ - φ0) to the right of its parallel through B0
    h = cross(lines[:, 0], to_block[:, 0])
    size = np.maximum(np.maximum(a, g), np.abs(to_block).max(axis=1))
    doubt = 2.0 * _doubt(given, size)
    toward = _phase(ground) + 0.5 * np.pi
    with np.errstate(all="ignore"):
        cosine = np.zeros_like(a), 1.0 / a
    return DrivenLoops(
        turns=True,
        input=_phase(lines),
        input_error=_angle_error(size, doubt),
        origin=toward,
        q0=-h,
        q1=g,
        low=-a,
        high=a,
        upper=g - h - a,
        lower=g + h - a,
        limit_error=4.0 * doubt,
        side=dot(crank, lines),
        half=cross(1j * ground[:, None], lines),
        sign_error=_PRODUCT * doubt,
        q_error=4.0 * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _doubt(given: Candidates, size: Array) -> Array:
    """A bound of the errors of vectors between pivots."""
    far = np.maximum(np.abs(given.fixed_a), np.abs(given.moving_a).max(axis=1))
    return np.asarray(2.0 * given.error + _VECTOR * (size + far))


def _angle_error(length: Array, doubt: Array) -> Array:
    """A bound of the errors of directions of vectors."""
    with np.errstate(all="ignore"):
        # asin x ≤ 1.05 x for x ≤ 1/2
        part = doubt / length
        return np.where(part < 0.5, 1.05 * part + _VECTOR, np.inf)


def _phase(v: ComplexArray) -> Array:
    return np.asarray(np.arctan2(v.imag, v.real))
