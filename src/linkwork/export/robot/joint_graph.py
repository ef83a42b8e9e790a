"""The joints of a linkage as a graph: pins and slides between bodies, couplings of wheels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.pairs import Coupling, Pair, PairKind
from linkwork.mechanism.part.part import Part

__all__ = ["JointGraph"]


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
        own = cls(linkage, {GROUND: (), **linkage.links})
        for part in linkage.parts:
            own._add(part)
        own._pins()
        return own

    def _add(self, part: Part) -> None:
        found = part.pairs(self.linkage)
        if found is None:
            raise InputError(
                f'"{part.label}" ({part.title.lower()}) has no equivalent in files for '
                "robots: they have pins, slides and constant ratios only"
            )
        for body in found.bodies:
            self.bodies[body.name] = body.points
            if body.angle:
                self.turning[body.name] = body.angle
            if body.on:
                self.blocks[body.name] = body.on
            if not body.pinned:
                self.unpinned.add(body.name)
        self.edges += found.pairs
        self.couplings += found.couplings

    def _pins(self) -> None:
        """A pin from the first body at every point to each of the others."""
        welded = {edge.bodies for edge in self.edges if edge.kind is PairKind.FIXED}
        for point in self.linkage.points:
            here = [b for b, own in self.bodies.items() if point in own and b not in self.unpinned]
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
