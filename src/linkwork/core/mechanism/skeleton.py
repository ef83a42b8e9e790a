"""Marks: second points that give one-point wheels, cams and grounds a direction."""

from __future__ import annotations

import cmath
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TypeVar

from linkwork.core.foundation.names import GROUND, canonical, free_name
from linkwork.core.mechanism.bodies import (
    DiscFigure,
    Figure,
    Guide,
    Mesh,
    Outlines,
)
from linkwork.core.mechanism.description import Question
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.linkage import Draft, Linkage
from linkwork.core.mechanism.part.guides import Slider, Strut
from linkwork.core.mechanism.part.springs import RigidJoint


def directed(linkage: Linkage, angles: Mapping[str, float]) -> Linkage:
    """The linkage with a mark on every wheel, cam and ground of one point.

    A mark is a second point, in the direction of the link's angle, so that no angle changes.

    Parameters
    ----------
    angles : Mapping[str, float]
        The angles of links in the sketch [rad]; that of ground is zero.
    """
    blocks = {slider.link for slider in linkage.of(Slider)}
    bare = [
        link
        for link, points in linkage.links.items()
        if len(points) == 1
        and (link == GROUND or (link in linkage.turning_on_one_point and link not in blocks))
    ]
    if not bare:
        return linkage
    taken = set(map(canonical, named_in(linkage)))
    points, links, lengths = dict(linkage.points), dict(linkage.links), dict(linkage.lengths)
    for link in bare:
        (center,) = linkage.links[link]
        mark, size = free_name(f"{link}_mark", taken), _size(linkage, link)
        x, y = linkage.points[center]
        points[mark] = _beside((x, y), cmath.rect(size, angles.get(link, 0.0)))
        links[link] = (center, mark)
        if link != GROUND:
            lengths[f"{center} {mark}"] = size
    return replace(linkage, points=points, links=links, lengths=lengths)


def _size(linkage: Linkage, link: str) -> float:
    """The radius of a wheel or a cam's base circle, otherwise the largest extent of a link."""
    for part in linkage.parts:
        size = part.size_of(link, linkage)
        if size is not None:
            return size
    shapes = linkage.shapes.local.values()
    return (
        max((abs(a - b) for own in shapes for a in own.values() for b in own.values()), default=0.0)
        or 1.0
    )


def _beside(place: tuple[Number, ...], span: complex) -> tuple[Number, ...]:
    """The coordinates of a point that is away from another one."""
    x, y = place
    return _sum(x, span.real), _sum(y, span.imag)


def _sum(x: Number, size: float) -> Number:
    if not size:
        return x
    return f"({x}) + ({size!r})" if isinstance(x, str) else x + size


def named_in(linkage: Linkage) -> Iterator[str]:
    """All names used in a linkage."""
    yield from linkage.points
    yield from linkage.links
    yield from linkage.dimensions
    yield from linkage.outputs
    for part in linkage.parts:
        yield from part.names


# ----------------------------------------------------------------------
# The structure of a drawing without coordinates: bars, rails, pins, figures and traces.


F = TypeVar("F", bound=Figure)


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A rigid link and its points; three or more form a filled polygon."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Rail:
    """A straight line along which points of one body move; ``name`` is the variable of their
    displacement.

    On ground ``along`` is its direction, a unit vector; on a link it runs from the first to the
    second point of ``line``.
    """

    name: str
    points: tuple[str, ...]
    along: complex = 1.0 + 0.0j
    on: str = GROUND
    line: tuple[str, str] | None = None


@dataclass(frozen=True, kw_only=True)
class DrivenPart:
    """The driven part: ``kind`` is link, slider or cylinder; ``pivot`` is a pin of the link.

    ``backwards``: the driven quantity decreases.
    """

    kind: str
    name: str
    pivot: str | None = None
    backwards: bool = False


@dataclass(frozen=True, kw_only=True)
class Skeleton:
    """The data of a picture except coordinates.

    ``fixed`` are the points on ground, ``pins`` the points where bodies are joined; ``questions``
    are asked beside the picture.
    """

    fixed: tuple[str, ...] = ()
    bars: tuple[Bar, ...] = ()
    pins: tuple[str, ...] = ()
    guides: tuple[Guide, ...] = ()
    rails: tuple[Rail, ...] = ()
    struts: tuple[Strut, ...] = ()
    driven: tuple[DrivenPart, ...] = ()
    traced: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    questions: tuple[Question, ...] = ()

    @classmethod
    def of_linkage(cls, linkage: Draft, outlines: Outlines) -> Skeleton:
        """The skeleton of a points-and-links mechanism.

        ``outlines``: body, centre and points of every cam and curve by name.
        """
        carriers = linkage.carriers()
        figures = _merged(f for part in linkage.parts for f in part.figures(linkage, outlines))
        pinned = {point for figure in figures for point in figure.pins}
        return cls(
            fixed=linkage.links[GROUND],
            bars=tuple(
                Bar(name=name, points=points)
                for name, points in linkage.links.items()
                if name != GROUND
            ),
            pins=tuple(p for p, n in _bodies(carriers, figures).items() if n > 1 or p in pinned),
            guides=tuple(figure for figure in figures if isinstance(figure, Guide)),
            struts=tuple(figure for figure in figures if isinstance(figure, Strut)),
            driven=tuple(_driven_parts(linkage, carriers)),
            traced=linkage.trace,
            figures=tuple(f for f in figures if not isinstance(f, Guide | Strut)),
        )

    def of(self, kind: type[F]) -> tuple[F, ...]:
        """The figures of one kind."""
        return tuple(figure for figure in self.figures if isinstance(figure, kind))

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
    """Points at which a non-sliding link is joined to a block on a rail."""
    for rail in rails:
        for points in links.values():
            on = [point for point in points if point in rail.points]
            yield from on if len(on) < len(points) else ()


def _merged(figures: Iterable[Figure]) -> list[Figure]:
    """Figures without duplicate wheels, wheels first; teeth may be known from one mesh only."""
    found: dict[tuple[str, str, str], DiscFigure] = {}
    others: list[Figure] = []
    for figure in figures:
        if not isinstance(figure, DiscFigure):
            others.append(figure)
            continue
        known = found.setdefault(figure.key, figure)
        if known.teeth is None and figure.teeth is not None:
            found[figure.key] = replace(known, teeth=figure.teeth)
    for k, figure in enumerate(others):
        if isinstance(figure, Mesh):
            first, second = figure.discs
            others[k] = replace(figure, discs=(found[first.key], found[second.key]))
    return [*found.values(), *others]


def _bodies(carriers: Mapping[str, list[str]], figures: Iterable[Figure]) -> Mapping[str, int]:
    """The number of bodies at each point; links welded there count as one."""
    welded = [joint.point for joint in figures if isinstance(joint, RigidJoint)]
    return {point: len(links) - welded.count(point) for point, links in carriers.items()}


def _driven_parts(linkage: Draft, carriers: Mapping[str, list[str]]) -> list[DrivenPart]:
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


# ----------------------------------------------------------------------
# Dyads: pairs of pinned links whose outer joints are on parts of known position.
#
# The pin between the links transmits the force. The search starts from ground and the driven links;
# structures that are not chains of dyads are skipped.


@dataclass(frozen=True, kw_only=True)
class Dyad:
    """Two links with a common pin.

    Parameters
    ----------
    pin : str
        The point on both links.
    links : (str, str)
        The driving link and the driven link.
    arms : (str, str)
        The outer point of each link; "" for a sliding link.
    guide : Guide, optional
        The guide of the second link, if it slides.
    """

    pin: str
    links: tuple[str, str]
    arms: tuple[str, str]
    guide: Guide | None = None


def dyads_of(skeleton: Skeleton) -> tuple[Dyad, ...]:
    """The dyads of a mechanism in the order in which they can be solved.

    Cost: cubic in the number of links.
    """
    bodies = {GROUND: set(skeleton.fixed)} | {bar.name: set(bar.points) for bar in skeleton.bars}
    known = {GROUND, *_driven(skeleton)}
    found: list[Dyad] = []
    while True:
        fresh = next(_next_dyads(skeleton, bodies, known), None)
        if fresh is None:
            return tuple(found)
        found.append(fresh)
        known |= set(fresh.links)


def _driven(skeleton: Skeleton) -> Iterator[str]:
    """Links driven by an input: about a pin on ground, or along a line of ground."""
    fixed = set(skeleton.fixed)
    for part in skeleton.driven:
        if part.kind == "link" and part.pivot in fixed:
            yield part.name
        for guide in skeleton.guides:
            if part.kind == "slider" and guide.name == part.name and guide.link:
                yield guide.link


def _next_dyads(skeleton: Skeleton, bodies: dict[str, set[str]], known: set[str]) -> Iterator[Dyad]:
    held = set().union(*(bodies[name] for name in known))
    free = [bar for bar in skeleton.bars if bar.name not in known]
    for one, other in combinations(free, 2):
        for pin in sorted(set(one.points) & set(other.points) - held):
            yield from _pinned(one, other, pin, held)
            for link, block in ((one, other), (other, one)):
                yield from _sliding(skeleton.guides, link, block, pin, known, held)


def _pinned(one: Bar, other: Bar, pin: str, held: set[str]) -> Iterator[Dyad]:
    arms = [[p for p in bar.points if p in held] for bar in (one, other)]
    if len(arms[0]) == len(arms[1]) == 1 and arms[0] != arms[1]:
        yield Dyad(pin=pin, links=(one.name, other.name), arms=(arms[0][0], arms[1][0]))


def _sliding(
    guides: Sequence[Guide], link: Bar, block: Bar, pin: str, known: set[str], held: set[str]
) -> Iterator[Dyad]:
    """A link and the block it moves along a line of a known body."""
    arms = [p for p in link.points if p in held]
    mine = [g for g in guides if g.link == block.name and g.block and g.on in known]
    if len(arms) == 1 and mine and not set(block.points) & held:
        yield Dyad(pin=pin, links=(link.name, block.name), arms=(arms[0], ""), guide=mine[0])
