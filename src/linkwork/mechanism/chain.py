"""The kinematic chain of a linkage: its links and joints, without any length."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum

from linkwork.foundation.frozen import FrozenDict
from linkwork.mechanism.followers import guide_named
from linkwork.mechanism.linkage import GROUND, Linkage
from linkwork.mechanism.parts import Slider

__all__ = ["GROUND", "Chain", "Joint", "JointKind", "cylinder_ends"]


class JointKind(Enum):
    """What a joint lets its links do: its letter, its freedoms, and what it is called."""

    REVOLUTE = ("R", 1, "revolute joint")
    PRISMATIC = ("P", 1, "prismatic joint")
    PIN_IN_SLOT = ("RP", 2, "pin in slot")
    GEAR_PAIR = ("G", 2, "gear pair")
    RACK = ("G", 2, "rack and pinion")
    BELT = ("B", 2, "belt")
    ROLLING = ("W", 1, "rolling contact")
    CAM = ("C", 2, "cam")
    CURVE = ("C", 2, "pin on a curve")

    def __init__(self, letter: str, freedom: int, noun: str) -> None:
        self.letter = letter
        self.freedom = freedom
        self.noun = noun

    @property
    def lower(self) -> bool:
        """Whether it is a lower pair: its links touch in a surface, and have one freedom."""
        return self in (JointKind.REVOLUTE, JointKind.PRISMATIC)


@dataclass(frozen=True, kw_only=True)
class Joint:
    """A joint of two links, or a pin of more.

    Parameters
    ----------
    name : str
        The point of a pin; otherwise the name of slider, slot or cylinder.
    links : tuple of str
        Two; a multiple pin has more and counts as one joint less than it has links.
    point : str
        For a pin in a slot: where the pin is.
    """

    kind: JointKind
    name: str
    links: tuple[str, ...]
    point: str = ""

    @property
    def count(self) -> int:
        """How many simple joints it stands for."""
        return len(self.links) - 1

    def across(self, link: str) -> Iterator[str]:
        """The links on its other side."""
        return (other for other in self.links if other != link)


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
        links = [*linkage.links, *(end for c in linkage.cylinders for end in cylinder_ends(c.name))]
        joints = tuple(joint for read in _JOINTS for joint in read(linkage))
        chain = cls(links=tuple(links), joints=joints)
        return chain.welded(weld.links for weld in linkage.welds) if linkage.welds else chain

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
            if other == self.ground or (
                one != self.ground and self.links.index(other) < self.links.index(one)
            ):
                one, other = other, one
            became = {link: one if now == other else now for link, now in became.items()}
        joints = []
        for joint in self.joints:
            left = tuple(dict.fromkeys(became[link] for link in joint.links))
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


def cylinder_ends(cylinder: str) -> tuple[str, str]:
    """The two links of a cylinder: that of its first point, and that of its second one."""
    return f"{cylinder} barrel", f"{cylinder} rod"


def _pins(linkage: Linkage) -> Iterator[Joint]:
    """A pin wherever links share a point; a cylinder's barrel is at its first point."""
    ends = {
        c.name: dict(zip(c.between, cylinder_ends(c.name), strict=True)) for c in linkage.cylinders
    }
    for point, bodies in linkage.carriers().items():
        links = tuple(ends[body][point] if body in ends else body for body in bodies)
        if len(links) > 1:
            yield Joint(kind=JointKind.REVOLUTE, name=point, links=links)


def _sliders(linkage: Linkage) -> Iterator[Joint]:
    for slider in linkage.sliders:
        yield Joint(kind=JointKind.PRISMATIC, name=slider.name, links=(slider.link, slider.on))


def _cylinders(linkage: Linkage) -> Iterator[Joint]:
    for cylinder in linkage.cylinders:
        yield Joint(
            kind=JointKind.PRISMATIC, name=cylinder.name, links=cylinder_ends(cylinder.name)
        )


def _slots(linkage: Linkage) -> Iterator[Joint]:
    for slot in linkage.slots:
        pinned = next(_pinned(linkage, slot.point))
        yield Joint(
            kind=JointKind.PIN_IN_SLOT,
            name=slot.name,
            links=(pinned, slot.on),
            point=slot.point,
        )


def _pinned(linkage: Linkage, point: str) -> Iterator[str]:
    """The links that carry a point, cylinders by their ends."""
    yield from linkage.bodies_at(point)
    for cylinder in linkage.cylinders:
        if point in cylinder.between:
            yield cylinder_ends(cylinder.name)[cylinder.between.index(point)]


def _wheels(linkage: Linkage) -> Iterator[Joint]:
    """Gears, belts, racks and rolling wheels."""
    for gear in linkage.gears:
        yield Joint(kind=JointKind.GEAR_PAIR, name=gear.name, links=gear.wheels)
    for belt in linkage.belts:
        yield Joint(kind=JointKind.BELT, name=belt.name, links=belt.wheels)
    for rack in linkage.racks:
        slider = next(s for s in linkage.sliders if s.name == rack.slider)
        yield Joint(kind=JointKind.RACK, name=rack.name, links=(rack.pinion, slider.link))
    for part in linkage.rolling:
        yield Joint(kind=JointKind.ROLLING, name=part.name, links=(part.wheel, part.on))


def _curves(linkage: Linkage) -> Iterator[Joint]:
    """Cams with their followers, and pins on curves."""
    for cam in linkage.cams:
        follower = cam.link
        if follower is None:
            guide = guide_named(linkage, cam.slider)
            assert guide is not None
            follower = (
                guide.link if isinstance(guide, Slider) else next(_pinned(linkage, guide.point))
            )
        yield Joint(kind=JointKind.CAM, name=cam.name, links=(cam.cam, follower))
    for curve in linkage.curves:
        pinned = next(_pinned(linkage, curve.point))
        yield Joint(kind=JointKind.CURVE, name=curve.name, links=(pinned, curve.on))


#: How joints are read off a linkage: a further kind of joint is one further entry.
_JOINTS: tuple[Callable[[Linkage], Iterator[Joint]], ...] = (
    _pins,
    _sliders,
    _cylinders,
    _slots,
    _wheels,
    _curves,
)
