"""The joints of a linkage as a graph: pins and slides between bodies, couplings of wheels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.part import Coupling, Pair, PairKind, Part
from linkwork.forces.reactions.geometry import Geometry


@dataclass
class JointGraph:
    """Bodies with their points, the joints between them, and the couplings.

    ``turning``: the variable that is the angle of a body that is no link; ``blocks``: bodies that
    turn with another one, on which they slide; ``unpinned``: bodies that only their part joins.
    """

    linkage: Linkage
    bodies: dict[str, tuple[str, ...]] = field(default_factory=dict)
    edges: list[Pair] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    turning: dict[str, str] = field(default_factory=dict)
    blocks: dict[str, str] = field(default_factory=dict)
    unpinned: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, linkage: Linkage) -> JointGraph:
        """The graph of a linkage.

        Raises
        ------
        InputError
            If a part has no equivalent in the formats of robots.
        """
        graph = cls(linkage, {GROUND: (), **linkage.links})
        for part in linkage.parts:
            graph._add(part)
        graph._pins()
        return graph

    def _add(self, part: Part) -> None:
        pairs = part.pairs(self.linkage)
        if pairs is None:
            raise InputError(
                f'"{part.label}" ({part.title.lower()}) has no equivalent in files for '
                "robots: they have pins, slides and constant ratios only"
            )
        for body in pairs.bodies:
            self.bodies[body.name] = body.points
            if body.angle:
                self.turning[body.name] = body.angle
            if body.on:
                self.blocks[body.name] = body.on
            if not body.pinned:
                self.unpinned.add(body.name)
        self.edges += pairs.pairs
        self.couplings += pairs.couplings

    def _pins(self) -> None:
        """A pin from the first body at every point to each further body."""
        welded = {edge.bodies for edge in self.edges if edge.kind is PairKind.FIXED}
        for point in self.linkage.points:
            here = [b for b, on in self.bodies.items() if point in on and b not in self.unpinned]
            for k, body in enumerate(here[1:], 1):
                known = here[:k]
                # welded bodies need no pin between them
                if not any({(body, other), (other, body)} & welded for other in known):
                    ends = (here[0], body)
                    pin = Pair(kind=PairKind.PIN, name=point, bodies=ends, point=point)
                    self.edges.append(pin)

    def driven(self) -> Mapping[frozenset[str], int]:
        """Pairs of bodies whose relative angle is driven."""
        pairs = {}
        for k, which in enumerate(self.linkage.inputs):
            kind, name = which.drives
            if kind == "link":
                pairs[frozenset({name, which.relative_to or GROUND})] = k
            elif kind == "joint":
                pairs[frozenset(list(self.linkage.bodies_at(name))[:2])] = k
        return pairs


# ----------------------------------------------------------------------
# A tree of joints from ground to every body, and the joints that close its loops.
#
# All joint values are zero in the start position. The frame of a body has its origin at the joint
# that carries it, and its x axis along the body.


@dataclass(frozen=True, kw_only=True)
class TreeJoint:
    """The joint that carries a body; ``sign``: -1 if the displacement counts the other way."""

    edge: Pair
    parent: str
    child: str
    sign: float

    @property
    def name(self) -> str:
        """A name that no other joint has: every body has one joint."""
        return f"{self.edge.name}:{self.child}".replace(" ", "_")


@dataclass
class JointTree:
    """The tree of a mechanism.

    ``joints`` are in an order in which parents come first; ``closing`` are the joints left out.
    """

    graph: JointGraph
    joints: list[TreeJoint] = field(default_factory=list)
    closing: list[Pair] = field(default_factory=list)

    @classmethod
    def of(cls, graph: JointGraph) -> JointTree:
        """A tree that prefers welds, driven joints, slides, and pins at ground, in this order.

        Raises
        ------
        InputError
            If a body is not joined to ground.
        """
        tree, driven = cls(graph), graph.driven()
        group = {body: body for body in graph.bodies}
        taken: list[Pair] = []

        def order(edge: Pair) -> tuple[int, int, bool]:
            pair = frozenset(edge.bodies)
            later = edge.kind is not PairKind.FIXED and pair not in driven
            return int(later), edge.kind.value, GROUND not in pair

        for edge in sorted(graph.edges, key=order):
            first, second = (group[body] for body in edge.bodies)
            if first == second:
                tree.closing.append(edge)
                continue
            taken.append(edge)
            group = {body: first if g == second else g for body, g in group.items()}
        loose = [body for body, g in group.items() if g != group[GROUND]]
        if loose:
            raise InputError(
                f'"{loose[0]}" is not joined to ground by pins and slides: a robot is one tree'
            )
        tree.closing = [tree._closed(edge, taken) for edge in tree.closing]
        tree._grow(taken)
        return tree

    def _closed(self, edge: Pair, taken: list[Pair]) -> Pair:
        """The joint that closes a loop: a slide becomes a sliding block and a weld to it."""
        if edge.kind is not PairKind.SLIDE:
            return edge
        on, link = edge.bodies
        block = f"{edge.name} block"
        self.graph.bodies[block] = (edge.point,)
        self.graph.blocks[block] = on
        taken.append(replace(edge, bodies=(on, block)))
        return replace(edge, kind=PairKind.FIXED, bodies=(block, link), line=None)

    def _grow(self, taken: list[Pair]) -> None:
        reached, left = [GROUND], list(taken)
        for parent in reached:  # grows meanwhile
            for edge in [edge for edge in left if parent in edge.bodies]:
                child = edge.bodies[1] if edge.bodies[0] == parent else edge.bodies[0]
                sign = 1.0 if edge.bodies[0] == parent else -1.0
                self.joints.append(TreeJoint(edge=edge, parent=parent, child=child, sign=sign))
                reached.append(child)
                left.remove(edge)

    @cached_property
    def by_child(self) -> dict[str, TreeJoint]:
        """The joint of every body."""
        return {joint.child: joint for joint in self.joints}

    def origin(self, body: str) -> str:
        """The point at the origin of a body's frame."""
        edge = self.by_child[body].edge
        points = self.graph.bodies[body]
        return edge.point if edge.point in points else points[0]

    def path(self, body: str) -> list[TreeJoint]:
        """The joints from a body back to ground."""
        path = []
        while body != GROUND:
            path.append(self.by_child[body])
            body = path[-1].parent
        return path

    def ratios(self, coupling: Coupling) -> dict[str, float]:
        """The factors of joint values whose sum is zero, by joint.

        Raises
        ------
        InputError
            If the displacement of a coupling is no joint of the tree.
        """
        factors: dict[str, float] = {}
        for body, factor in coupling.turns:
            for joint in self.path(body):
                if joint.edge.kind is PairKind.PIN:
                    factors[joint.name] = factors.get(joint.name, 0.0) + factor
        for name, factor in coupling.slides:
            joint = next(
                j for j in self.joints if j.edge.kind is PairKind.SLIDE and j.edge.name == name
            )
            factors[joint.name] = factors.get(joint.name, 0.0) + factor * joint.sign
        size = max(map(abs, factors.values()), default=0.0)
        # multiples that cancel leave their rounding
        return {name: f for name, f in factors.items() if abs(f) > 1e-12 * size}

    def angle(self, geometry: Geometry, body: str) -> tuple[Array, Array]:
        """The angle of a body and its derivative, (B,)."""
        body = self.graph.blocks.get(body, body)
        variable = self.graph.turning.get(body)
        jet = geometry.angle(body) if variable is None else geometry.own(variable)
        return jet.v, jet.d1

    def value(self, geometry: Geometry, joint: TreeJoint) -> tuple[Array, Array]:
        """The value of a joint, not yet from zero, and its derivative, [rad] or [length], (B,)."""
        if joint.edge.kind is PairKind.SLIDE:
            jet, rate = geometry.own(joint.edge.name), None
            inputs = [each.name for each in geometry.driven.equations.inputs]
            if joint.edge.name in inputs:  # of inputs a motion knows the rate of the leading one
                rate = geometry.input_rates[inputs.index(joint.edge.name)]
            d1 = jet.d1 if rate is None else rate + np.zeros_like(jet.v)
            return joint.sign * jet.v, joint.sign * d1
        child, parent = (self.angle(geometry, body) for body in (joint.child, joint.parent))
        turn = np.array(child[0] - parent[0])
        # a row without a position must not affect other rows
        known = np.isfinite(turn)
        turn[known] = np.unwrap(turn[known])
        return turn, child[1] - parent[1]
