"""Baranov trusses: rigid chains of links and pins, and in how many ways each can be assembled.

A graph's vertices are links, its edges pins (graph6, McKay). The numbers of complex solutions for
general dimensions are those of Rojas & Thomas 2012 and recomputed figures.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

import linkwork as lw

__all__ = [
    "FIVE_LINKS",
    "NINE_LINKS",
    "SEVEN_LINKS",
    "edges_of",
    "random_graph",
    "truss",
    "truss_at",
]

Edges = list[tuple[int, int]]

#: The triad and its frame: a ternary link on three binary ones.
FIVE_LINKS = {"Ds[": 6}

SEVEN_LINKS = {"FEhf?": 14, "FCpv?": 16, "F?o~_": 18}

NINE_LINKS = {
    "H?qa`bo": 30, "H?bB@ro": 36, "H?bB`r_": 38, "H?BDbRW": 40, "H?BDbO{": 40, "H?qad`o": 40,
    "H?BD?|w": 42, "H?B@mQw": 42, "H?B@lRW": 42, "H?`F?xw": 44, "H?bBD`w": 44, "H?`e`r_": 46,
    "H?`e`qS": 46, "H?qad`S": 46, "H?AFEo{": 48, "H?BD@xY": 48, "H?BDePw": 48, "H?BDeO{": 48,
    "H?b@aVo": 48, "H?`ed`g": 50, "H?qa`pS": 50, "HCOf?xo": 50, "H??FeW{": 52, "H?`FAqs": 52,
    "H?AFCp{": 54, "H?B@`zI": 54, "H?`FE_{": 56, "HCOf@pS": 58,
}  # fmt: skip


def edges_of(graph6: str) -> tuple[int, Edges]:
    """The number of vertices and the edges of a small graph."""
    count = ord(graph6[0]) - 63
    bits = "".join(f"{ord(letter) - 63:06b}" for letter in graph6[1:])
    pairs = [(i, j) for j in range(1, count) for i in range(j)]
    return count, [pair for pair, bit in zip(pairs, bits, strict=False) if bit == "1"]


def truss(
    graph: str | tuple[int, Edges],
    rng: np.random.Generator,
    *,
    size: float = 1.0,
    ground: int = 0,
) -> lw.Mechanism:
    """A truss with random pins; the sketch is one of its configurations. It has no input."""
    _, edges = edges_of(graph) if isinstance(graph, str) else graph
    places = size * rng.uniform(-1.0, 1.0, (len(edges), 2))
    return truss_at(graph, places @ [1.0, 1.0j], ground=ground)


def truss_at(
    graph: str | tuple[int, Edges], places: np.ndarray, *, ground: int = 0
) -> lw.Mechanism:
    """A truss with its pins at these places, as complex numbers, in one configuration."""
    count, edges = edges_of(graph) if isinstance(graph, str) else graph
    return lw.linkage(
        name=f"Truss {graph}" if isinstance(graph, str) else "Truss",
        points={f"J{k}": (float(z.real), float(z.imag)) for k, z in enumerate(places)},
        links={
            "ground" if link == ground else f"b{link}": tuple(
                f"J{k}" for k, edge in enumerate(edges) if link in edge
            )
            for link in range(count)
        },
    )


def random_graph(links: int, rng: np.random.Generator) -> tuple[int, Edges]:
    """A random truss without a smaller truss inside: 3 (k - 1) > 2 pins for every k links."""
    pins = 3 * (links - 1) // 2
    pairs = list(combinations(range(links), 2))
    while True:
        chosen = [pairs[i] for i in sorted(rng.choice(len(pairs), pins, replace=False))]
        if (
            all(
                _free(chosen, set(part))
                for k in range(2, links)
                for part in combinations(range(links), k)
            )
            and min(sum(link in edge for edge in chosen) for link in range(links)) > 1
        ):
            return links, chosen


def _free(edges: Edges, part: set[int]) -> bool:
    inside = sum(a in part and b in part for a, b in edges)
    return 3 * (len(part) - 1) > 2 * inside
