"""A loop of four links with their lengths between pins, from which its type follows."""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

from linkwork.equations.model import LinkAngle
from linkwork.foundation.names import GROUND
from linkwork.mechanism.chain import Chain
from linkwork.mechanism.joint import Joint, JointKind
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.guide import GuidePart
from linkwork.mechanism.part.slider import Slider

__all__ = ["FourLinkLoop", "driven_joints", "input_loop"]


@dataclass(frozen=True, kw_only=True)
class FourLinkLoop:
    """Links around a loop, ground first, and the joints between each and the next one.

    ``driven``: the joint of the loop that the input drives, if there is one.
    """

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    driven: Joint | None

    @property
    def letters(self) -> str:
        """The kinds of joints, ``RRRP``, beginning at ground."""
        return "".join(joint.kind.letter for joint in self.joints)

    def ends(self, link: str) -> tuple[Joint, Joint]:
        """The joint before a link and the joint after it."""
        k = self.links.index(link)
        return self.joints[k - 1], self.joints[k]

    def carries_its_pins(self, linkage: Linkage, link: str) -> bool:
        """Whether both joints of a link are pins of its own, not of links welded to it."""
        return all(
            joint.kind is JointKind.REVOLUTE and joint.name in linkage.links[link]
            for joint in self.ends(link)
        )

    def length(self, linkage: Linkage, link: str) -> float:
        """The distance between the two pins of a link."""
        before, after = self.ends(link)
        local = linkage.shapes.local[link]
        return abs(local[after.name] - local[before.name])

    def offset(self, linkage: Linkage, angles: Mapping[str, LinkAngle]) -> float:
        """The distance of the two pins next to the only sliding joint, across its direction."""
        slide, guide = self._slide(linkage)
        if guide is None:  # a cylinder pulls along the line of its pins
            return 0.0
        on = linkage.shapes.local[guide.on]
        foot, end = (on[p] for p in guide.line)
        along = (end - foot) / abs(end - foot)
        pin = next(j.name for j in self.ends(guide.on) if j is not slide)
        across = ((on[pin] - foot) * along.conjugate()).imag
        if not isinstance(guide, Slider):  # a pin on the line itself
            return abs(across)
        own = linkage.shapes.local[guide.link]
        own_pin = next(j.name for j in self.ends(guide.link) if j is not slide)
        turn = cmath.exp(1j * (_constant(angles, guide.link) - _constant(angles, guide.on)))
        aside = ((own[own_pin] - own[guide.points[0]]) * turn * along.conjugate()).imag
        return abs(linkage.numbers(guide.offset) + aside - across)

    def guide(self, linkage: Linkage) -> str | None:
        """The link with the line of the only sliding joint; a cylinder has none."""
        _, guide = self._slide(linkage)
        return None if guide is None else guide.on

    def _slide(self, linkage: Linkage) -> tuple[Joint, GuidePart | None]:
        """The only sliding joint, and the slider or slot that it is."""
        slide = next(j for j in self.joints if j.kind is JointKind.PRISMATIC)
        guides = linkage.of(GuidePart)
        return slide, next((guide for guide in guides if guide.name == slide.name), None)


def _constant(angles: Mapping[str, LinkAngle], link: str) -> float:
    return 0.0 if link == GROUND else angles[link].constant


def driven_joints(linkage: Linkage, chain: Chain) -> list[Joint | None]:
    """For every input the joint of ``chain`` that it drives, if it drives one directly."""
    found: list[Joint | None] = []
    for which in linkage.inputs:
        kind, name = which.drives
        if kind in ("slider", "cylinder"):
            found.append(next(joint for joint in chain.joints if joint.name == name))
            continue
        pair = (name, which.relative_to or GROUND)
        if kind == "joint":
            first, second = linkage.bodies_at(name)
            pair = (first, second)
        ends = {chain.called(link) for link in pair}
        pins = (j for j in chain.joints if j.kind is JointKind.REVOLUTE and ends <= {*j.links})
        found.append(next(pins, None))
    return found


def input_loop(linkage: Linkage, chain: Chain) -> FourLinkLoop | None:
    """The loop of four links from ground over the driven joint, or around a four-link chain.

    ``None`` if there is no such loop of lower pairs, or more than one, or if a length of it leads
    across a weld.
    """
    driven = driven_joints(linkage, chain)
    lead = driven[0] if len(driven) == 1 else None
    start = lead if lead is not None and chain.ground in lead.links else None
    if start is None:
        if len(chain.links) != 4:
            return None
        start = chain.at(chain.ground)[0]
    loops = [
        (second, joints)
        for second in start.across(chain.ground)
        for joints in chain.loop_through(start, chain.ground, second)
        if all(joint.kind.lower for joint in joints)
        and sum(joint.kind is JointKind.PRISMATIC for joint in joints) <= 1
    ]
    if len(loops) != 1:
        return None
    ((second, joints),) = loops
    links = [chain.ground, second]
    for joint, onward in pairwise(joints[1:]):
        links.append(next(c for c in joint.across(links[-1]) if c in onward.links))
    loop = FourLinkLoop(links=tuple(links), joints=joints, driven=lead if lead in joints else None)
    welded = (link for link in links if len(chain.members(link)) > 1)
    return loop if all(loop.carries_its_pins(linkage, link) for link in welded) else None
