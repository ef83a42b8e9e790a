"""What a mechanism looks like, without numbers: which points to join, hatch, slide and trace."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from linkwork.mechanism.contact_shapes import ContactShapes
from linkwork.mechanism.linkage import GROUND, Linkage

__all__ = ["Bar", "DrivenPart", "Guide", "Rail", "RigidJoint", "Skeleton", "Strut"]


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A rigid link and the points it carries; three or more make a filled polygon."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Guide:
    """A slider or slot: ``point`` runs along the line through two points of the body ``on``.

    ``offset`` is the distance of ``point`` to the left of the line. ``block`` tells a sliding
    block (prismatic joint) from a pin in a slot; ``link`` is the one that slides.
    """

    name: str
    point: str
    on: str
    line: tuple[str, str]
    offset: float = 0.0
    block: bool = False
    link: str = ""


@dataclass(frozen=True, kw_only=True)
class Rail:
    """A straight line that points of one body run along; ``name`` is that of the variable that
    tells how far they are.

    On ground ``along`` is its direction, a unit vector; on a link it runs from the first to the
    second point of ``line``.
    """

    name: str
    points: tuple[str, ...]
    along: complex = 1.0 + 0.0j
    on: str = GROUND
    line: tuple[str, str] | None = None


@dataclass(frozen=True, kw_only=True)
class Strut:
    """A cylinder or a spring: something of variable length between two points."""

    name: str
    between: tuple[str, str]


@dataclass(frozen=True, kw_only=True)
class RigidJoint:
    """Two links that are welded together at a point that both carry."""

    links: tuple[str, str]
    point: str


@dataclass(frozen=True, kw_only=True)
class DrivenPart:
    """What an input drives: ``kind`` is link, slider or cylinder; ``pivot`` a pin of the link.

    ``backwards`` tells that it is driven towards smaller values.
    """

    kind: str
    name: str
    pivot: str | None = None
    backwards: bool = False


@dataclass(frozen=True, kw_only=True)
class Skeleton:
    """Everything a picture needs to know besides coordinates.

    ``fixed`` are the points that stand still, ``pins`` the points where bodies are joined.
    """

    fixed: tuple[str, ...] = ()
    bars: tuple[Bar, ...] = ()
    pins: tuple[str, ...] = ()
    guides: tuple[Guide, ...] = ()
    rails: tuple[Rail, ...] = ()
    struts: tuple[Strut, ...] = ()
    springs: tuple[Strut, ...] = ()
    rigid: tuple[RigidJoint, ...] = ()
    driven: tuple[DrivenPart, ...] = ()
    traced: tuple[str, ...] = ()
    contacts: ContactShapes = field(default_factory=ContactShapes)

    @classmethod
    def of_linkage(
        cls, linkage: Linkage, outlines: Mapping[str, tuple[str, str, Iterable[complex]]]
    ) -> Skeleton:
        """The skeleton of a points-and-links mechanism.

        ``outlines``: body, centre and points of every cam and curve by name.
        """
        carriers = linkage.carriers()
        guided = {slot.point for slot in linkage.slots} | {curve.point for curve in linkage.curves}
        contacts = ContactShapes.of(linkage, outlines)
        guided |= {disc.center for disc in contacts.discs if disc.kind == "roller"}
        guided |= {point for spring in linkage.springs for point in spring.between}
        rigid = tuple(_rigid_joints(linkage))
        return cls(
            fixed=linkage.links[GROUND],
            bars=tuple(
                Bar(name=name, points=points)
                for name, points in linkage.links.items()
                if name != GROUND
            ),
            pins=tuple(p for p, n in _bodies(carriers, rigid).items() if n > 1 or p in guided),
            guides=tuple(
                [Guide(name=s.name, point=s.point, on=s.on, line=s.line) for s in linkage.slots]
                + [
                    Guide(
                        name=s.name,
                        point=point,
                        on=s.on,
                        line=s.line,
                        offset=linkage.numbers(s.offset),
                        block=True,
                        link=s.link,
                    )
                    for s in linkage.sliders
                    for point in s.points
                ]
            ),
            struts=tuple(Strut(name=c.name, between=c.between) for c in linkage.cylinders),
            springs=tuple(Strut(name=s.name, between=s.between) for s in linkage.springs),
            rigid=rigid,
            driven=tuple(_driven_parts(linkage, carriers)),
            traced=linkage.trace,
            contacts=contacts,
        )

    @classmethod
    def of_points(
        cls,
        links: Mapping[str, tuple[str, ...]],
        fixed: tuple[str, ...],
        traced: tuple[str, ...],
        driven: tuple[DrivenPart, ...],
        rails: tuple[Rail, ...] = (),
    ) -> Skeleton:
        """The skeleton of a mechanism given by equations: its drawable points and links."""
        bars = tuple(
            Bar(name=name, points=points) for name, points in links.items() if name != GROUND
        )
        joined = [p for points in links.values() for p in points]
        bodies = Counter([*joined, *fixed, *_joined_to_blocks(links, rails)])
        pins = tuple(p for p in dict.fromkeys(joined) if bodies[p] > 1)
        return cls(fixed=fixed, bars=bars, pins=pins, rails=rails, driven=driven, traced=traced)


def _joined_to_blocks(
    links: Mapping[str, tuple[str, ...]], rails: tuple[Rail, ...]
) -> Iterator[str]:
    """Points at which a link that does not slide itself is joined to a block on a rail."""
    for rail in rails:
        for points in links.values():
            on = [point for point in points if point in rail.points]
            yield from on if len(on) < len(points) else ()


def _rigid_joints(linkage: Linkage) -> Iterator[RigidJoint]:
    for weld in linkage.welds:
        first, second = (linkage.links[name] for name in weld.links)
        yield RigidJoint(links=weld.links, point=next(p for p in first if p in second))


def _bodies(carriers: Mapping[str, list[str]], rigid: tuple[RigidJoint, ...]) -> Mapping[str, int]:
    """How many bodies meet at each point: links that are welded there are one."""
    welded = [joint.point for joint in rigid]
    return {point: len(links) - welded.count(point) for point, links in carriers.items()}


def _driven_parts(linkage: Linkage, carriers: Mapping[str, list[str]]) -> list[DrivenPart]:
    found = []
    for which in linkage.inputs:
        kind, name = which.drives
        back = linkage.falls(which)
        if kind == "joint":
            part = DrivenPart(kind="link", name=carriers[name][-1], pivot=name, backwards=back)
            found.append(part)
        elif kind == "link":
            base = linkage.links[which.relative_to or GROUND]
            shared = [p for p in linkage.links[name] if p in base]
            pivot = shared[0] if shared else None
            found.append(DrivenPart(kind="link", name=name, pivot=pivot, backwards=back))
        else:
            found.append(DrivenPart(kind=kind, name=name, backwards=back))
    return found
