"""Laman numbers: how many solutions closures over directions and lengths have almost always.

With x = (U, 1) in the null space of the closures and y = (V, 1) in that of their conjugates, a
block without lengths requires pairs with the products U_k V_k = 1, one for each link, the ground
among them (:mod:`linkwork.numerics.homotopy.matroid_pair`). With one coordinate for each bar of a
framework their number is the framework's Laman number; rigid links with more than two joints need
no bars.

Lengths, U_z V_a = U_a V_z along a direction a, are counted at the limit where the ratios
U_z V_a / U_a V_z, which are 1 for real lengths, differ beyond all bounds: they are powers of a
small number with random exponents. Coordinates of solutions are then powers, too. Those of x with
equal exponents form a level, and so do those of y; a direction's exponents in x and y are opposite.
For every order of levels the exponents follow from those of the ratios, and the order counts where
they are in that order (docs/decisions/0008).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np

from linkwork.numerics.homotopy.column_sums import Columns
from linkwork.numerics.homotopy.matroid_pair import MatroidPair

__all__ = ["laman_number"]

_MOST_STEPS = 10_000  # beginnings of orders that are looked at, in less than a second
_LARGEST = 10**9  # exponents are random whole numbers up to this one
_SEED = 1905


def laman_number(columns: Columns, lengths: Sequence[tuple[int, int]] = ()) -> int:
    """How many solutions closures with such columns have almost always.

    Parameters
    ----------
    columns : M + 1 columns of L coefficients
        Of the unknowns, then of the constant part.
    lengths : (column, column of its direction) for each length

    Returns
    -------
    int
        0 if there is none, if solutions are not isolated, or if it takes too long.

    Notes
    -----
    Directions alone: a millisecond for four loops, 30 for six. Each length makes it three to six
    times as long.
    """
    pair = MatroidPair(columns)
    if not lengths:
        return pair.solutions(pair.whole)
    return _Orders(pair, lengths).count()


class _NotCounted(Exception):
    """There are too many orders of levels, or exponents that happen to coincide."""


@dataclass(frozen=True)
class _Order:
    """Levels upwards from the lowest of x, the highest of y, and the coordinates that are left.

    A level is a set of coordinates and the sides it is on: directions on ``xy``, one length that
    does not follow from higher levels on ``x`` or ``y``. All sets are bit masks.

    Parameters
    ----------
    directions, of_x, of_y : int
        Left: directions, lengths for levels of their own.
    passed : int
        Directions and lengths of y on the levels so far.
    shared : int
        Levels of directions that are left.
    number : int
        Solutions so far, up to one factor for each level.
    """

    levels: tuple[tuple[int, str], ...]
    directions: int
    of_x: int
    of_y: int
    passed: int
    shared: int
    number: int


class _Orders:
    """All orders of levels with as many unknown exponents as there are lengths."""

    def __init__(self, pair: MatroidPair, lengths: Sequence[tuple[int, int]]) -> None:
        self.pair = pair
        self.lengths = [(1 << column, 1 << base) for column, base in lengths]
        self.ground = (pair.whole + 1) >> 1
        self.steps = 0
        drawn = np.random.default_rng(_SEED).integers(1, _LARGEST, len(lengths))
        self.exponents = [int(w) for w in drawn]

    def count(self) -> int:
        """All solutions; 0 if they could not be counted."""
        try:
            orders = (order for first in self._firsts() for order in self._from(first))
            return sum(order.number * self._weight(order.levels) for order in orders)
        except _NotCounted:
            return 0

    def _firsts(self) -> Iterator[_Order]:
        """Which lengths have levels of their own."""
        every = sum(bit for bit, _ in self.lengths)
        directions = self.pair.whole ^ every
        ranks = self.pair.ranks
        own = [s for s in _subsets(every) if ranks[directions | s] == ranks[-1]]
        for of_x in own:
            for of_y in own:
                shared = len(self.lengths) + 1 - of_x.bit_count() - of_y.bit_count()
                if shared > 0:
                    yield _Order((), directions, of_x, of_y, 0, shared, 1)

    def _from(self, order: _Order) -> Iterator[_Order]:
        """All whole orders that begin like this."""
        self.steps += 1
        if self.steps > _MOST_STEPS:
            raise _NotCounted
        if not (order.shared or order.of_x or order.of_y):
            yield order
        for longer in (*self._with_length(order), *self._with_directions(order)):
            yield from self._from(longer)

    def _with_length(self, order: _Order) -> Iterator[_Order]:
        """One length on a level of its own."""
        side = order.levels[-1][1] if order.levels else "xy"
        for bit, _ in self.lengths:
            # levels of x and of y are in no order: those of x first
            higher = order.directions | (order.of_x ^ bit)
            if order.of_x & bit and side != "y" and not self.pair.follows(bit, higher):
                levels = (*order.levels, (bit, "x"))
                yield replace(order, levels=levels, of_x=order.of_x ^ bit)
            if order.of_y & bit and not self.pair.follows(bit, order.passed):
                levels = (*order.levels, (bit, "y"))
                passed = order.passed | bit
                yield replace(order, levels=levels, of_y=order.of_y ^ bit, passed=passed)

    def _with_directions(self, order: _Order) -> Iterator[_Order]:
        """Some directions that share a level: all that are left on the last one."""
        if not order.shared:
            return
        some = _subsets(order.directions) if order.shared > 1 else [order.directions]
        for here in some:
            rest = order.directions ^ here
            number = self.pair.solutions(here, order.passed, rest | order.of_x) if here else 0
            if number:
                yield replace(
                    order,
                    levels=(*order.levels, (here, "xy")),
                    directions=rest,
                    passed=order.passed | here,
                    shared=order.shared - 1,
                    number=order.number * number,
                )

    def _weight(self, levels: tuple[tuple[int, str], ...]) -> int:
        """How many solutions a whole order has for each of its ``number``; 0 if it is not met."""
        on_x = [k for k, (_, side) in enumerate(levels) if side != "y"]
        on_y = [k for k, (_, side) in enumerate(levels) if side != "x"]
        rows = []
        for bit, base in self.lengths:
            x, y = (self._level(levels, bit, way) for way in (on_x[::-1], on_y))
            # a length that follows from the level of an earlier length has no level
            if any(levels[k][0] < bit for k, side in ((x, "x"), (y, "y")) if levels[k][1] == side):
                return 0
            row = [0] * len(levels)
            row[x] += 1
            row[y] += 1
            row[next(k for k, (here, _) in enumerate(levels) if here & base)] -= 2
            rows.append(row)
        ground = next(k for k, (here, _) in enumerate(levels) if here & self.ground)
        size, found = _solve_square(
            [row[:ground] + row[ground + 1 :] for row in rows], self.exponents
        )
        if not size:
            return 0
        found.insert(ground, Fraction(0))
        gaps = [found[b] - found[a] for way in (on_x, on_y) for a, b in pairwise(way)]
        if not all(gaps):
            raise _NotCounted
        return size if min(gaps) > 0 else 0

    def _level(self, levels: tuple[tuple[int, str], ...], bit: int, way: list[int]) -> int:
        """The level at which, coming from above, a length follows from those passed."""
        passed = 0
        for k in way:
            passed |= levels[k][0]
            if self.pair.follows(bit, passed):
                return k
        raise AssertionError("all levels together span the space")


def _subsets(whole: int) -> Iterator[int]:
    """All subsets of a set, itself and the empty one among them."""
    some = whole
    while True:
        yield some
        if not some:
            return
        some = (some - 1) & whole


def _solve_square(rows: list[list[int]], right: list[int]) -> tuple[int, list[Fraction]]:
    """The size of the determinant of square rows and the solution; 0 if there is none.

    Raises
    ------
    _NotCounted
        If there are many solutions.
    """
    a = [[Fraction(x) for x in (*row, b)] for row, b in zip(rows, right, strict=True)]
    size, rank = Fraction(1), 0
    for k in range(len(a)):
        pivot = next((i for i in range(rank, len(a)) if a[i][k]), None)
        if pivot is None:
            continue
        a[rank], a[pivot] = a[pivot], a[rank]
        size *= abs(a[rank][k])
        a[rank] = [x / a[rank][k] for x in a[rank]]
        for i in range(len(a)):
            if i != rank and a[i][k]:
                a[i] = [x - a[i][k] * y for x, y in zip(a[i], a[rank], strict=True)]
        rank += 1
    if rank == len(a):
        return int(size), [row[-1] for row in a]
    if not any(row[-1] for row in a[rank:]):
        raise _NotCounted
    return 0, []
