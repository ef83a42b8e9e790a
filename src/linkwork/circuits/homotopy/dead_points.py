"""Dead points as a system of polynomials: positions at which some loops can move alone.

A block of ``own`` loops and the loops it depends on, L in all, have M = 2L + 1 unknown directions
and lengths, the input among them:

    left · (U, 1) = 0,     right · (V, 1) = 0,     U_p V_q = U_p' V_q',

as in :mod:`linkwork.core.numerics.bilinear`. The block locks where its own unknowns have rates
ρ ≠ 0 while all variables it depends on and the input rest. With directions t = e^{iθ} and
lengths z along them, t' = iωt and z' = i(ωz + σt), so its own loops give

    Σ left_lk ω_k t_k + Σ left_lj (ω_a z_j + σ_j t_a) = 0

and the same for V with σ negated: bilinear in ρ = (ω, σ) and U, and in ρ and V. In
P^(L+1) x P^(L+1) x P^(2 own - 1) this has at most 2 own C(2L + 1, L) isolated solutions: the
coefficient of a^(L+1) b^(L+1) r^(2 own - 1) in (a + b)^(2L+1) (a + r)^own (b + r)^own (Morgan &
Sommese 1987, Appl. Math. Comput. 24, 101).
"""

from __future__ import annotations

import hashlib
import json
import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, islice

import numpy as np

from linkwork.core.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.core.numerics.bilinear import Columns, rank_together

#: A term of the own loops' rates: column of the closures, factor in (U, 1), number in ρ, weights in
#: the rows of U and of V.
Slot = tuple[int, int, int, float, float]


def most_dead_points(own: int, size: int) -> int:
    """2 own C(2L + 1, L) for ``own`` loops of a block and ``size`` = 2L + 1 unknowns."""
    return 2 * own * math.comb(size, size // 2)  # eq. (53)


def norm_of(own: int) -> ComplexArray:
    """The linear form (2 own,) that is 1 for the rates ρ of every system of ``own`` loops."""
    rng = np.random.default_rng(2 * own)
    drawn: ComplexArray = rng.normal(size=2 * own) + 1j * rng.normal(size=2 * own)
    return drawn


@dataclass(frozen=True, kw_only=True, eq=False)
class DeadPointSystem:
    """One system over x = (U, V, ρ), n = 2M + 2 own; ρ is normed by a fixed linear form.

    Parameters
    ----------
    left, right : (L, M + 1) complex
        Closures; the block's own ones last.
    rows : (4, M) int
        p, q, p', q' of every product.
    own : int
        Loops of the block itself.
    slots : tuple of Slot
    """

    left: ComplexArray
    right: ComplexArray
    rows: IndexArray
    own: int
    slots: tuple[Slot, ...]

    @property
    def loops(self) -> int:
        """L."""
        return len(self.left)

    @property
    def size(self) -> int:
        """M = 2L + 1, the unknowns in U and in V."""
        return 2 * self.loops + 1

    @property
    def parts(self) -> tuple[slice, slice, slice]:
        """The slices of (U, 1), (V, 1) and ρ in the homogeneous vector X."""
        m = self.size + 1
        return slice(0, m), slice(m, 2 * m), slice(2 * m, 2 * m + 2 * self.own)

    @property
    def bound(self) -> int:
        """How many isolated solutions there are at most."""
        return most_dead_points(self.own, self.size)

    @cached_property
    def norm(self) -> ComplexArray:
        """The linear form of ρ that is 1."""
        return norm_of(self.own)

    @cached_property
    def linear(self) -> ComplexArray:
        """The closures, (2L, N), of X."""
        u, v, rates = self.parts
        k = np.zeros((2 * self.loops, rates.stop), dtype=complex)
        k[: self.loops, u], k[self.loops :, v] = self.left, self.right
        return k

    @cached_property
    def quadratic(self) -> ComplexArray:
        """Symmetric T (E, N, N): products, then rates, as ½ XᵀTX."""
        count, own = self.rows.shape[1], self.own
        u, v, rates = self.parts
        t = np.zeros((count + 2 * own, rates.stop, rates.stop), dtype=complex)
        p, q, p1, q1 = self.rows
        e = np.arange(count)
        t[e, p, v.start + q] += 1.0
        t[e, p1, v.start + q1] -= 1.0
        for column, factor, number, weight, mirrored in self.slots:
            r = rates.start + number
            # eq. (53)
            t[count : count + own, u.start + factor, r] += weight * self.left[-own:, column]
            t[count + own :, v.start + factor, r] += mirrored * self.right[-own:, column]
        both: ComplexArray = t + t.transpose(0, 2, 1)
        return both

    @cached_property
    def _affine(self) -> IndexArray:
        """The indices of the unknowns x in X."""
        one = [part.stop - 1 for part in self.parts[:2]]
        return np.delete(np.arange(self.parts[2].stop), one)

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """F, (B, n), and its derivative, (B, n, n), at x (B, n)."""
        whole = np.ones((len(x), self.parts[2].stop), dtype=complex)
        whole[:, self._affine] = x
        slopes = np.tensordot(whole, self.quadratic, axes=(1, 1))
        jacobian = np.zeros((len(x), x.shape[1], whole.shape[1]), dtype=complex)
        lines = len(self.linear)
        jacobian[:, :lines] = self.linear
        jacobian[:, lines:-1] = slopes
        jacobian[:, -1, self.parts[2]] = self.norm
        f = np.concatenate(
            [
                whole @ self.linear.T,
                0.5 * (slopes @ whole[:, :, None])[:, :, 0],
                whole[:, self.parts[2]] @ self.norm[:, None] - 1.0,
            ],
            axis=1,
        )
        return f, jacobian[:, :, self._affine]

    def points(self, whole: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """x (B, n) of homogeneous X (B, N), and (U, 1), (V, 1) of length 1 at their last place."""
        u, v, rates = (whole[:, part] for part in self.parts)
        last = [z[:, -1] / np.linalg.norm(z, axis=1) for z in (u, v)]
        with np.errstate(all="ignore"):
            halves = [z[:, :-1] / z[:, -1:] for z in (u, v)]
            x = np.concatenate([*halves, rates / (rates @ self.norm)[:, None]], axis=1)
        return x, np.stack(last)

    def whole(self, x: ComplexArray) -> ComplexArray:
        """X (B, N) of x (B, n)."""
        found = np.ones((len(x), self.parts[2].stop), dtype=complex)
        found[:, self._affine] = x
        return found


# ----------------------------------------------------------------------
# The topology of a family of systems, and how two families are one in different order.
#
# Which links a mechanism has and how joints connect them does not depend on the order of its
# unknowns nor on which loops are written. Closures C and T C P have the same solutions, with
# unknowns in another order, for every invertible T and permutation P.


_LARGEST_CONDITION = 1e6  # of the combination of loops
_SMALLEST_PART = 1e-9  # relative: a vector that lies in a subspace has no part outside
_MOST_ORDERS = 200  # of unknowns that are tried
_MOST_PLACES = 20_000
_MOST_SUBSETS = 512  # of columns whose ranks are compared

_Product = tuple[tuple[int, int], tuple[int, int]]


@dataclass(frozen=True, kw_only=True, eq=False)
class Renaming:
    """One family's unknowns and loops in terms of another's.

    Parameters
    ----------
    order : (K,) int
        The other's column for every column.
    loops : (L, L)
        T: loops are these combinations of the other's.
    rates : (2 own,) int
        The other's rate for every rate.
    """

    order: IndexArray
    loops: Array
    rates: IndexArray

    @property
    def halves(self) -> IndexArray:
        """The other's indices of the unknowns (U, V)."""
        unknowns = self.order[:-1]
        return np.concatenate([unknowns, len(unknowns) + unknowns])


@dataclass(frozen=True)
class Topology:
    """Products, sums within columns, and rates of a family; see its classes for the fields."""

    rows: tuple[tuple[int, ...], ...]
    columns: Columns
    own: int = 0
    slots: tuple[Slot, ...] = ()

    @property
    def unknowns(self) -> int:
        """M, the last column's index."""
        return len(self.columns) - 1

    def as_text(self) -> str:
        """The topology as JSON."""
        return json.dumps([self.rows, self.columns, self.own, self.slots])

    @classmethod
    def of_text(cls, text: str) -> Topology:
        """The topology of :meth:`as_text`."""
        rows, columns, own, slots = json.loads(text)
        return cls(
            rows=tuple(map(tuple, rows)),
            columns=tuple(tuple(map(tuple, column)) for column in columns),
            own=own,
            slots=tuple((a, b, c, float(d), float(e)) for a, b, c, d, e in slots),
        )

    def rank(self, chosen: tuple[int, ...]) -> int:
        """The dimension that the free coefficients of some columns span together."""
        known = self._ranks.get(chosen)
        if known is None:
            known = self._ranks[chosen] = rank_together(tuple(self.columns[k] for k in chosen))
        return known

    @cached_property
    def _ranks(self) -> dict[tuple[int, ...], int]:
        return {}

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """For every column what does not depend on the order of the others."""
        last, everyone = self.unknowns, range(len(self.columns))
        found = []
        for k in everyone:
            pairs = sorted(self.rank(tuple(sorted((k, j)))) for j in everyone if j != k)
            with_last = self.rank(tuple(sorted({k, last})))
            places = sorted(
                (side, at, other == last, other == k)
                for row in zip(*self.rows, strict=True)
                for side, pair in enumerate((row[:2], row[2:]))
                for at, (here, other) in enumerate((pair, pair[::-1]))
                if here == k
            )
            turns = sorted(
                (column == k, factor == k, factor == last, weight, mirrored)
                for column, factor, _, weight, mirrored in self.slots
                if k in (column, factor)
            )
            found.append(repr((k == last, self.rank((k,)), with_last, pairs, places, turns)))
        return tuple(found)

    @cached_property
    def signature(self) -> str:
        """A digest that is the same for all families that are one in different order."""
        everyone = range(len(self.columns))
        triples = Counter(
            (self.rank(chosen), *sorted(self.kinds[k] for k in chosen))
            for chosen in combinations(everyone, 3)
        )
        whole = (len(self.columns[0]), self.own, sorted(self.kinds), sorted(triples.items()))
        return hashlib.sha256(repr(whole).encode()).hexdigest()[:20]

    def renaming(self, other: Topology) -> Renaming | None:
        """How this family is the other one; ``None`` if it is not, or no order was found."""
        if self == other:
            return Renaming(
                order=np.arange(len(self.columns)),
                loops=np.eye(len(self.columns[0])),
                rates=np.arange(2 * self.own),
            )
        if self.signature != other.signature:
            return None
        for order in islice(_Orders(self, other), _MOST_ORDERS):
            loops = self._loops(other, order)
            rates = self._rates(other, order)
            if loops is not None and rates is not None:
                return Renaming(
                    order=np.array(order, dtype=np.intp),
                    loops=loops,
                    rates=np.array(rates, dtype=np.intp),
                )
        return None

    def products(self, order: list[int]) -> Counter[frozenset[tuple[int, ...]]]:
        """All products with columns replaced by those of an order."""
        found: Counter[frozenset[tuple[int, ...]]] = Counter()
        for p, q, p1, q1 in zip(*self.rows, strict=True):
            found[frozenset({(order[p], order[q]), (order[p1], order[q1])})] += 1
        return found

    def _loops(self, other: Topology, order: list[int]) -> Array | None:
        """T with T (the other's column order[k]) in the span of column k, for all k."""
        if self.products(order) != other.products(list(range(len(order)))):
            return None
        count = len(self.columns[0])
        parts = []
        for k, j in enumerate(order):
            span, _ = np.linalg.qr(np.array(self.columns[k], dtype=float))
            outside = np.eye(count) - span @ span.T
            # rows of (outside T w) = 0 as linear equations of T
            parts += [np.kron(outside, w) for w in np.array(other.columns[j], dtype=float).T]
        _, size, rows = np.linalg.svd(np.concatenate(parts))
        free = rows[size <= _SMALLEST_PART * size[0]]
        if not len(free):
            return None
        # any combination that is not singular; a fixed one, so that every run gives the same
        weights = np.random.default_rng(len(free)).normal(size=len(free))
        loops: Array = (weights @ free).reshape(count, count)
        return loops if np.linalg.cond(loops) < _LARGEST_CONDITION else None

    def _rates(self, other: Topology, order: list[int]) -> list[int] | None:
        """The other's number of every rate, as its terms show."""
        mine, theirs = _terms(self, order), _terms(other, list(range(len(order))))
        number = {terms: k for k, terms in enumerate(theirs)}
        found = [number.get(terms, -1) for terms in mine]
        return None if -1 in found or len(set(found)) != len(theirs) else found


def _terms(topology: Topology, order: list[int]) -> list[frozenset[tuple[int, int, float, float]]]:
    """The terms of every rate with columns replaced by those of an order."""
    terms: list[set[tuple[int, int, float, float]]] = [set() for _ in range(2 * topology.own)]
    for column, factor, number, weight, mirrored in topology.slots:
        terms[number].add((order[column], order[factor], weight, mirrored))
    return [frozenset(each) for each in terms]


class _Orders:
    """Orders of columns that keep kinds and all ranks, found place by place."""

    def __init__(self, mine: Topology, other: Topology) -> None:
        self.mine, self.other = mine, other
        self.places = 0

    def __iter__(self) -> Iterator[list[int]]:
        last = self.mine.unknowns
        # the columns of the rarest kinds first: they decide early
        often = Counter(self.mine.kinds)
        places = sorted(range(last), key=lambda k: (often[self.mine.kinds[k]], k))
        yield from self._extend({last: last}, [((), ()), ((last,), (last,))], places)

    def _extend(
        self,
        found: dict[int, int],
        subsets: list[tuple[tuple[int, ...], tuple[int, ...]]],
        places: list[int],
    ) -> Iterator[list[int]]:
        if not places:
            yield [found[k] for k in range(len(found))]
            return
        k, rest = places[0], places[1:]
        for j in range(self.mine.unknowns):
            self.places += 1
            if self.places > _MOST_PLACES:
                return
            if j in found.values() or self.mine.kinds[k] != self.other.kinds[j]:
                continue
            wider = [(tuple(sorted((*a, k))), tuple(sorted((*b, j)))) for a, b in subsets]
            if all(self.mine.rank(a) == self.other.rank(b) for a, b in wider):
                # ranks of many columns together say little that those of fewer do not
                more = subsets + wider if len(subsets) < _MOST_SUBSETS else subsets
                yield from self._extend({**found, k: j}, more, rest)
