"""The limits of one loop with an input, as verdicts need them, with bounds of all errors."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.foundation.units import FULL_TURN
from linkwork.synthesis.loops.candidates import Candidates, Drive, LoopKind

# roundings of a vector between two points, its length, and sums of four lengths
_VECTOR = 16.0 * UNIT_ROUNDOFF
#: Of a product of two vectors, with errors ε: |v| ε + |w| ε + ε² and the rounding of the product.
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
        Whether the cosine is squared.
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


def doubt_of(candidates: Candidates, size: Array) -> Array:
    """A bound of the errors of vectors between pivots."""
    far = np.maximum(np.abs(candidates.fixed_a), np.abs(candidates.moving_a).max(axis=1))
    return np.asarray(2.0 * candidates.error + _VECTOR * (size + far))


def angle_error(length: Array, doubt: Array) -> Array:
    """A bound of the errors of directions of vectors."""
    with np.errstate(all="ignore"):
        # asin x ≤ 1.05 x for x ≤ 1/2
        part = doubt / length
        return np.where(part < 0.5, 1.05 * part + _VECTOR, np.inf)


def phase_of(v: ComplexArray) -> Array:
    return np.asarray(np.arctan2(v.imag, v.real))


# ----------------------------------------------------------------------
# Loops without a crank: two dyads of which each has a slider.
#
# The limits of :mod:`~linkwork.design.loops.driven_loop` for them, eq. (144), with the input s or
# φ measured from its origin:
#
# | loop | q | low, high | the side of the loop: sign of |
# |---|---|---|---|
# | double slider driven at A | s² | none, (c / sin α)² | (B - A) · line of B |
# | Rapson's slide driven at A | \|A - B0\|² = H² + s² | h², none | (B0 - A) · line of the body |
# | Rapson's slide driven at B0 | cos φ | -1, 1 | none |
# | Oldham's coupling | none | none | none |
#
# α is the angle between the lines, c the distance of A and B, H that of B0 from the fixed line, h
# that of A from the body's line. A block at B0 that turns Rapson's slide parallel to its fixed line
# drives A to infinity: both limits are reached, and leave two circuits.


def guide_loops(candidates: Candidates, drive: Drive) -> DrivenLoops:
    """The loops of designs without a crank, with one driven link."""
    if candidates.kind is LoopKind.DOUBLE_SLIDER:
        return _double_sliders(candidates if drive is Drive.SLIDER_A else candidates.driven_at_b())
    if candidates.kind is LoopKind.OLDHAM:
        return _couplings(candidates if drive is Drive.A0 else candidates.driven_at_b())
    return _slides(candidates) if drive is Drive.SLIDER_A else _driven_blocks(candidates)


def _double_sliders(candidates: Candidates) -> DrivenLoops:
    rod, line = candidates.moving_b - candidates.moving_a, candidates.direction
    c, sine = np.abs(rod[:, 0]), np.abs(cross(candidates.direction_a, line))
    s = dot(candidates.direction_a[:, None], candidates.moving_a - candidates.fixed_a[:, None])
    origin = _crossing(candidates)
    size = np.maximum(c, np.abs(candidates.moving_b - candidates.fixed_b[:, None]).max(axis=1))
    size = np.maximum(size, np.abs(candidates.fixed_b - candidates.fixed_a))
    doubt = doubt_of(candidates, size)
    with np.errstate(all="ignore"):
        # of the crossing of two lines, and of distances from it
        place_error = 4.0 * doubt / sine
        farthest = np.maximum(np.abs(s - origin[:, None]).max(axis=1), c / sine)
        high = (c / sine) ** 2
        cosine = np.zeros_like(c), 1.0 / high
    return DrivenLoops(
        turns=False,
        input=s,
        input_error=place_error,
        origin=origin,
        q0=np.zeros_like(c),
        q1=np.ones_like(c),
        low=np.full_like(c, -np.inf),
        high=high,
        upper=np.full_like(c, np.inf),
        lower=np.full_like(c, -np.inf),
        limit_error=place_error,
        side=dot(rod, line[:, None]),
        half=s - origin[:, None],
        sign_error=PRODUCT * doubt,
        q_error=PRODUCT * (2.0 * farthest + place_error) * place_error,
        cosine=cosine,
        offset=np.zeros_like(c),
        squared=True,
    )


def _slides(loops: Candidates) -> DrivenLoops:
    to_block, lines = loops.fixed_b[:, None] - loops.moving_a, loops.lines
    from_line = loops.fixed_b - loops.fixed_a
    height, origin = (cross(loops.direction_a, from_line), dot(loops.direction_a, from_line))
    s = dot(loops.direction_a[:, None], loops.moving_a - loops.fixed_a[:, None])
    h = np.abs(cross(lines[:, 0], to_block[:, 0]))
    size = np.maximum(np.abs(from_line), np.abs(to_block).max(axis=1))
    doubt = 2.0 * doubt_of(loops, size)
    none = np.zeros_like(h)
    return DrivenLoops(
        turns=False,
        input=s,
        input_error=4.0 * doubt,
        origin=origin,
        q0=height**2,
        q1=np.ones_like(h),
        low=h**2,
        high=np.full_like(h, np.inf),
        # a block on an endless line limits one side only
        upper=np.full_like(h, -np.inf),
        lower=h - np.abs(height),
        limit_error=4.0 * doubt,
        side=size[:, None] * dot(lines, to_block),
        half=size[:, None] * (s - origin[:, None]),
        sign_error=PRODUCT * size * doubt,
        q_error=4.0 * PRODUCT * size * doubt,
        cosine=(none, none),
        # rounding alone makes an offset of zero positive
        offset=h + doubt,
    )


def _driven_blocks(candidates: Candidates) -> DrivenLoops:
    to_block, lines = candidates.fixed_b[:, None] - candidates.moving_a, candidates.lines
    size = np.abs(to_block).max(axis=1)
    doubt = 2.0 * doubt_of(candidates, size)
    none, one = np.zeros_like(size), np.ones_like(size)
    return DrivenLoops(
        turns=True,
        input=phase_of(lines),
        input_error=angle_error(size, doubt),
        origin=phase_of(candidates.direction_a),
        q0=none,
        q1=one,
        low=-one,
        high=one,
        upper=size,
        lower=size,
        limit_error=4.0 * doubt,
        side=np.broadcast_to(size[:, None], lines.shape),
        half=size[:, None] * cross(candidates.direction_a[:, None], lines),
        sign_error=PRODUCT * doubt,
        q_error=4.0 * angle_error(size, doubt),
        cosine=(none, one),
        offset=none,
    )


def _couplings(candidates: Candidates) -> DrivenLoops:
    lines, count = candidates.lines_a, len(candidates)
    ground = np.abs(candidates.fixed_b - candidates.fixed_a)
    doubt = 2.0 * doubt_of(candidates, ground)
    arm = np.abs(candidates.moving_a - candidates.fixed_a[:, None]).max(axis=1) + ground
    none, unlimited = np.zeros(count), np.full(count, np.inf)
    return DrivenLoops(
        turns=True,
        input=phase_of(lines),
        input_error=angle_error(arm, doubt),
        origin=none,
        q0=none,
        q1=none,
        low=-unlimited,
        high=unlimited,
        upper=-unlimited,
        lower=-unlimited,
        limit_error=none,
        side=np.ones(lines.shape),
        half=np.ones(lines.shape),
        sign_error=none,
        q_error=none,
        # both blocks turn alike; the force of one acts across its line
        cosine=(dot(candidates.direction_a, candidates.direction), none),
        offset=none,
    )


def _crossing(loops: Candidates) -> Array:
    """The place of the crossing of both fixed lines along that of A, (D,)."""
    away = loops.fixed_b - loops.fixed_a
    with np.errstate(all="ignore"):
        place = cross(away, loops.direction) / cross(loops.direction_a, loops.direction)
    return np.asarray(place)


def guide_pivots_at(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, place: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """A, B and P at places (D, K), as :func:`~linkwork.synthesis.loops.driven_loop.pivots_at`
    computes them.
    """
    swapped = drive is Drive.SLIDER or (candidates.kind is LoopKind.OLDHAM and drive is Drive.B0)
    driven = candidates.driven_at_b() if swapped else candidates
    first, second = driven.moving_a[:, :1], driven.moving_b[:, :1]
    fixed, block = driven.fixed_a[:, None], driven.fixed_b[:, None]
    value, side = place + loops.origin[:, None], np.sign(loops.side[:, :1])
    line_a = driven.direction_a[:, None]
    with np.errstate(all="ignore"):
        if driven.kind is LoopKind.OLDHAM:
            turn = np.exp(1j * value) / driven.lines_a[:, :1]
            start = meeting(fixed, driven.lines_a[:, :1], block, driven.lines[:, :1])
            centre = meeting(fixed, driven.lines_a[:, :1] * turn, block, driven.lines[:, :1] * turn)
            a = centre + (first - start) * turn
        elif driven.kind is LoopKind.DOUBLE_SLIDER:
            a, along = fixed + value * line_a, driven.direction[:, None]
            height, length = dot(1j * along, a - block), np.abs(second - first)
            b = a + (side * np.sqrt(length**2 - height**2) - 1j * height) * along
            turn = (b - a) / (second - first)
        else:
            line = driven.lines[:, :1]
            h = cross(line, block - first)
            if drive is Drive.SLIDER_A:
                a = fixed + value * line_a
                base = block - a
                reach = np.sqrt(base.real**2 + base.imag**2 - h**2)
                turn = base / (side * reach + 1j * h) / line
            else:
                along = np.exp(1j * value)
                way = (cross(along, block - fixed) - h) / cross(along, line_a)
                a, turn = fixed + way * line_a, along / line
        b = a + (second - first) * turn
        p = a + (driven.guided[:, :1] - first) * turn
    return (b, a, p) if swapped else (a, b, p)


def meeting(
    one: ComplexArray, along: ComplexArray, other: ComplexArray, across: ComplexArray
) -> ComplexArray:
    """Where lines through points meet."""
    return np.asarray(one + along * cross(other - one, across) / cross(along, across))


def guide_speeds(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, first: Array, last: Array
) -> tuple[Array, Array]:
    """Bounds of the speed of A, and of the turning of the body, per unit of the input, (D,)."""
    sine, one = np.sin(loops.least_transmission(first, last)), np.ones(len(candidates))
    ground = np.abs(candidates.fixed_b - candidates.fixed_a)
    if candidates.kind is LoopKind.OLDHAM:
        # the crossing of the body's lines runs around a circle through A0 and B0
        centre = meeting(
            candidates.fixed_a, candidates.lines_a[:, 0], candidates.fixed_b, candidates.lines[:, 0]
        )  # fmt: skip
        return ground / sine + np.abs(candidates.moving_a[:, 0] - centre), one
    if candidates.kind is LoopKind.DOUBLE_SLIDER:
        # either end moves along its line by at most 1 / sin μ, and across the other by at most 1
        return 1.0 / sine, 1.0 / (np.abs(candidates.moving_b - candidates.moving_a)[:, 0] * sine)
    h = np.abs(cross(candidates.lines[:, 0], candidates.fixed_b - candidates.moving_a[:, 0]))
    if drive is Drive.SLIDER_A:
        nearest = np.sqrt(np.maximum(loops.extremes(first, last).min(axis=1) - loops.q_error, 0.0))
        return one, 1.0 / (nearest * sine)
    height = np.abs(cross(candidates.direction_a, candidates.fixed_b - candidates.fixed_a))
    return (height + h) / sine**2, one
