"""The conditions of a four-bar's positions as quadratic equations with whole coefficients.

Moving pivots A_j and B_j in position j, seen from the traced point there, are separate
unknowns. With x, y of the first position and the fixed pivots a, b, all seen from its point,

    |δ|² + 2 Re((A - a) δ̄) - 2 Re((A - x) ā) = 0,   alike with B, b and y,
    |A|² = |x|²,   B x = A y,      or in a pose  A = e x,   B = e y.

Given lengths are alike, and coordinates of pivots may keep a value. They are real equations of real
numbers v: the unknowns, the given numbers and 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from linkwork.synthesis.precision.positions import PrecisionPositions
from linkwork.synthesis.precision.problem import ComplexPlace, ProductSums, ProductWriter

#: A coordinate that keeps a value: its place among x, [a], y, [b], seen from the first position
#: [length].
HeldValue = tuple[int, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionEquations:
    """The equations, and the places of x, a, y, b in v, and of A and B in the positions after the
    first.
    """

    sums: ProductSums
    legs: tuple[ComplexPlace, ...]
    moving: tuple[tuple[ComplexPlace, ComplexPlace], ...]


def position_equations(
    positions: PrecisionPositions, held: Sequence[HeldValue] = ()
) -> PositionEquations:
    """The equations; v is x, [a], y, [b], all A_j and B_j, then a, b as far as they are given,
    e of all poses, δ of all positions, given lengths and held values, each with 0, then 1 and 0.
    """
    free = iter(range(0, 10_000, 2))

    def place() -> ComplexPlace:
        first = next(free)
        return first, first + 1

    pivots = len(positions.pivots)
    count = len(positions.poses) + len(positions.points)
    x, a = place(), (0, 0) if pivots > 0 else place()
    y, b = place(), (0, 0) if pivots > 1 else place()
    moving = tuple((place(), place()) for _ in range(count))
    unknowns = (8 - 2 * pivots) + 4 * count
    a = place() if pivots > 0 else a
    b = place() if pivots > 1 else b
    turns = [place() for _ in positions.poses]
    deltas = [place() for _ in range(count)]
    lengths = [place()[0] for _ in positions.lengths]
    values = [place()[0] for _ in held]
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
    named = {"A": x, "A0": a, "B": y, "B0": b}
    for entry, length in zip(positions.lengths, lengths, strict=True):
        ends = [named[end] for end in (entry.one, entry.other) if end in named]
        _length_equation(writer, ends[0], ends[1] if len(ends) > 1 else None, length)
    for (k, _), value in zip(held, values, strict=True):
        writer.equation((1, k, one[0]), (-1, value, one[0]))
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


def _length_equation(
    writer: ProductWriter, one: ComplexPlace, other: ComplexPlace | None, length: int
) -> None:
    """|A - B|² = L²; ``None`` is the traced point, from which all is seen."""
    terms = [(1, k, k) for k in one]
    if other is not None:
        terms += [(1, k, k) for k in other]
        terms += [(-2, k, i) for k, i in zip(one, other, strict=True)]
    writer.equation(*terms, (-1, length, length))
