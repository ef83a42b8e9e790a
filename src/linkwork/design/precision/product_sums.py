"""Quadratic equations with whole coefficients, as sums of products of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["ComplexPlace", "ProductSums", "ProductWriter"]

ComplexPlace = tuple[int, int]  # the places in v of a real and an imaginary part


@dataclass(frozen=True, kw_only=True, eq=False)
class ProductSums:
    """Sums of products k v_i v_j.

    Parameters
    ----------
    unknowns : int
        n, the first numbers of v; there are as many equations.
    size : int
        How many numbers v has; the last but one is 1.
    row, factor, one, other : (T,)
        The equation of every product, k, i and j.
    """

    unknowns: int
    size: int
    row: IndexArray
    factor: IndexArray
    one: IndexArray
    other: IndexArray

    def exact_residual(self, v: Sequence[int]) -> list[int]:
        """F of whole numbers v, without rounding, in the square of their unit."""
        found = [0] * self.unknowns
        for row, factor, i, j in self._terms:
            found[row] += factor * v[i] * v[j]
        return found

    @cached_property
    def _terms(self) -> list[tuple[int, int, int, int]]:
        """The equation of every product, k, i and j, as plain numbers."""
        columns = (x.tolist() for x in (self.row, self.factor, self.one, self.other))
        return list(zip(*columns, strict=True))

    def jacobian(self, v: Array) -> Array:
        """∂F/∂v by the unknowns (B, n, n) at v (B, V)."""
        return self._slopes(v, 1)

    def jacobian_size(self, v: Array) -> Array:
        """The same with all terms positive, for |v| (B, V)."""
        return self._slopes(v, -1)

    def _slopes(self, v: Array, negative: int) -> Array:
        """``negative``: -1 turns negative factors."""
        wide = np.zeros((self.unknowns, self.size, len(v)))
        for row, factor, i, j in self._terms:
            own = factor if factor > 0 else negative * factor
            wide[row, i] += own * v[:, j]
            wide[row, j] += own * v[:, i]
        return np.ascontiguousarray(wide[:, : self.unknowns].transpose(2, 0, 1))

    def curvature(self, weights: Array) -> Array:
        """Bounds of D²F along directions of the largest norm 1 in weights (B, n), (B, n)."""
        own = (self.one < self.unknowns) & (self.other < self.unknowns)
        found = np.zeros((self.unknowns, len(weights)))
        for row, factor, i, j in zip(
            self.row[own], np.abs(self.factor[own]), self.one[own], self.other[own], strict=True
        ):
            found[row] += 2.0 * factor * weights[:, i] * weights[:, j]
        return found.T


@dataclass
class ProductWriter:
    """Collects products; complex numbers are pairs of places in v."""

    rows: list[tuple[int, int, int, int]] = field(default_factory=list)
    count: int = 0

    def equation(self, *terms: tuple[int, int, int]) -> None:
        self.rows += [(self.count, *term) for term in terms]
        self.count += 1

    def equal_lengths(self, one: ComplexPlace, other: ComplexPlace) -> None:
        """|A|² = |x|²."""
        self.equation(*[(1, k, k) for k in one], *[(-1, k, k) for k in other])

    def equal_products(
        self, a: ComplexPlace, b: ComplexPlace, c: ComplexPlace, d: ComplexPlace
    ) -> None:
        """a b = c d."""
        self.equation((1, a[0], b[0]), (-1, a[1], b[1]), (-1, c[0], d[0]), (1, c[1], d[1]))
        self.equation((1, a[0], b[1]), (1, a[1], b[0]), (-1, c[0], d[1]), (-1, c[1], d[0]))

    def sums(self, unknowns: int, size: int) -> ProductSums:
        """The equations of ``unknowns`` numbers, the first of ``size``."""
        row, factor, one, other = np.array(self.rows, dtype=np.intp).T
        return ProductSums(
            unknowns=unknowns, size=size, row=row, factor=factor, one=one, other=other
        )
