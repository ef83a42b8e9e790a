"""Dyads and loops that linear equations determine: circumcentres and Freudenstein's equation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array, Batch, BoolArray, ComplexArray
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF

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
