"""The conditions of a four-bar's positions as quadratic equations with whole coefficients.

Moving pivots A_j and B_j in position j, seen from the traced point there, are unknowns of their
own. With x, y of the first position and the fixed pivots a, b, all seen from its point,

    |δ|² + 2 Re((A - a) δ̄) - 2 Re((A - x) ā) = 0,   alike with B, b and y,
    |A|² = |x|²,   B x = A y,      or in a pose  A = e x,   B = e y.

They are real equations of real numbers v: the unknowns, the given numbers and 1.
"""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.design.precision.positions import PrecisionPositions
from linkwork.design.precision.product_sums import ComplexPlace, ProductSums, ProductWriter

__all__ = ["PositionEquations", "position_equations"]


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionEquations:
    """The equations, and the places of x, a, y, b in v, and of A and B in the positions after the
    first.
    """

    sums: ProductSums
    legs: tuple[ComplexPlace, ...]
    moving: tuple[tuple[ComplexPlace, ComplexPlace], ...]


def position_equations(given: PrecisionPositions) -> PositionEquations:
    """The equations; v is x, [a], y, [b], all A_j and B_j, then a, b as far as they are given,
    e of all poses, δ of all positions, 1 and 0.
    """
    free = iter(range(0, 10_000, 2))

    def place() -> ComplexPlace:
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
    one = place()
    writer = ProductWriter()
    for k, ((left, right), delta) in enumerate(zip(moving, deltas, strict=True)):
        _leg(writer, left, x, a, delta)  # eq. (114)
        _leg(writer, right, y, b, delta)
        if k < len(turns):
            writer.equal_products(left, one, turns[k], x)
            writer.equal_products(right, one, turns[k], y)
        else:
            writer.equal_lengths(left, x)
            writer.equal_products(right, x, left, y)
    return PositionEquations(
        sums=writer.sums(unknowns, one[1] + 1), legs=(x, a, y, b), moving=moving
    )


def _leg(
    writer: ProductWriter,
    moved: ComplexPlace,
    start: ComplexPlace,
    fixed: ComplexPlace,
    delta: ComplexPlace,
) -> None:
    """|δ|² + 2 Re((A - a) δ̄) - 2 Re((A - x) ā) = 0."""
    writer.equation(
        *[(1, d, d) for d in delta],
        *[(2, m, d) for m, d in zip(moved, delta, strict=True)],
        *[(-2, f, d) for f, d in zip(fixed, delta, strict=True)],
        *[(-2, m, f) for m, f in zip(moved, fixed, strict=True)],
        *[(2, s, f) for s, f in zip(start, fixed, strict=True)],
    )
