"""Four-bars and slider-cranks that guide a body through positions, many of one kind at once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from enum import Enum
from typing import Any

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.foundation.rounding import UNIT_ROUNDOFF

__all__ = ["Candidates", "Drive", "LoopKind"]


class LoopKind(Enum):
    """A mechanism of one loop that guides a body; the value is its name in files."""

    FOUR_BAR = "four-bar"
    SLIDER_CRANK = "slider-crank"
    INVERTED = "inverted-slider-crank"


class Drive(Enum):
    """The driven link: the crank at A0, the crank or swivelling block at B0, or the slider."""

    A0 = "A0"
    B0 = "B0"
    SLIDER = "slider"


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidates:
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
        The guided point P at the positions [length].
    error : (D,)
        A bound of the error of every pivot at every position [length]; infinite where no proof
        holds.
    miss : (D,)
        How far the design passes the wanted positions, in their unit; 0 for exact ones.
    """

    kind: LoopKind
    fixed_a: ComplexArray
    fixed_b: ComplexArray
    direction: ComplexArray
    moving_a: ComplexArray
    moving_b: ComplexArray
    guided: ComplexArray
    error: Array
    miss: Array

    def __len__(self) -> int:
        return len(self.fixed_a)

    @property
    def drives(self) -> tuple[Drive, ...]:
        """The links that can be driven."""
        other = Drive.SLIDER if self.kind is LoopKind.SLIDER_CRANK else Drive.B0
        return Drive.A0, other

    @property
    def lines(self) -> ComplexArray:
        """The unit vectors (D, N) of the lines of couplers of inverted slider-cranks."""
        along = self.moving_b - self.moving_a
        return np.asarray(self.direction[:, None] * along / np.abs(along))

    def take(self, index: IndexArray | slice) -> Candidates:
        """Some of the designs, in the order of ``index``."""
        changes = {name: getattr(self, name)[index] for name in _ARRAYS}
        return replace(self, **changes)

    def driven_at_b(self) -> Candidates:
        """The same four-bars with the names of both sides exchanged."""
        return replace(
            self,
            fixed_a=self.fixed_b,
            fixed_b=self.fixed_a,
            moving_a=self.moving_b,
            moving_b=self.moving_a,
        )

    def moved(self, shift: complex, factor: complex) -> Candidates:
        """The same designs turned and enlarged by a factor about 0, then moved."""
        places = ("fixed_a", "fixed_b", "moving_a", "moving_b", "guided")
        changes: dict[str, Any] = {name: shift + factor * getattr(self, name) for name in places}
        size = abs(factor)
        rounding = 8.0 * UNIT_ROUNDOFF * (abs(shift) + size * np.abs(self.moving_b).max(axis=1))
        return replace(
            self,
            direction=self.direction * (1.0 if self.kind is LoopKind.INVERTED else factor / size),
            error=self.error * size + rounding,
            **changes,
        )

    @classmethod
    def joined(cls, parts: Iterable[Candidates]) -> Candidates:
        """Designs of one kind in one container."""
        found = list(parts)
        together = {
            name: np.concatenate([getattr(part, name) for part in found]) for name in _ARRAYS
        }
        return cls(kind=found[0].kind, **together)


_ARRAYS = tuple(field.name for field in fields(Candidates) if field.name != "kind")
