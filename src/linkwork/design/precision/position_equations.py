"""The conditions of a four-bar's positions as quadratic equations with whole coefficients.

Moving pivots A_j and B_j in position j, seen from the traced point there, are unknowns of their
own. With x, y of the first position and the fixed pivots a, b, all seen from its point,

    |δ|² + 2 Re((A - a) δ̄) - 2 Re((A - x) ā) = 0,   alike with B, b and y,
    |A|² = |x|²,   B x = A y,      or in a pose  A = e x,   B = e y.

They are real equations of real numbers v: the unknowns, the given numbers and 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from linkwork.design.precision.positions import PrecisionPositions
from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["FurtherConditions", "GivenLength", "PositionEquations", "position_equations"]

_Complex = tuple[int, int]  # the places in v of a real and an imaginary part


@dataclass(frozen=True)
class GivenLength:
    """The distance of two of A0, B0, A, B and the traced point P [length]."""

    one: str
    other: str
    length: float


@dataclass(frozen=True, kw_only=True)
class FurtherConditions:
    """Conditions besides positions.

    Parameters
    ----------
    lengths : tuple of GivenLength
    held : tuple of (int, float)
        Coordinates of pivots that keep a value: their place among x, [a], y, [b], seen from the
        first position [length].
    """

    lengths: tuple[GivenLength, ...] = ()
    held: tuple[tuple[int, float], ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionEquations:
    """Sums of products k v_i v_j.

    Parameters
    ----------
    unknowns : int
        n, the first numbers of v; there are as many equations.
    size : int
        How many numbers v has; the last one is 1.
    row, factor, one, other : (T,)
        The equation of every product, k, i and j.
    legs, moving : places of x, a, y, b in v, and of A and B in the positions after the first.
    """

    unknowns: int
    size: int
    row: IndexArray
    factor: IndexArray
    one: IndexArray
    other: IndexArray
    legs: tuple[_Complex, ...]
    moving: tuple[tuple[_Complex, _Complex], ...]

    def exact_residual(self, v: Sequence[int]) -> list[int]:
        """F of whole numbers v, without rounding, in the square of their unit."""
        found = [0] * self.unknowns
        terms = (x.tolist() for x in (self.row, self.factor, self.one, self.other))
        for row, factor, i, j in zip(*terms, strict=True):
            found[row] += factor * v[i] * v[j]
        return found

    def jacobian(self, v: Array) -> Array:
        """∂F/∂v by the unknowns (B, n, n) at v (B, V)."""
        return self._slopes(v, self.factor)

    def jacobian_size(self, v: Array) -> Array:
        """The same with all terms positive, for |v| (B, V)."""
        return self._slopes(v, np.abs(self.factor))

    def _slopes(self, v: Array, factors: IndexArray) -> Array:
        wide = np.zeros((self.unknowns, self.size, len(v)))
        terms = (x.tolist() for x in (self.row, factors, self.one, self.other))
        for row, factor, i, j in zip(*terms, strict=True):
            wide[row, i] += factor * v[:, j]
            wide[row, j] += factor * v[:, i]
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
class _Writer:
    """Collects products; complex numbers are pairs of places in v."""

    rows: list[tuple[int, int, int, int]] = field(default_factory=list)
    count: int = 0

    def equation(self, *terms: tuple[int, int, int]) -> None:
        self.rows += [(self.count, *term) for term in terms]
        self.count += 1

    def leg(self, moved: _Complex, start: _Complex, fixed: _Complex, delta: _Complex) -> None:
        """|δ|² + 2 Re((A - a) δ̄) - 2 Re((A - x) ā) = 0."""
        self.equation(
            *[(1, d, d) for d in delta],
            *[(2, m, d) for m, d in zip(moved, delta, strict=True)],
            *[(-2, f, d) for f, d in zip(fixed, delta, strict=True)],
            *[(-2, m, f) for m, f in zip(moved, fixed, strict=True)],
            *[(2, s, f) for s, f in zip(start, fixed, strict=True)],
        )

    def equal_lengths(self, one: _Complex, other: _Complex) -> None:
        """|A|² = |x|²."""
        self.equation(*[(1, k, k) for k in one], *[(-1, k, k) for k in other])

    def given_length(self, one: _Complex, other: _Complex | None, length: int) -> None:
        """|A - B|² = L²; ``None`` is the traced point, from which all is seen."""
        terms = [(1, k, k) for k in one]
        if other is not None:
            terms += [(1, k, k) for k in other]
            terms += [(-2, k, i) for k, i in zip(one, other, strict=True)]
        self.equation(*terms, (-1, length, length))

    def equal_products(self, a: _Complex, b: _Complex, c: _Complex, d: _Complex) -> None:
        """a b = c d."""
        self.equation((1, a[0], b[0]), (-1, a[1], b[1]), (-1, c[0], d[0]), (1, c[1], d[1]))
        self.equation((1, a[0], b[1]), (1, a[1], b[0]), (-1, c[0], d[1]), (-1, c[1], d[0]))


def position_equations(
    given: PrecisionPositions, further: FurtherConditions | None = None
) -> PositionEquations:
    """The equations; v is x, [a], y, [b], all A_j and B_j, then a, b as far as they are given,
    e of all poses, δ of all positions, given lengths and held values, each with 0, then 1 and 0.
    """
    further = further or FurtherConditions()
    free = iter(range(0, 10_000, 2))

    def place() -> _Complex:
        first = next(free)
        return first, first + 1

    pivots = len(given.pivots)
    count = len(given.poses) + len(given.points)
    x, a = place(), (0, 0) if pivots > 0 else place()
    y, b = place(), (0, 0) if pivots > 1 else place()
    moving = tuple((place(), place()) for _ in range(count))
    unknowns = (8 - 2 * pivots) + 4 * count
    a = place() if pivots > 0 else a
    b = place() if pivots > 1 else b
    turns = [place() for _ in given.poses]
    deltas = [place() for _ in range(count)]
    lengths = [place()[0] for _ in further.lengths]
    values = [place()[0] for _ in further.held]
    one = place()
    writer = _Writer()
    for k, ((left, right), delta) in enumerate(zip(moving, deltas, strict=True)):
        writer.leg(left, x, a, delta)  # eq. (114)
        writer.leg(right, y, b, delta)
        if k < len(turns):
            writer.equal_products(left, one, turns[k], x)
            writer.equal_products(right, one, turns[k], y)
        else:
            writer.equal_lengths(left, x)
            writer.equal_products(right, x, left, y)
    named = {"A": x, "A0": a, "B": y, "B0": b}
    for entry, length in zip(further.lengths, lengths, strict=True):
        ends = [named[end] for end in (entry.one, entry.other) if end in named]
        writer.given_length(ends[0], ends[1] if len(ends) > 1 else None, length)
    for (k, _), value in zip(further.held, values, strict=True):
        writer.equation((1, k, one[0]), (-1, value, one[0]))
    terms = np.array(writer.rows, dtype=np.intp).T
    return PositionEquations(
        unknowns=unknowns,
        size=one[1] + 1,
        row=terms[0],
        factor=terms[1],
        one=terms[2],
        other=terms[3],
        legs=(x, a, y, b),
        moving=moving,
    )
