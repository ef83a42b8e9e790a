"""What a mechanism looks like, without numbers: which points to join, hatch, slide and trace."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from linkwork.mechanism.contact_checks import guide_named
from linkwork.mechanism.contacts import Belt, Gear
from linkwork.mechanism.linkage import GROUND, Linkage
from linkwork.mechanism.parts import Slider

__all__ = ["Bar", "BeltRun", "Contour", "Disc", "DrivenPart", "Guide", "Skeleton", "Strut"]


@dataclass(frozen=True, kw_only=True)
class Bar:
    """A rigid link and the points it carries; three or more make a filled polygon."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Guide:
    """A slider or slot: ``point`` runs along the line through two points of the body ``on``.

    ``offset`` is the distance of ``point`` to the left of the line. ``block`` tells a sliding
    block (prismatic joint) from a pin in a slot.
    """

    name: str
    point: str
    on: str
    line: tuple[str, str]
    offset: float = 0.0
    block: bool = False


@dataclass(frozen=True, kw_only=True)
class Strut:
    """A cylinder: a link of variable length between two points."""

    name: str
    between: tuple[str, str]


@dataclass(frozen=True, kw_only=True)
class Disc:
    """A round part of a link about one of its points.

    ``kind`` is gear, pulley, wheel or roller; a ``ring`` has what it touches inside. ``teeth`` is
    their number, if it is known.
    """

    name: str
    link: str
    center: str
    radius: float
    kind: str
    ring: bool = False
    teeth: int | None = None


@dataclass(frozen=True, kw_only=True)
class BeltRun:
    """A belt or chain around two pulleys, given by their centres and radii."""

    name: str
    centers: tuple[str, str]
    radii: tuple[float, float]
    crossed: bool = False


@dataclass(frozen=True, kw_only=True)
class Contour:
    """A cam's outline or a curve of a link: points about its ``center`` in the link's frame."""

    name: str
    link: str
    center: str
    points: tuple[complex, ...]
    closed: bool = True


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
    struts: tuple[Strut, ...] = ()
    driven: tuple[DrivenPart, ...] = ()
    traced: tuple[str, ...] = ()
    discs: tuple[Disc, ...] = ()
    belts: tuple[BeltRun, ...] = ()
    contours: tuple[Contour, ...] = ()

    @classmethod
    def of_linkage(
        cls, linkage: Linkage, outlines: Mapping[str, tuple[str, str, Iterable[complex]]]
    ) -> Skeleton:
        """The skeleton of a points-and-links mechanism.

        ``outlines``: body, centre and points of every cam and curve by name.
        """
        open_ = {curve.name for curve in linkage.curves if not curve.closed}
        carriers = linkage.carriers()
        guided = {slot.point for slot in linkage.slots}
        return cls(
            fixed=linkage.links[GROUND],
            bars=tuple(
                Bar(name=name, points=points)
                for name, points in linkage.links.items()
                if name != GROUND
            ),
            pins=tuple(p for p, links in carriers.items() if len(links) > 1 or p in guided),
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
                    )
                    for s in linkage.sliders
                    for point in s.points
                ]
            ),
            struts=tuple(Strut(name=c.name, between=c.between) for c in linkage.cylinders),
            driven=tuple(_driven_parts(linkage, carriers)),
            traced=linkage.trace,
            discs=tuple(_discs(linkage)),
            belts=tuple(
                BeltRun(
                    name=belt.name,
                    centers=belt.centers,
                    radii=_pitch_radii(linkage, belt),
                    crossed=belt.crossed,
                )
                for belt in linkage.belts
            ),
            contours=tuple(
                Contour(
                    name=name,
                    link=link,
                    center=center,
                    points=tuple(map(complex, points)),
                    closed=name not in open_,
                )
                for name, (link, center, points) in outlines.items()
            ),
        )

    @classmethod
    def of_points(
        cls,
        links: Mapping[str, tuple[str, ...]],
        fixed: tuple[str, ...],
        traced: tuple[str, ...],
        driven: tuple[DrivenPart, ...],
    ) -> Skeleton:
        """The skeleton of a mechanism given by equations: its drawable points and links."""
        bars = tuple(
            Bar(name=name, points=points) for name, points in links.items() if name != GROUND
        )
        joined = [p for points in links.values() for p in points]
        pins = tuple(p for p in dict.fromkeys(joined) if joined.count(p) + (p in fixed) > 1)
        return cls(fixed=fixed, bars=bars, pins=pins, driven=driven, traced=traced)


def _pitch_radii(linkage: Linkage, pair: Gear | Belt) -> tuple[float, float]:
    """Given, or from the teeth so that gears meet and pulleys fill half of the distance."""
    numbers = linkage.numbers
    if pair.radii is not None:
        return numbers(pair.radii[0]), numbers(pair.radii[1])
    assert pair.teeth is not None
    first, second = map(numbers, pair.teeth)
    a, b = (linkage.shapes.local[pair.arm][center] for center in pair.centers)
    if isinstance(pair, Gear):
        module = abs(b - a) / (abs(first - second) if pair.internal else first + second)
    else:
        module = abs(b - a) / (2.0 * (first + second))
    return module * first, module * second


def _discs(linkage: Linkage) -> Iterator[Disc]:
    """Wheels and rollers, each once."""
    numbers = linkage.numbers
    found: dict[tuple[str, str, float], Disc] = {}
    pairs: list[Gear | Belt] = [*linkage.gears, *linkage.belts]
    for pair in pairs:
        radii = _pitch_radii(linkage, pair)
        internal = isinstance(pair, Gear) and pair.internal
        teeth = (None, None) if pair.teeth is None else tuple(int(numbers(z)) for z in pair.teeth)
        for link, center, radius, count in zip(
            pair.wheels, pair.centers, radii, teeth, strict=True
        ):
            disc = Disc(
                name=pair.name,
                link=link,
                center=center,
                radius=radius,
                kind="gear" if isinstance(pair, Gear) else "pulley",
                ring=internal and radius == max(radii),
                teeth=count,
            )
            found.setdefault((link, center, radius), disc)
    for rack in linkage.racks:
        size = numbers(rack.radius)
        disc = Disc(name=rack.name, link=rack.pinion, center=rack.center, radius=size, kind="gear")
        found.setdefault((rack.pinion, rack.center, size), disc)
    for part in linkage.rolling:
        small = numbers(part.radius)
        found[part.wheel, part.center, small] = Disc(
            name=part.name, link=part.wheel, center=part.center, radius=small, kind="wheel",
            ring=part.inside and small > numbers(part.circle_radius or 0),
        )  # fmt: skip
        if part.circle is not None:
            large = numbers(part.circle_radius or 0)
            found[part.on, part.circle, large] = Disc(
                name=part.name, link=part.on, center=part.circle, radius=large, kind="wheel",
                ring=part.inside and large > small,
            )  # fmt: skip
    yield from found.values()
    for cam in linkage.cams:
        if cam.contact == "roller":
            guide = guide_named(linkage, cam.slider)
            point = cam.point
            if guide is not None:
                point = guide.points[0] if isinstance(guide, Slider) else guide.point
            assert point is not None
            link = cam.link or next(
                guide.link if isinstance(guide, Slider) else body
                for body in linkage.carriers()[point]
            )
            yield Disc(
                name=cam.name, link=link, center=point, radius=numbers(cam.radius), kind="roller"
            )


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
