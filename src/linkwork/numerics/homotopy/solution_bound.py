"""How many solutions a bilinear system has at most, and by which theorem.

Both bounds are numbers of solutions that almost all members of a family have, and the family's
systems together with their solutions form one smooth irreducible variety. So where as many regular
solutions are known there are no others, not even a curve of them (docs/decisions/0008).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from enum import Enum
from functools import cache

from linkwork.numerics.homotopy.column_sums import Columns, rank_together
from linkwork.numerics.homotopy.laman_number import laman_number

__all__ = ["Products", "SolutionBound", "Theorem", "bound_by_products", "bound_by_sums"]

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
