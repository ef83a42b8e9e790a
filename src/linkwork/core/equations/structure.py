"""The structure of a linkage: the solving order of its bodies, and the loops to write.

Bodies and points form a graph. The finest solving order follows from the block-triangular form of
all joint conditions, which does not depend on the choice of loops. In each block the loops are a
minimum cycle basis in which all bodies of earlier blocks count as one rigid frame, so the loop
equations have the same blocks as the mechanism.
"""

from __future__ import annotations

import cmath
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from linkwork.core.equations.frames import Frames
from linkwork.core.equations.model import LawEquation, LinearEquation
from linkwork.core.foundation.arrays import RANK_TOLERANCE, Array
from linkwork.core.foundation.lanes import plain_value
from linkwork.core.foundation.names import GROUND, canonical
from linkwork.core.numerics.decomposition import BlockForm, block_form

#: ("body", name) or ("point", name)
GraphNode = tuple[str, str]
Edge = tuple[GraphNode, GraphNode]
_ROOT: GraphNode = ("root", "")
_LARGE = 60  # nodes of a block above which only one candidate cycle per edge is considered


@dataclass(frozen=True)
class StructureBlock:
    """Bodies and points determined together; ``loops`` as closed walks of nodes."""

    new: tuple[GraphNode, ...]
    tree: tuple[tuple[GraphNode, GraphNode], ...]
    loops: tuple[tuple[GraphNode, ...], ...]


@dataclass(frozen=True)
class Structure:
    """The body-point graph of a linkage and its blocks in solving order.

    Parameters
    ----------
    incidences : tuple of (body, point)
        All pairs of a body and a point on or guided by it that another body uses.
    variables : tuple of tuple of str
        The unknown angles and lengths in each incidence.
    relations : tuple of tuple of str
        Unknowns of each further real equation.
    ground : str
    """

    incidences: tuple[tuple[str, str], ...]
    variables: tuple[tuple[str, ...], ...]
    relations: tuple[tuple[str, ...], ...]
    ground: str

    def form(self) -> tuple[BlockForm, tuple[str, ...]]:
        """Block form of all joint conditions, and the names of its columns."""
        return _form_of(self)

    def blocks(self) -> tuple[StructureBlock, ...]:
        """Blocks with their spanning trees and loops, in solving order."""
        return _blocks_of(self)


# designs of a family, and versions of a mechanism while it is dragged, have the same structure
_keep = lru_cache(maxsize=64)


@_keep
def _form_of(structure: Structure) -> tuple[BlockForm, tuple[str, ...]]:
    names: dict[str, int] = {}

    def columns(labels: Iterable[str]) -> list[int]:
        return [names.setdefault(label, len(names)) for label in labels]

    pattern: list[list[int]] = []
    for (body, point), variables in zip(structure.incidences, structure.variables, strict=True):
        ends = [f"point {point} x", f"point {point} y"]
        if body != structure.ground:
            ends += [f"body {body} x", f"body {body} y"]
        pattern.append(columns([*ends, *variables]))
    pattern += [columns(relation) for relation in structure.relations]
    count = [2] * len(structure.incidences) + [1] * len(structure.relations)
    return block_form(pattern, count, len(names)), tuple(names)


@_keep
def _blocks_of(structure: Structure) -> tuple[StructureBlock, ...]:
    form, _ = structure.form()
    return _Blocks(structure).of(form)


class _Blocks:
    """The blocks of a structure; ``neighbours`` is the part of the graph determined so far."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self.neighbours: dict[GraphNode, list[GraphNode]] = {}

    def of(self, form: BlockForm) -> tuple[StructureBlock, ...]:
        incidences = self.structure.incidences
        known: set[GraphNode] = {("body", self.structure.ground)}
        found: list[StructureBlock] = []
        for equations, _ in form.blocks:
            edges = [
                (("body", incidences[e][0]), ("point", incidences[e][1]))
                for e in equations
                if e < len(incidences)
            ]
            if not edges:
                continue
            block = self._block(edges, known)
            known.update(block.new)
            for body, point in edges:
                self.neighbours.setdefault(body, []).append(point)
                self.neighbours.setdefault(point, []).append(body)
            found.append(block)
        return tuple(found)

    def _block(self, edges: list[Edge], known: set[GraphNode]) -> StructureBlock:
        graph = _BlockGraph(edges, known)
        tree = graph.spanning_tree()
        wanted = len(edges) - len(graph.new)
        loops: list[tuple[GraphNode, ...]] = []
        if wanted > 0:
            candidates = graph.candidates(tree)
            walks = sorted(
                ((self._close_walk(cycle, known), cycle) for cycle in candidates),
                key=lambda pair: (len(pair[0]), pair[0]),
            )
            basis = _IndependentSet({edge: k for k, edge in enumerate(edges)})
            for walk, cycle in walks:
                # shortest first: a greedy choice of independent cycles is a minimum basis
                if len(loops) < wanted and basis.add(cycle):
                    loops.append(walk)
        return StructureBlock(tuple(graph.new), tuple(tree), tuple(loops))

    def _close_walk(self, cycle: tuple[Edge, ...], known: set[GraphNode]) -> tuple[GraphNode, ...]:
        """The walk around a cycle of block edges, closed through known bodies outside the block."""
        walk: list[GraphNode] = []
        steps = _orient_cycle(cycle, known)
        for k, (here, there) in enumerate(steps):
            walk.append(here)
            following = steps[(k + 1) % len(steps)][0]
            if there != following:
                walk += _path(self.neighbours, there, following)[:-1]
        return tuple(walk)


class _BlockGraph:
    """One block's edges, with all known bodies merged into a root."""

    def __init__(self, edges: list[Edge], known: set[GraphNode]) -> None:
        self.known = known
        self.new = list(dict.fromkeys(n for edge in edges for n in edge if n not in known))
        self.at: dict[GraphNode, list[tuple[GraphNode, Edge]]] = {_ROOT: []}
        for edge in edges:
            a, b = (self._seen(n) for n in edge)
            self.at.setdefault(a, []).append((b, edge))
            self.at.setdefault(b, []).append((a, edge))

    def _seen(self, node: GraphNode) -> GraphNode:
        return _ROOT if node in self.known else node

    def _shortest(self, source: GraphNode) -> dict[GraphNode, tuple[GraphNode, Edge]]:
        """Breadth-first parents, without the source."""
        parent: dict[GraphNode, tuple[GraphNode, Edge]] = {}
        queue = deque([source])
        while queue:
            here = queue.popleft()
            for there, edge in self.at[here]:
                if there != source and there not in parent:
                    parent[there] = (here, edge)
                    queue.append(there)
        return parent

    def spanning_tree(self) -> list[tuple[GraphNode, GraphNode]]:
        """(real parent, new node) in the order of discovery from the root."""
        return [
            (edge[0] if edge[1] == node else edge[1], node)
            for node, (_, edge) in self._shortest(_ROOT).items()
        ]

    def candidates(self, tree: list[tuple[GraphNode, GraphNode]]) -> list[tuple[Edge, ...]]:
        """Candidate cycles of a minimum basis (Horton 1987), from shortest paths of each node."""
        sources = list(self.at) if len(self.at) <= _LARGE else [_ROOT]
        found: dict[frozenset[Edge], tuple[Edge, ...]] = {}
        for source in sources:
            parent = self._shortest(source)
            used = {edge for _, edge in parent.values()}
            for here, ends in self.at.items():
                for there, edge in ends:
                    if edge in used:
                        continue
                    left = _climb(here, parent)
                    right = _climb(there, parent)
                    # the two paths share an edge: not a simple cycle
                    if set(left) & set(right):
                        continue
                    cycle = (*reversed(left), edge, *right)
                    found.setdefault(frozenset(cycle), cycle)
        return list(found.values())


def _climb(node: GraphNode, parent: Mapping[GraphNode, tuple[GraphNode, Edge]]) -> list[Edge]:
    """Edges from a node up to the source."""
    edges = []
    while node in parent:
        node, edge = parent[node]
        edges.append(edge)
    return edges


class _IndependentSet:
    """Cycles independent over GF(2), by elimination on bit masks."""

    def __init__(self, number: Mapping[Edge, int]) -> None:
        self.number = number
        self.pivots: dict[int, int] = {}

    def add(self, cycle: Iterable[Edge]) -> bool:
        """Add a cycle unless it depends on the others."""
        bits = 0
        for edge in cycle:
            bits ^= 1 << self.number[edge]
        while bits:
            lead = bits.bit_length()
            if lead not in self.pivots:
                self.pivots[lead] = bits
                return True
            bits ^= self.pivots[lead]
        return False


def _orient_cycle(cycle: tuple[Edge, ...], known: set[GraphNode]) -> list[Edge]:
    """The edges of a cycle, oriented so that each leads to the next.

    Known nodes count as one: the cycle may enter and leave it at different nodes.
    """

    def place(node: GraphNode) -> GraphNode:
        return _ROOT if node in known else node

    first = cycle[0]
    if len(cycle) == 1:
        return [first]
    if len(cycle) == 2:
        a, b = cycle
        x, y = (a if place(a[0]) == _ROOT else a[::-1]) if _ROOT in map(place, a) else a
        z, w = b if place(b[0]) == place(y) else b[::-1]
        return [(x, y), (z, w)]
    ends = {place(n) for n in cycle[1]}
    turned = first if place(first[1]) in ends else first[::-1]
    steps = [turned]
    for edge in cycle[1:]:
        at = place(steps[-1][1])
        steps.append(edge if place(edge[0]) == at else edge[::-1])
    return steps


def _path(
    neighbours: Mapping[GraphNode, list[GraphNode]], start: GraphNode, end: GraphNode
) -> list[GraphNode]:
    """Shortest path through known nodes, searched from both ends, cheaper end first."""
    parents: tuple[dict[GraphNode, GraphNode | None], dict[GraphNode, GraphNode | None]] = (
        {start: None},
        {end: None},
    )
    edge: list[list[GraphNode]] = [[start], [end]]
    while edge[0] and edge[1]:
        # expand the side with fewer edges: ground has very many
        cost = [sum(len(neighbours[n]) for n in side) for side in edge]
        side = 0 if cost[0] <= cost[1] else 1
        mine, other = parents[side], parents[1 - side]
        following: list[GraphNode] = []
        for here in edge[side]:
            for there in neighbours[here]:
                if there in mine:
                    continue
                mine[there] = here
                if there in other:
                    return _back(parents[0], there)[::-1] + _back(parents[1], there)[1:]
                following.append(there)
        edge[side] = following
    raise AssertionError("the known nodes are connected")


def _back(parent: Mapping[GraphNode, GraphNode | None], node: GraphNode) -> list[GraphNode]:
    found = [node]
    while (before := parent[found[-1]]) is not None:
        found.append(before)
    return found


# ----------------------------------------------------------------------
# Selection of links to release in overconstrained linkages.
#
# In an overconstrained linkage that can move (parallel cranks, Dixon's mechanisms), some conditions
# follow from the others. Releasing the length of a link removes one condition; this has an effect
# only if the link carries force in a self-stress, a left null vector of the Jacobian of all joint
# conditions.


#: A link and its two joint points.
Bar = tuple[str, str, str]

_STRESSED = 1e-6  # relative to the largest: smaller forces count as zero
_ALIKE = 0.5  # relative to the largest: among such links the last in the file is released


def released_links(
    frames: Frames,
    incidences: Sequence[tuple[str, str]],
    relations: Sequence[LinearEquation | LawEquation],
    unknown: set[str],
    count: int,
) -> tuple[Bar, ...]:
    """The links with two joints whose lengths are released, at most ``count``.

    Parameters
    ----------
    incidences : sequence of (body, point)
        All pairs of a body and a point on it that another body uses.
    unknown : set of str
        Symbols of the unknowns; inputs are not among them.
    """
    joined = {point for _, point in incidences}
    bars = []
    for link, points in frames.linkage.links.items():
        joints = [point for point in points if point in joined]
        own = link != GROUND and len(joints) == 2 and frames.angle[link].variable == link
        slides = any(place.sliding for place in frames.places[link].values())
        if own and canonical(link) in unknown and not slides:
            bars.append((link, joints[0], joints[1]))
    stress = _stresses(frames, incidences, relations, unknown, bars)
    if not stress.size:
        return ()
    found: list[Bar] = []
    largest = float(np.linalg.norm(stress, axis=0).max())
    for _ in range(count):
        size = np.linalg.norm(stress, axis=0)
        if size.max() <= _STRESSED * largest:
            break
        # among links with similar force, the last in the file is the redundant one; of equal bars
        # some carry exactly half the force of others, whichever way the forces are rounded
        chosen = int(np.flatnonzero(size >= (_ALIKE - _STRESSED) * size.max())[-1])
        found.append(bars[chosen])
        direction = stress[:, chosen] / size[chosen]
        # the remaining self-stresses do not load the released link
        stress = stress - np.outer(direction, direction @ stress)
    return tuple(found)


def _stresses(
    frames: Frames,
    incidences: Sequence[tuple[str, str]],
    relations: Sequence[LinearEquation | LawEquation],
    unknown: set[str],
    bars: Sequence[Bar],
) -> Array:
    """The force of every self-stress in each bar, (stresses, bars)."""
    count = len(incidences)
    ends = {(link, end): k for k, (link, _, end) in enumerate(bars)}
    entries: list[tuple[int, str, float]] = []
    elongations = np.zeros((2 * count + len(relations), len(bars)))
    scale = max((abs(z) for places in _fixed(frames) for z in places), default=1.0) or 1.0

    def add(row: int, name: str, value: complex) -> None:
        entries.extend([(row, name, value.real), (count + row, name, value.imag)])

    for k, (body, point) in enumerate(incidences):
        add(k, f"point {point} x", 1.0 + 0j)
        add(k, f"point {point} y", 1j)
        if body != GROUND:
            add(k, f"body {body} x", -1.0 + 0j)
            add(k, f"body {body} y", -1j)
        for name, slope in _slopes(frames, body, point, scale).items():
            if name in unknown:
                add(k, name, -slope)
        if (body, point) in ends:
            bar = ends[body, point]
            first = plain_value(frames.places[body][bars[bar][1]].fixed)
            along = plain_value(frames.places[body][point].fixed) - first
            angle = frames.angle[body]
            turned = plain_value(angle.constant + frames.now(angle))
            along *= cmath.exp(1j * turned) / abs(along)
            elongations[k, bar], elongations[count + k, bar] = along.real, along.imag
    for row, equation in enumerate(relations, 2 * count):
        gradient = _gradient(frames, equation).items()
        entries += [(row, name, value) for name, value in gradient if name in unknown]
    columns = {name: k for k, name in enumerate(dict.fromkeys(name for _, name, _ in entries))}
    matrix = np.zeros((len(elongations), len(columns)))
    for row, name, value in entries:
        matrix[row, columns[name]] += value
    u, sizes, _ = np.linalg.svd(matrix)
    rank = int((sizes > RANK_TOLERANCE * sizes[0]).sum()) if len(sizes) else 0
    stress: Array = u[:, rank:].T @ elongations
    return stress


def _fixed(frames: Frames) -> list[list[complex]]:
    return [
        [plain_value(place.fixed) for place in places.values()] for places in frames.places.values()
    ]


def _slopes(frames: Frames, body: str, point: str, scale: float) -> dict[str, complex]:
    """Derivatives of a point's position in a body, lengths relative to ``scale``."""
    place, angle = frames.places[body][point], frames.angle[body]
    found: dict[str, complex] = {}

    def add(name: str, value: complex) -> None:
        found[name] = found.get(name, 0j) + value

    values = {canonical(name): plain_value(value) for name, value in frames.start.items()}
    turned = plain_value(angle.constant + frames.now(angle))
    fixed = plain_value(place.fixed) / scale * cmath.exp(1j * turned)
    if angle.variable is not None:
        add(canonical(angle.variable), 1j * fixed)
    for term in place.sliding:
        direction = plain_value(term.value) * cmath.exp(
            1j * sum(w * values[n] for n, w in term.phase)
        )
        length = 1.0 / scale if term.length is None else values[term.length] / scale
        for name, weight in term.phase:
            add(name, 1j * weight * direction * length)
        if term.length is not None:
            add(term.length, direction)
    return found


def _gradient(frames: Frames, equation: LinearEquation | LawEquation) -> Mapping[str, float]:
    """Derivatives of a relation by its variables."""
    found = dict(equation.terms)
    if isinstance(equation, LawEquation):
        values = {canonical(name): plain_value(value) for name, value in frames.start.items()}
        argument = sum(w * values[n] for n, w in equation.inner) + equation.offset
        slope = float(equation.law.jet(np.array([argument]))[1][0])
        for name, weight in equation.inner:
            found[name] = found.get(name, 0.0) - slope * weight
    return found
