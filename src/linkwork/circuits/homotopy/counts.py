"""Points of two spaces whose coordinates have given products: how many there are almost always.

x and y lie in spaces of dimensions a and b with the same coordinates E, a + b = |E| + 1, and
x_e y_e = λ_e for all e ∈ E, up to one factor common to all. For almost all λ the number of such
pairs (up to x -> cx, y -> y / c) is finite and depends only on which coordinates are independent on
either space. Let λ_ē of one coordinate grow beyond all bounds: the pairs then fall apart into
groups, one for each way to share the other coordinates out to two smaller problems of the same
kind. That is a recursion (Capco, Gallet, Grasegger, Koutschan, Lubbes, Schicho 2018, SIAM J. Appl.
Algebra Geom. 2, 94, for the edges of two graphs; docs/decisions/0008 has the proof for spaces).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np

from linkwork.core.numerics.bilinear import Columns, column_ranks, rank_together


class MatroidPair:
    """x in the null space of closures with given columns, y in that of others of the same kind.

    Sets of coordinates, which are those of the columns, are bit masks.
    """

    def __init__(self, columns: Columns) -> None:
        count = len(columns)
        ranks = column_ranks(columns)
        self.whole = len(ranks) - 1
        #: The dimension of the null space projected onto every set of coordinates.
        self.ranks = [s.bit_count() - ranks[-1] + ranks[self.whole ^ s] for s in range(len(ranks))]
        self._bits = [1 << k for k in range(count)]
        self._known: dict[tuple[int, int, int], int] = {}
        self._spans: dict[int, int] = {}

    def follows(self, coordinate: int, others: int) -> bool:
        """Whether a coordinate is a combination of others."""
        return self.ranks[others | coordinate] == self.ranks[others]

    def solutions(self, here: int, forgotten: int = 0, zero: int = 0) -> int:
        """The number of pairs for the coordinates ``here``; 0 if it is not finite.

        Others are ``zero`` for x and do not matter for y, or the other way round (``forgotten``).
        """
        if not self._fits(here, forgotten, zero):
            return 0
        spans = self._span(forgotten), self._span(zero)
        if here & (spans[0] | spans[1]):
            return 0  # a coordinate that is zero everywhere
        # both spaces are of the same kind, so x and y may change places
        key = (here, min(spans), max(spans))
        if key not in self._known:
            self._known[key] = self._share_out(here, forgotten, zero)
        return self._known[key]

    def _share_out(self, here: int, forgotten: int, zero: int) -> int:
        """Sum over all ways to share out the other coordinates, without the pivot ē."""
        pivot = here & -here
        rest = here ^ pivot
        total = 0
        mine = rest
        while True:
            others = rest ^ mine
            left = (mine, forgotten | others | pivot, zero)
            right = (others, forgotten, zero | mine | pivot)
            # dimensions first: most ways do not fit
            if (not mine or self._fits(*left)) and (not others or self._fits(*right)):
                number = self.solutions(*left) if mine else 1
                if number and others:
                    number *= self.solutions(*right)
                total += number
            if not mine:
                return total
            mine = (mine - 1) & rest

    def _fits(self, here: int, forgotten: int, zero: int) -> bool:
        """Whether there are as many equations as unknowns."""
        ranks = self.ranks
        free = ranks[here | zero] - ranks[zero] + ranks[here | forgotten] - ranks[forgotten]
        return free == here.bit_count() + 1

    def _span(self, zero: int) -> int:
        """All coordinates that are zero with these ones."""
        if zero not in self._spans:
            self._spans[zero] = sum(bit for bit in self._bits if self.follows(bit, zero))
        return self._spans[zero]


# ----------------------------------------------------------------------
# Laman numbers: how many solutions closures over directions and lengths have almost always.
#
# With x = (U, 1) in the null space of the closures and y = (V, 1) in that of their conjugates, a
# block without lengths requires pairs with the products U_k V_k = 1, one for each link, the ground
# among them (below). With one coordinate for each bar of a
# framework their number is the framework's Laman number; rigid links with more than two joints need
# no bars.
#
# Lengths, U_z V_a = U_a V_z along a direction a, are counted at the limit where the ratios
# U_z V_a / U_a V_z, which are 1 for real lengths, differ beyond all bounds: they are powers of a
# small number with random exponents. Coordinates of solutions are then powers, too. Those of x with
# equal exponents form a level, and so do those of y; a direction's exponents in x and y are
# opposite.
# For every order of levels the exponents follow from those of the ratios, and the order counts
# where they are in that order (docs/decisions/0008).


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


# ----------------------------------------------------------------------
# How many solutions a bilinear system has at most, and by which theorem.
#
# Both bounds are numbers of solutions that almost all members of a family have, and the family's
# systems together with their solutions form one smooth irreducible variety. So where as many
# regular solutions are known there are no others, not even a curve of them (docs/decisions/0008).


#: p, q, p', q' of every product U_p V_q = U_p' V_q'.
Products = tuple[tuple[int, ...], ...]


class Theorem(Enum):
    """Where a bound comes from, in words that follow "by"."""

    BEZOUT = "Bézout's theorem"
    LAMAN = "the Laman number of the links"


@dataclass(frozen=True, kw_only=True)
class SolutionBound:
    """At most ``number`` isolated solutions, by a ``theorem``."""

    number: int
    theorem: Theorem


@cache
def bound_by_products(products: Products) -> SolutionBound:
    """The bound for any closures: C(2L, L) without lengths, or with one at most along a direction.

    In P^L x P^L with the classes h and k of its hyperplanes, U_k V_k = 1 has the class h + k. Where
    g lengths go along one direction a, (U_a, U_z, ...) is parallel to (V_a, V_z, ...), which has
    the class h^g + h^(g-1) k + ... + k^g (Fulton 1998, Intersection Theory, 14.4). The number is
    the coefficient of h^L k^L in the product of all classes.
    """
    lengths = _lengths(products)
    angles = len(products[0]) - len(lengths)
    row = [1]
    for g in (*[1] * angles, *Counter(base for _, base in lengths).values()):
        wider = [0] * (len(row) + g)
        for k, number in enumerate(row):
            for j in range(k, k + g + 1):
                wider[j] += number  # eq. (51)
        row = wider
    return SolutionBound(number=row[len(products[0]) // 2], theorem=Theorem.BEZOUT)  # eq. (51)


@cache
def bound_by_sums(products: Products, columns: Columns) -> SolutionBound | None:
    """The bound for closures with exactly these zeros and sums in their columns, if it is known.

    Only a family with solutions bounds those of its members, and it has to be one variety: the
    closures must not become dependent where lengths are zero.
    """
    lengths = _lengths(products)
    sliding = {z for z, _ in lengths}
    turning = tuple(column for k, column in enumerate(columns) if k not in sliding)
    if rank_together(turning) < len(columns[0]):
        return None
    number = laman_number(columns, lengths)
    return SolutionBound(number=number, theorem=Theorem.LAMAN) if number else None


def _lengths(products: Products) -> tuple[tuple[int, int], ...]:
    """Every length with its direction: U_z V_a = U_a V_z."""
    return tuple(
        (z, a) for z, a, a1, z1 in zip(*products, strict=True) if (z, a) == (z1, a1) and z != a
    )
