"""Dyads and loops that linear equations determine: circumcentres and Freudenstein's equation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, Batch, BoolArray, ComplexArray
from linkwork.core.foundation.units import FULL_TURN

# roundings of one coordinate of a pose carried to another frame, and of products of two of them
_LOSS = 16.0


def circumcentres(points: ComplexArray, far: Array) -> tuple[ComplexArray, Array]:
    """The centres of circles through three points, with bounds of their errors.

    Parameters
    ----------
    points : (B, 3) complex
    far : (B,)
        The largest size of a number that the points were computed from.

    Returns
    -------
    (B,) complex, (B,)
        Infinite bounds where the points are, to rounding, on one line.
    """
    v, w = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    area = 2.0 * (v.real * w.imag - v.imag * w.real)
    longest = np.maximum(np.abs(v), np.abs(w))
    doubt = _LOSS * UNIT_ROUNDOFF * (far + longest)
    # eq. (148): c (v × w) 2 = i (|w|² v - |v|² w)
    numerator = 1j * (np.abs(w) ** 2 * v - np.abs(v) ** 2 * w)
    with np.errstate(all="ignore"):
        centre = numerator / area
        divisor = np.abs(area) - 8.0 * longest * doubt
        error = (16.0 * longest**2 + 8.0 * np.abs(centre) * longest) * doubt / divisor
    error = np.where(divisor > 0, error + doubt, np.inf)
    return points[:, 0] + centre, error


def solve_with_bound(
    matrix: Array, right: Array, doubt: Array, right_doubt: Array
) -> tuple[Array, Array]:
    """The solutions x (B, n) of linear systems, and bounds of their errors.

    Parameters
    ----------
    matrix : (B, n, n)
    right : (B, n)
    doubt, right_doubt : (B,)
        Bounds of the errors of all entries of the matrices, and of the right sides.

    Returns
    -------
    (B, n), (B, n)
        Infinite bounds where a matrix may be singular.
    """
    n = matrix.shape[-1]
    regular = _regular(matrix)
    safe = np.where(regular[:, None, None], matrix, np.eye(n))
    inverse = np.linalg.inv(safe)
    x = (inverse @ right[..., None])[..., 0]
    size = np.abs(inverse)
    rest = right - (safe @ x[..., None])[..., 0]
    entries = right_doubt[:, None] + doubt[:, None] * np.abs(x).sum(axis=1, keepdims=True)
    loss = (n + 2) * UNIT_ROUNDOFF
    rest = (
        np.abs(rest)
        + entries
        + loss * (np.abs(right) + (np.abs(safe) @ np.abs(x)[..., None])[..., 0])
    )
    away = np.abs(np.eye(n) - inverse @ safe) + size @ (loss * np.abs(safe) + doubt[:, None, None])
    norm = away.sum(axis=2).max(axis=1)
    with np.errstate(all="ignore"):
        # Rump 2010: |x - x*| ≤ |R rest| / (1 - ‖I - R A‖)
        bound = (size @ rest[..., None])[..., 0].max(axis=1) / (1.0 - norm)
    bound = np.where(regular & (norm < 1.0), bound, np.inf)
    return x, np.broadcast_to(bound[:, None], x.shape)


def _regular(matrix: Array) -> BoolArray:
    sizes = np.linalg.svd(matrix, compute_uv=False)
    # an elimination may find no pivot in a matrix that is singular to rounding
    return np.asarray(sizes[..., -1] > _LOSS * UNIT_ROUNDOFF * sizes[..., 0])


# ----------------------------------------------------------------------
# Four-bars and slider-cranks that guide a body through positions, many of one kind at once.


class LoopKind(Enum):
    """A mechanism of one loop that guides a body; the value is its name in files."""

    FOUR_BAR = "four-bar"
    SLIDER_CRANK = "slider-crank"
    INVERTED = "inverted-slider-crank"
    #: A and B slide on fixed lines: the elliptic trammel.
    DOUBLE_SLIDER = "double-slider"
    #: A slides on a fixed line, a line of the body in a block that swivels about B0.
    RAPSON = "rapson-slide"
    #: Two lines of the body slide in blocks that swivel about A0 and B0.
    OLDHAM = "oldham-coupling"

    @property
    def sides(self) -> tuple[Side, Side]:
        """How A and B are held."""
        return _SIDES[self]

    @property
    def has_crank(self) -> bool:
        """Whether A turns about A0."""
        return self.sides[0] is Side.PIN

    @property
    def pivots(self) -> tuple[str, ...]:
        """Its fixed pivots."""
        sides = zip(("A0", "B0"), self.sides, strict=True)
        return tuple(name for name, side in sides if side is not Side.LINE)

    @property
    def body_line(self) -> bool:
        """Whether a line of the body through B slides in a block at B0."""
        return self.sides[1] is Side.BLOCK


class Side(Enum):
    """How a moving pivot is held: by a link to a fixed pivot, on a fixed line, or on a line of the
    body that slides in a block, which swivels about a fixed pivot.
    """

    PIN = "pin"
    LINE = "line"
    BLOCK = "block"


_SIDES = {
    LoopKind.FOUR_BAR: (Side.PIN, Side.PIN),
    LoopKind.SLIDER_CRANK: (Side.PIN, Side.LINE),
    LoopKind.INVERTED: (Side.PIN, Side.BLOCK),
    LoopKind.DOUBLE_SLIDER: (Side.LINE, Side.LINE),
    LoopKind.RAPSON: (Side.LINE, Side.BLOCK),
    LoopKind.OLDHAM: (Side.BLOCK, Side.BLOCK),
}

#: The names of mechanisms without a crank.
GUIDED = tuple(kind.value for kind in LoopKind if not kind.has_crank)


class Drive(Enum):
    """The driven link: the crank or swivelling block at A0 or B0, the slider, or one at A."""

    A0 = "A0"
    B0 = "B0"
    SLIDER = "slider"
    SLIDER_A = "slider at A"

    @property
    def turns(self) -> bool:
        """Whether the input is an angle."""
        return self in (Drive.A0, Drive.B0)

    @property
    def at_b(self) -> bool:
        """Whether it holds B."""
        return self in (Drive.B0, Drive.SLIDER)


def _unknown() -> ComplexArray:
    return np.zeros(0, dtype=complex)


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidates(Batch):
    """D designs of one kind that hold a body at N positions.

    The body is the coupler; its moving pivots are A and B, its guided point is P.

    Parameters
    ----------
    kind : LoopKind
    fixed_a : (D,) complex
        The fixed pivot A0 [length].
    fixed_b : (D,) complex
        The fixed pivot B0, or a point of the line on which B slides [length].
    direction : (D,) complex
        The unit vector of that line; 0 for a four-bar. An inverted slider-crank has a line of the
        coupler, through B, which slides through B0: its unit vector, seen along B - A.
    moving_a, moving_b : (D, N) complex
        The moving pivots at the positions [length].
    guided : (D, N) complex
        The guided point P at the positions; by default A [length].
    error : (D,)
        A bound of the error of every pivot at every position [length]; infinite where no proof
        holds.
    miss : (D,)
        How far the design misses the positions of the task, in their unit; 0 for exact ones.
    direction_a : (D,) complex, optional
        The unit vector of the line on which A slides, through ``fixed_a``; of an Oldham coupling
        that of the body's line through A and A0, seen along B - A. 0 where A turns about A0.
    """

    kind: LoopKind
    fixed_a: ComplexArray
    fixed_b: ComplexArray
    moving_a: ComplexArray
    moving_b: ComplexArray
    error: Array
    guided: ComplexArray = field(default_factory=_unknown)
    direction: ComplexArray = field(default_factory=_unknown)
    direction_a: ComplexArray = field(default_factory=_unknown)
    miss: Array = field(default_factory=lambda: _unknown().real)

    def __post_init__(self) -> None:
        usual = {
            "guided": self.moving_a,
            "direction": np.zeros_like(self.fixed_a),
            "direction_a": np.zeros_like(self.fixed_a),
            "miss": np.zeros_like(self.error),
        }
        for name, array in usual.items():
            if not getattr(self, name).size:
                object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.fixed_a)

    @property
    def drives(self) -> tuple[Drive, ...]:
        """The links that can be driven."""
        one, other = self.kind.sides
        first = Drive.SLIDER_A if one is Side.LINE else Drive.A0
        return first, Drive.SLIDER if other is Side.LINE else Drive.B0

    @property
    def lines(self) -> ComplexArray:
        """The unit vectors (D, N) of the body's lines through B that slide in blocks at B0."""
        return self._seen_along(self.direction)

    @property
    def lines_a(self) -> ComplexArray:
        """Those of the body's lines through A that slide in blocks at A0."""
        return self._seen_along(self.direction_a)

    def _seen_along(self, direction: ComplexArray) -> ComplexArray:
        along = self.moving_b - self.moving_a
        return np.asarray(direction[:, None] * along / np.abs(along))

    def driven_by(self, drive: Drive) -> tuple[Candidates, Side, Side]:
        """The same designs with the driven side called A, and how both sides are held."""
        one, other = self.kind.sides
        if not drive.at_b:
            return self, one, other
        # lines of the body in the frame of B - A, in the frame of A - B
        signs = [-1.0 if side is Side.BLOCK else 1.0 for side in (one, other)]
        exchanged = replace(
            self,
            direction=signs[0] * self.direction_a,
            direction_a=signs[1] * self.direction,
            fixed_a=self.fixed_b,
            fixed_b=self.fixed_a,
            moving_a=self.moving_b,
            moving_b=self.moving_a,
        )
        return exchanged, other, one

    def moved(self, shift: complex, factor: complex) -> Candidates:
        """The same designs turned and enlarged by a factor about 0, then moved."""
        places = ("fixed_a", "fixed_b", "moving_a", "moving_b", "guided")
        changes: dict[str, Any] = {name: shift + factor * getattr(self, name) for name in places}
        size = abs(factor)
        rounding = 8.0 * UNIT_ROUNDOFF * (abs(shift) + size * np.abs(self.moving_b).max(axis=1))
        return replace(
            self,
            direction=self.direction * (1.0 if self.kind.body_line else factor / size),
            direction_a=self.direction_a * (1.0 if self.kind is LoopKind.OLDHAM else factor / size),
            error=self.error * size + rounding,
            **changes,
        )


# ----------------------------------------------------------------------
# The limits of one loop with an input, as verdicts need them, with bounds of all errors.


# roundings of a vector between two points, its length, and sums of four lengths
_VECTOR = 16.0 * UNIT_ROUNDOFF
#: Of a product of two vectors, with errors ε: |v| ε + |w| ε + ε² and the rounding of the product.
PRODUCT = 2.25


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenLoops(Batch):
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
    cosine : (D, 2)
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
    cosine: Array
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
        c0, c1 = self.cosine.T
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
# One loop and its input: where it can move, with bounds of the errors of every sign.
#
# The driven side is called A. With the input φ (an angle) or s (a displacement along a line) the
# loop closes where
#
#     low ≤ q ≤ high,    q = q0 + q1 cos(φ - φ0)  or  q = q0 + s²,                         eq. (144)
#
# | driven side, other side | q | low, high | the side of the loop: sign of |
# |---|---|---|---|
# | crank or slider, rocker | \|A - B0\|² | (b - c)², (b + c)² | (B - A) × (B - B0) |
# | crank or slider, block | \|A - B0\|² | h², ∞ | (B0 - A) · line of the body |
# | crank, slider | distance of A from the line | -c, c | (B - A) · line |
# | slider, slider | s² | none, (c / sin α)² | (B - A) · line of B |
# | block, rocker | (B - B0) across the line | -b, b | (B - B0) · line of the body |
# | block, slider | cos φ | -1, 1 | none |
# | block, block | none | none | none |
#
# h is the distance of A from the body's line, which slides in the block at B0; α is the angle
# between two fixed lines, c the distance of A and B. A block that turns the line of the body
# parallel to a fixed line drives B to infinity: both limits are reached, and leave two circuits.
#
# A loop changes its side only at a limit, which is a dead point. Each limit that is reached cuts
# the circle of inputs around one of its poles φ0, φ0 + π: two limits leave two circuits, one limit
# one circuit, none two circuits that differ in their side.


def driven_loops(candidates: Candidates, drive: Drive) -> DrivenLoops:
    """The loops of designs with one driven link."""
    driven, driver, other = candidates.driven_by(drive)
    if driver is Side.BLOCK:
        of_blocks = {Side.PIN: _block_and_rocker, Side.LINE: _block_and_slider, Side.BLOCK: _blocks}
        return of_blocks[other](driven)
    if other is Side.LINE:
        return (_crank_and_slider if driver is Side.PIN else _sliders)(driven)
    return _to_pivot(driven, driver, other)


def _to_pivot(driven: Candidates, driver: Side, other: Side) -> DrivenLoops:
    """A crank or a slider brings A to a distance from B0 that a rocker or a block allows."""
    arm = driven.moving_a - driven.fixed_a[:, None]
    coupler = driven.moving_b - driven.moving_a
    rocker = driven.moving_b - driven.fixed_b[:, None]
    to_block = driven.fixed_b[:, None] - driven.moving_a
    ground = driven.fixed_b - driven.fixed_a
    a, b, c, g = (np.abs(v) for v in (arm[:, 0], rocker[:, 0], coupler[:, 0], ground))
    size = np.maximum(np.abs(arm).max(axis=1), g)
    if other is Side.PIN:
        size = np.maximum(size, np.maximum(b, c))
        doubt = doubt_of(driven, size)
    else:
        size = np.maximum(size, np.abs(to_block).max(axis=1))
        doubt = 2.0 * doubt_of(driven, size)
    if driver is Side.PIN:
        near, far = np.abs(a - g), a + g
        input_of: dict[str, Any] = {
            "input": phase_of(arm),
            "input_error": angle_error(a, doubt),
            "origin": phase_of(ground) + np.pi,
            "q0": a**2 + g**2,
            "q1": 2.0 * a * g,
            "half": cross(arm, ground[:, None]),
        }
    else:
        foot, height = dot(driven.direction_a, ground), cross(driven.direction_a, ground)
        s = dot(driven.direction_a[:, None], arm)
        # a slider far enough away reaches the outer limit always
        near, far = np.abs(height), np.full_like(g, np.inf)
        input_of = {
            "input": s,
            "input_error": 4.0 * doubt,
            "origin": foot,
            "q0": height**2,
            "q1": np.ones_like(g),
            "half": size[:, None] * (s - foot[:, None]),
        }
    if other is Side.PIN:
        with np.errstate(all="ignore"):
            cosine = np.stack([(b**2 + c**2) / (2.0 * b * c), -1.0 / (2.0 * b * c)], axis=1)
        limits_of: dict[str, Any] = {
            "low": (b - c) ** 2,
            "high": (b + c) ** 2,
            "upper": far - (b + c),
            "lower": np.abs(b - c) - near,
            "side": cross(coupler, rocker),
            "cosine": cosine,
        }
    else:
        lines = driven.lines
        h = np.abs(cross(lines[:, 0], to_block[:, 0]))
        limits_of = {
            "low": h**2,
            "high": np.full_like(h, np.inf),
            # a block on an endless line limits one side only
            "upper": np.full_like(h, -np.inf),
            "lower": h - near,
            "side": size[:, None] * dot(lines, to_block),
            # rounding alone makes an offset of zero positive
            "offset": h + doubt,
        }
    return _loops(
        doubt, size, turns=driver is Side.PIN, q_error=4.0 * PRODUCT * size * doubt,
        **input_of, **limits_of,
    )  # fmt: skip


def _crank_and_slider(driven: Candidates) -> DrivenLoops:
    crank = driven.moving_a - driven.fixed_a[:, None]
    rod = driven.moving_b - driven.moving_a
    normal = 1j * driven.direction
    a, c = np.abs(crank[:, 0]), np.abs(rod[:, 0])
    height = dot(normal, driven.fixed_a - driven.fixed_b)
    size = np.maximum(np.maximum(a, c), np.abs(driven.fixed_a - driven.fixed_b))
    doubt = doubt_of(driven, size)
    return _loops(
        doubt,
        input=phase_of(crank),
        input_error=angle_error(a, doubt),
        origin=phase_of(normal),
        side=dot(rod, driven.direction[:, None]),
        half=cross(normal[:, None], crank),
        **_swing(height, a, c),
    )


def _sliders(driven: Candidates) -> DrivenLoops:
    rod, line = driven.moving_b - driven.moving_a, driven.direction
    c, sine = np.abs(rod[:, 0]), np.abs(cross(driven.direction_a, line))
    s = dot(driven.direction_a[:, None], driven.moving_a - driven.fixed_a[:, None])
    ground = driven.fixed_b - driven.fixed_a
    size = np.maximum(c, np.abs(driven.moving_b - driven.fixed_b[:, None]).max(axis=1))
    doubt = doubt_of(driven, np.maximum(size, np.abs(ground)))
    with np.errstate(all="ignore"):
        # of the crossing of two lines, and of distances from it
        origin = cross(ground, line) / cross(driven.direction_a, line)
        place_error = 4.0 * doubt / sine
        farthest = np.maximum(np.abs(s - origin[:, None]).max(axis=1), c / sine)
        high = (c / sine) ** 2
        cosine = np.stack([np.zeros_like(c), 1.0 / high], axis=1)
    return _loops(
        doubt,
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
        q_error=PRODUCT * (2.0 * farthest + place_error) * place_error,
        cosine=cosine,
        squared=True,
    )


def _block_and_rocker(driven: Candidates) -> DrivenLoops:
    rocker = driven.moving_b - driven.fixed_b[:, None]
    ground = driven.fixed_b - driven.fixed_a
    to_block, lines = driven.fixed_a[:, None] - driven.moving_b, driven.lines_a
    b, g = np.abs(rocker[:, 0]), np.abs(ground)
    # B is h to the right of the line, B0 is g cos(φ - φ0) to the right of its parallel through A0
    h = cross(lines[:, 0], to_block[:, 0])
    size = np.maximum(np.maximum(b, g), np.abs(to_block).max(axis=1))
    doubt = 2.0 * doubt_of(driven, size)
    return _loops(
        doubt,
        input=phase_of(lines),
        input_error=angle_error(size, doubt),
        origin=phase_of(ground) + 0.5 * np.pi,
        side=dot(rocker, lines),
        half=cross(1j * ground[:, None], lines),
        **_swing(-h, g, b),
    )


def _swing(q0: Array, q1: Array, length: Array) -> dict[str, Array]:
    """Limits of a point that swings across a line, q0 + q1 cos(φ - φ0), held by a link."""
    with np.errstate(all="ignore"):
        cosine = np.stack([np.zeros_like(length), 1.0 / length], axis=1)
    return {
        "q0": q0,
        "q1": q1,
        "low": -length,
        "high": length,
        "upper": q0 + q1 - length,
        "lower": q1 - q0 - length,
        "cosine": cosine,
    }


def _block_and_slider(driven: Candidates) -> DrivenLoops:
    to_block, lines = driven.fixed_a[:, None] - driven.moving_b, driven.lines_a
    size = np.abs(to_block).max(axis=1)
    doubt = 2.0 * doubt_of(driven, size)
    none, one = np.zeros_like(size), np.ones_like(size)
    error = angle_error(size, doubt)
    return _loops(
        doubt,
        input=phase_of(lines),
        input_error=error,
        origin=phase_of(driven.direction),
        q0=none,
        q1=one,
        low=-one,
        high=one,
        upper=size,
        lower=size,
        side=np.broadcast_to(size[:, None], lines.shape),
        half=size[:, None] * cross(driven.direction[:, None], lines),
        q_error=4.0 * error,
        cosine=np.stack([none, one], axis=1),
    )


def _blocks(driven: Candidates) -> DrivenLoops:
    lines, none = driven.lines_a, np.zeros(len(driven))
    ground = np.abs(driven.fixed_b - driven.fixed_a)
    doubt = 2.0 * doubt_of(driven, ground)
    arm = np.abs(driven.moving_a - driven.fixed_a[:, None]).max(axis=1) + ground
    return _loops(
        0.0 * none,
        input=phase_of(lines),
        input_error=angle_error(arm, doubt),
        origin=none,
        q0=none,
        q1=none,
        low=none - np.inf,
        high=none + np.inf,
        upper=none - np.inf,
        lower=none - np.inf,
        side=np.ones(lines.shape),
        half=np.ones(lines.shape),
        # both blocks turn alike; the force of one acts across its line
        cosine=np.stack([dot(driven.direction_a, driven.direction), none], axis=1),
    )


def _loops(doubt: Array, size: Array | float = 1.0, **numbers: Any) -> DrivenLoops:
    """Loops whose errors are those of lengths with errors ``doubt`` (D,), or of their products with
    lengths of some size, unless they are given.
    """
    usual = {
        "turns": True,
        "limit_error": 4.0 * doubt,
        "sign_error": PRODUCT * size * doubt,
        "q_error": 4.0 * doubt,
        "cosine": np.zeros((len(doubt), 2)),
        "offset": np.zeros_like(doubt),
    }
    return DrivenLoops(**{**usual, **numbers})


def meeting(
    one: ComplexArray, along: ComplexArray, other: ComplexArray, across: ComplexArray
) -> ComplexArray:
    """Where lines through points meet."""
    return np.asarray(one + along * cross(other - one, across) / cross(along, across))
