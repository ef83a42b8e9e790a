"""Sizes of forces that follow from other forces: friction, the tension of belts, teeth that push
apart.

All are convex and grow in proportion to the forces, apart from a constant. u are the values of the
unknowns from which a size follows, (B, m).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["LargerOf", "Linear", "NormOf", "Sided", "Size"]


class Size(Protocol):
    """The size of a force as a function of unknowns."""

    @property
    def unknowns(self) -> tuple[int, ...]:
        """The numbers of the unknowns from which it follows, m."""

    def value(self, u: Array) -> Array:
        """The size, (B,)."""

    def gradient(self, u: Array) -> Array:
        """Its derivatives by u, (B, m); at an edge those of one side."""

    def bend(self, u: Array, reach: Array) -> Array:
        """The most that the gradient changes per change of u within a distance, (B,).

        Infinite where that includes an edge.
        """

    def rows(self, which: IndexArray) -> Size:
        """The size in some rows."""

    def side(self, u: Array) -> int:
        """The side of its edges on which unknowns (m,) are."""

    def inside(self, u: Array, side: int) -> Array:
        """How far unknowns (B, m) are on a side: negative beyond its edge, (B,)."""

    def smooth(self, side: int) -> Size:
        """The size as it is on a side, continued smoothly beyond its edges."""


@dataclass(frozen=True, kw_only=True, eq=False)
class NormOf:
    """``factor`` times the size of a vector of two components."""

    unknowns: tuple[int, int]
    factor: float

    def value(self, u: Array) -> Array:
        found: Array = self.factor * np.hypot(u[:, 0], u[:, 1])
        return found

    def gradient(self, u: Array) -> Array:
        size = np.hypot(u[:, 0], u[:, 1])[:, None]
        return np.where(size > 0.0, self.factor * u / np.where(size > 0.0, size, 1.0), 0.0)

    def bend(self, u: Array, reach: Array) -> Array:
        size = np.hypot(u[:, 0], u[:, 1])
        # a unit vector turns by at most the change over the smaller of both sizes
        return np.where(reach <= size / 2.0, self.factor * 2.0 / size, np.inf)

    def rows(self, which: IndexArray) -> NormOf:
        return self

    def side(self, u: Array) -> int:
        return 0

    def inside(self, u: Array, side: int) -> Array:
        return np.ones(len(u))

    def smooth(self, side: int) -> NormOf:
        return self


@dataclass(frozen=True, kw_only=True, eq=False)
class Sided:
    """A number times ``plus`` where it is positive, times ``minus`` where not, and a constant."""

    unknowns: tuple[int]
    plus: Array | float
    minus: Array | float
    constant: float = 0.0

    def value(self, u: Array) -> Array:
        found: Array = np.maximum(u[:, 0], 0.0) * self.plus - np.minimum(u[:, 0], 0.0) * self.minus
        return found + self.constant

    def gradient(self, u: Array) -> Array:
        return np.where(u[:, 0] >= 0.0, self.plus, -np.asarray(self.minus))[:, None]

    def bend(self, u: Array, reach: Array) -> Array:
        return np.where(reach < np.abs(u[:, 0]), 0.0, np.inf)

    def rows(self, which: IndexArray) -> Sided:
        plus, minus = (
            side[which] if isinstance(side, np.ndarray) and side.ndim else side
            for side in (self.plus, self.minus)
        )
        return Sided(unknowns=self.unknowns, plus=plus, minus=minus, constant=self.constant)

    def side(self, u: Array) -> int:
        return 1 if u[0] >= 0.0 else -1

    def inside(self, u: Array, side: int) -> Array:
        found: Array = side * u[:, 0]
        return found

    def smooth(self, side: int) -> Linear:
        factor = self.plus if side > 0 else -np.asarray(self.minus)
        return Linear(unknowns=self.unknowns, factors=(factor,), constant=self.constant)


@dataclass(frozen=True, kw_only=True, eq=False)
class LargerOf:
    """The larger of two numbers times ``factors``, without signs."""

    unknowns: tuple[int, int]
    factors: tuple[float, float]

    def value(self, u: Array) -> Array:
        found: Array = np.max(np.abs(u) * self.factors, axis=1)
        return found

    def gradient(self, u: Array) -> Array:
        sizes = np.abs(u) * self.factors
        first = (sizes[:, 0] >= sizes[:, 1])[:, None]
        chosen = np.where(np.concatenate([first, ~first], axis=1), self.factors, 0.0)
        return chosen * np.where(u >= 0.0, 1.0, -1.0)

    def bend(self, u: Array, reach: Array) -> Array:
        sizes = np.abs(u) * self.factors
        apart = np.abs(sizes[:, 0] - sizes[:, 1])
        return np.where(reach * sum(self.factors) < apart, 0.0, np.inf)

    def rows(self, which: IndexArray) -> LargerOf:
        return self

    def side(self, u: Array) -> int:
        larger = int(np.argmax(np.abs(u) * self.factors))
        return larger + 1 if u[larger] >= 0.0 else -larger - 1

    def inside(self, u: Array, side: int) -> Array:
        larger = abs(side) - 1
        other = np.abs(u[:, 1 - larger]) * self.factors[1 - larger]
        found: Array = np.sign(side) * u[:, larger] * self.factors[larger] - other
        return found

    def smooth(self, side: int) -> Linear:
        larger = abs(side) - 1
        factors = [0.0, 0.0]
        factors[larger] = math.copysign(self.factors[larger], side)
        return Linear(unknowns=self.unknowns, factors=tuple(factors))


@dataclass(frozen=True, kw_only=True, eq=False)
class Linear:
    """A sum of unknowns times ``factors`` and a constant: another size on one side of its edges."""

    unknowns: tuple[int, ...]
    factors: tuple[Array | float, ...]
    constant: float = 0.0

    def value(self, u: Array) -> Array:
        found: Array = self.constant + (u * self.gradient(u)).sum(axis=1)
        return found

    def gradient(self, u: Array) -> Array:
        found = np.empty_like(u)
        for k, factor in enumerate(self.factors):
            found[:, k] = factor
        return found

    def bend(self, u: Array, reach: Array) -> Array:
        return np.zeros(len(u))

    def rows(self, which: IndexArray) -> Linear:
        factors = tuple(
            own[which] if isinstance(own, np.ndarray) and own.ndim else own for own in self.factors
        )
        return Linear(unknowns=self.unknowns, factors=factors, constant=self.constant)

    def side(self, u: Array) -> int:
        return 0

    def inside(self, u: Array, side: int) -> Array:
        return np.ones(len(u))

    def smooth(self, side: int) -> Linear:
        return self
