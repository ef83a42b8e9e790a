"""All kinematic chains of simple joints with one freedom, enumerated from nothing but counts.

A chain of n links and one freedom has (3n - 4)/2 joints. It is proper if no part of it is rigid:
every k > 1 of its links keep 3(k - 1) - 2j >= 1 freedoms among their own j joints.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import combinations, permutations

import networkx

__all__ = ["canonical_graph6", "kinematic_chains", "link_classes"]


@cache
def kinematic_chains(n: int) -> tuple[networkx.Graph, ...]:
    """One graph of each chain of n links: links as vertices, joints as edges."""
    joints = (3 * n - 4) // 2
    found: dict[tuple[tuple[int, ...], ...], list[networkx.Graph]] = {}
    for degrees in _partitions(2 * joints, n):
        for edges in _realisations(degrees):
            graph = networkx.Graph(edges)
            alike = found.setdefault(_degrees_around(graph), [])
            if not any(networkx.is_isomorphic(graph, known) for known in alike):
                alike.append(graph)
    return tuple(graph for alike in found.values() for graph in alike if _proper(graph))


def _degrees_around(graph: networkx.Graph) -> tuple[tuple[int, ...], ...]:
    """The same for graphs that are the same: each vertex by its degree and its neighbours'."""
    degree = dict(graph.degree())
    around = {v: (degree[v], *sorted(degree[w] for w in graph[v])) for v in graph}
    return tuple(
        sorted((*around[v], *sorted(map(hash, (around[w] for w in graph[v])))) for v in graph)
    )


def _partitions(total: int, parts: int, most: int | None = None) -> Iterator[tuple[int, ...]]:
    """Falling degrees of at least two with a given sum."""
    if parts == 0:
        if total == 0:
            yield ()
        return
    for first in range(min(total - 2 * (parts - 1), most or total), 1, -1):
        for rest in _partitions(total - first, parts - 1, first):
            yield (first, *rest)


def _realisations(degrees: tuple[int, ...]) -> Iterator[tuple[tuple[int, int], ...]]:
    """Every simple graph with these degrees, vertex by vertex, some of them more than once."""

    def step(
        k: int, left: tuple[int, ...], edges: tuple[tuple[int, int], ...]
    ) -> Iterator[tuple[tuple[int, int], ...]]:
        if k == len(left):
            yield edges
            return
        later = [j for j in range(k + 1, len(left)) if left[j]]
        earlier = {j: (left[j], [a for a, b in edges if b == j]) for j in later}
        alike = [(i, j) for i, j in combinations(later, 2) if earlier[i] == earlier[j]]
        for chosen in combinations(later, left[k]):
            if any(j in chosen and i not in chosen for i, j in alike):
                continue  # the same graph with i and j exchanged
            rest = tuple(d - (j in chosen) for j, d in enumerate(left))
            yield from step(k + 1, rest, (*edges, *((k, j) for j in chosen)))

    yield from step(0, degrees, ())


def _proper(graph: networkx.Graph) -> bool:
    if not networkx.is_connected(graph):
        return False
    return all(
        3 * (k - 1) - 2 * graph.subgraph(part).number_of_edges() >= 1
        for k in range(2, len(graph) + 1)
        for part in combinations(graph, k)
    )


def canonical_graph6(graph: networkx.Graph) -> str:
    """The smallest graph6 text of all numberings of the vertices."""
    nodes = sorted(graph)
    pairs = [(i, j) for j in range(len(nodes)) for i in range(j)]
    matrix = [[graph.has_edge(a, b) for b in nodes] for a in nodes]
    best = min(
        sum(matrix[p[i]][p[j]] << (len(pairs) - 1 - k) for k, (i, j) in enumerate(pairs))
        for p in permutations(range(len(nodes)))
    )
    edges = [pair for k, pair in enumerate(pairs) if best >> (len(pairs) - 1 - k) & 1]
    plain = networkx.Graph(edges)
    plain.add_nodes_from(range(len(nodes)))
    return str(networkx.to_graph6_bytes(plain, sorted(plain), header=False).decode().strip())


def link_classes(graph: networkx.Graph) -> int:
    """How many links differ: the orbits of the vertices under all symmetries of the graph."""
    matcher = networkx.isomorphism.GraphMatcher(graph, graph)
    classes = networkx.utils.UnionFind(graph)
    for symmetry in matcher.isomorphisms_iter():
        for one, other in symmetry.items():
            classes.union(one, other)
    return len(list(classes.to_sets()))
