"""Frameworks of bars and pins: minimally rigid graphs and how often they can be realised.

The numbers are those of Capco, Gallet, Grasegger, Koutschan, Lubbes, Schicho 2018 (SIAM J. Appl.
Algebra Geom. 2, 94) for the graphs with the most realisations: complex ones for general lengths of
the bars, up to rotation and translation.
"""

from __future__ import annotations

from itertools import combinations

from linkwork.core.numerics.bilinear import Columns

__all__ = ["MOST_REALISATIONS", "bars_of", "bars_of_number", "cycle_columns"]

Edges = list[tuple[int, int]]

#: Vertices, the graph as a number, realisations.
MOST_REALISATIONS = (
    (6, 7916, 24),
    (7, 1269995, 56),
    (8, 170989214, 136),
    (9, 11177989553, 344),
)


def bars_of_number(vertices: int, number: int) -> Edges:
    """The upper triangle of the adjacency matrix, row by row, as binary digits."""
    pairs = list(combinations(range(vertices), 2))
    digits = f"{number:0{len(pairs)}b}"
    return [pair for pair, digit in zip(pairs, digits, strict=True) if digit == "1"]


def bars_of(links: int, pins: Edges) -> tuple[int, Edges]:
    """A truss with its links made of bars: the vertices are the pins, given as pairs of links."""
    bars: set[tuple[int, int]] = set()
    for link in range(links):
        first, second, *others = (k for k, pair in enumerate(pins) if link in pair)
        bars.add((first, second))
        bars |= {(one, other) for one in (first, second) for other in others}
    return len(pins), sorted(bars)


def cycle_columns(vertices: int, bars: Edges) -> Columns:
    """Closures of a framework, every bar with a direction and a dimension of its own."""
    parent = {0: (0, -1)}
    reached = [0]
    for one in reached:
        for k, (a, b) in enumerate(bars):
            if one in (a, b) and (other := a + b - one) not in parent:
                parent[other] = (one, k)
                reached.append(other)
    assert len(reached) == vertices
    tree = {k for _, k in parent.values()}
    rows = []
    for k, (a, b) in enumerate(bars):
        if k in tree:
            continue
        row = [0] * len(bars)
        row[k] = 1
        for end, sign in ((b, 1), (a, -1)):
            while end:
                end_before, bar = parent[end]
                row[bar] += sign if bars[bar] == (end, end_before) else -sign
                end = end_before
        rows.append(row)
    return tuple(tuple((row[k],) for row in rows) for k in range(len(bars)))
