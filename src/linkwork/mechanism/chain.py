"""The kinematic chain of a linkage: its links and joints, without any length."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.names import GROUND
from linkwork.mechanism.joint import Joint, JointKind
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.weld import Weld

__all__ = ["GROUND", "Chain"]


@dataclass(frozen=True, kw_only=True)
class Chain:
    """Links and their joints.

    Parameters
    ----------
    links : tuple of str
        In the file's order. A cylinder has two, its ``barrel`` and its ``rod``.
    blocks : frozenset of str
        Links without extent that stand for pins in slots; see :meth:`with_blocks`.
    united : Mapping[str, str]
        Links that are welded to another one, and that one; see :meth:`welded`.
    """

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    ground: str = GROUND
    blocks: frozenset[str] = frozenset()
    united: Mapping[str, str] = FrozenDict()

    @classmethod
    def of(cls, linkage: Linkage) -> Chain:
        """The chain of a linkage, whatever is driven."""
        links = [*linkage.links, *(end for part in linkage.parts for end in part.ends)]
        joints = [joint for part in linkage.parts if (joint := part.joint(linkage)) is not None]
        joints.sort(key=lambda joint: not joint.kind.lower)
        chain = cls(links=tuple(links), joints=(*_pins(linkage), *joints))
        welds = linkage.of(Weld)
        return chain.welded(weld.links for weld in welds) if welds else chain

    @property
    def mobility(self) -> int:
        """Grübler's count 3 (n - 1) - Σ (3 - freedoms), a pin of k links as k - 1 joints."""
        lost = sum((3 - joint.kind.freedom) * joint.count for joint in self.joints)
        return 3 * (len(self.links) - 1) - lost

    @property
    def simple(self) -> bool:
        """Whether no pin joins more than two links and no links have two joints in common."""
        pairs = [frozenset(joint.links) for joint in self.joints]
        return len(set(pairs)) == len(pairs) and all(len(pair) == 2 for pair in pairs)

    def at(self, link: str) -> list[Joint]:
        """The joints of a link."""
        return [joint for joint in self.joints if link in joint.links]

    def joined(self, first: str, second: str) -> Joint | None:
        """The joint of two links, if they have one."""
        return next((j for j in self.joints if first in j.links and second in j.links), None)

    def with_blocks(self) -> Chain:
        """The chain of lower pairs only: a pin in a slot becomes a block, pinned and sliding.

        The motion is the same, and so is the mobility: three freedoms more and three fewer.
        """
        links, joints = list(self.links), []
        pins = {joint.name: joint for joint in self.joints if joint.kind is JointKind.REVOLUTE}
        for joint in self.joints:
            if joint.kind is not JointKind.PIN_IN_SLOT:
                continue
            pinned, guide = joint.links
            links.append(joint.name)
            there = pins.get(joint.point) or Joint(
                kind=JointKind.REVOLUTE, name=joint.point, links=(pinned,)
            )
            # a pin that exists already joins the block as a further link
            pins[joint.point] = replace(there, links=(*there.links, joint.name))
            joints.append(
                Joint(kind=JointKind.PRISMATIC, name=joint.name, links=(joint.name, guide))
            )
        kept = [joint for joint in self.joints if joint.kind is JointKind.PRISMATIC]
        higher = [j for j in self.joints if not j.kind.lower and j.kind != JointKind.PIN_IN_SLOT]
        return replace(
            self,
            links=tuple(links),
            joints=(*pins.values(), *kept, *joints, *higher),
            blocks=frozenset(links[len(self.links) :]),
        )

    def called(self, link: str) -> str:
        """The link of the chain that a link belongs to."""
        return self.united.get(link, link)

    def members(self, link: str) -> tuple[str, ...]:
        """A link of the chain with all that are welded to it."""
        return (link, *(other for other, one in self.united.items() if one == link))

    def welded(self, pairs: Iterable[tuple[str, str]]) -> Chain:
        """The chain in which the links of each pair are one.

        They take the name of the ground if it is among them, else of the first in order.
        """
        became = {link: link for link in self.links} | dict(self.united)
        for first, second in pairs:
            one, other = became[first], became[second]
            # the ground keeps its name; otherwise the link that comes first does
            if other == self.ground or (
                one != self.ground and self.links.index(other) < self.links.index(one)
            ):
                one, other = other, one
            became = {link: one if now == other else now for link, now in became.items()}
        joints = []
        for joint in self.joints:
            left = tuple(dict.fromkeys(became[link] for link in joint.links))
            # a joint between welded links is no longer a joint
            if len(left) > 1:
                joints.append(replace(joint, links=left))
        return replace(
            self,
            links=tuple(link for link in self.links if became[link] == link),
            joints=tuple(joints),
            united=FrozenDict({link: one for link, one in became.items() if link != one}),
        )

    def loop_through(self, joint: Joint, first: str, second: str) -> list[tuple[Joint, ...]]:
        """Every closed loop of four links through a joint: its joints, beginning with that one.

        The loop leaves ``first`` over ``joint`` to ``second`` and comes back to ``first``.
        """
        found: list[tuple[Joint, ...]] = []
        for to_third in self.at(second):
            for third in to_third.across(second):
                if to_third is joint or third == first:
                    continue
                for to_fourth in self.at(third):
                    for fourth in to_fourth.across(third):
                        if fourth in (first, second) or to_fourth in (joint, to_third):
                            continue
                        found += [
                            (joint, to_third, to_fourth, back)
                            for back in self.at(fourth)
                            if first in back.links and back not in (joint, to_third, to_fourth)
                        ]
        return found


def _pins(linkage: Linkage) -> Iterator[Joint]:
    """A pin wherever links share a point; a cylinder's barrel is at its first point."""
    # a cylinder is a body of the sketch and two links of the chain, one at each end
    ends = {part.label: dict(zip(part.body, part.ends, strict=True)) for part in linkage.parts}
    for point, bodies in linkage.carriers().items():
        links = tuple(ends[body][point] if body in ends else body for body in bodies)
        if len(links) > 1:
            yield Joint(kind=JointKind.REVOLUTE, name=point, links=links)
