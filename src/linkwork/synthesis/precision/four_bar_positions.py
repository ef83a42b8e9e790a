"""Four-bars in the positions of a task, proved or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.synthesis.precision.positions import PrecisionPositions
from linkwork.synthesis.precision.proofs import ProvedLinkages


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class FourBarPositions:
    """D four-bars in the J positions of a task.

    Parameters
    ----------
    fixed_a, fixed_b : (D,) complex
        Fixed pivots A0, B0 [length].
    moving_a, moving_b : (D, J) complex
        Moving pivots A, B in all positions, in the order of the task [length].
    guided : (D, J) complex
        The traced point there [length].
    proved : (D,) bool
    error : (D,)
        A bound of the error of every pivot [length]; infinite where it is not proved.
    """

    fixed_a: ComplexArray
    fixed_b: ComplexArray
    moving_a: ComplexArray
    moving_b: ComplexArray
    guided: ComplexArray
    proved: BoolArray
    error: Array

    def __len__(self) -> int:
        return len(self.fixed_a)

    @classmethod
    def of(cls, positions: PrecisionPositions, proofs: ProvedLinkages, **further: object) -> Self:
        """The linkages of proofs, in the order of the task; ``further``: fields of a subclass."""
        x, a, y, b = proofs.legs.T
        points = np.concatenate([[positions.start], positions.poses, positions.points])
        moving = np.concatenate([np.stack([x, y], axis=1)[:, None], proofs.moving], axis=1)
        places = np.argsort(positions.order)[: positions.listed]
        moving = (moving + points[:, None])[:, places]
        return cls(
            fixed_a=positions.start + a,
            fixed_b=positions.start + b,
            moving_a=moving[:, :, 0],
            moving_b=moving[:, :, 1],
            guided=np.broadcast_to(points[places], moving.shape[:2]).copy(),
            proved=proofs.holds,
            error=proofs.error,
            **further,
        )

    def take(self, index: IndexArray) -> FourBarPositions:
        """Some of the four-bars."""
        arrays = {name: getattr(self, name)[index] for name in _ARRAYS}
        return FourBarPositions(**arrays)

    @classmethod
    def joined(cls, parts: Sequence[FourBarPositions]) -> FourBarPositions:
        """The four-bars of several sets, in their order."""
        return FourBarPositions(
            **{name: np.concatenate([getattr(p, name) for p in parts]) for name in _ARRAYS}
        )

    @property
    def lengths(self) -> Array:
        """Ground, crank at A0, coupler and rocker at B0, (D, 4) [length]."""
        a, b = self.moving_a[:, 0], self.moving_b[:, 0]
        ends = (self.fixed_b - self.fixed_a, a - self.fixed_a, b - a, b - self.fixed_b)
        return np.abs(np.stack(ends, axis=1))


_ARRAYS = tuple(field.name for field in fields(FourBarPositions))
