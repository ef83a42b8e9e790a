"""What parts in contact look like: wheels, meshes, belts, racks, cams and curves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from linkwork.mechanism.contacts import Belt, Cam, Gear, Rolling
from linkwork.mechanism.followers import guide_named
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.parts import Slider

__all__ = [
    "BeltRun",
    "ContactShapes",
    "Contour",
    "Disc",
    "Follower",
    "Mesh",
    "RackBar",
    "RollingLine",
]


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
class Mesh:
    """Two gears whose teeth are in mesh; one may be a ring."""

    name: str
    discs: tuple[Disc, Disc]


@dataclass(frozen=True, kw_only=True)
class BeltRun:
    """A belt or chain around two pulleys, given by their centres and radii."""

    name: str
    centers: tuple[str, str]
    radii: tuple[float, float]
    crossed: bool = False


@dataclass(frozen=True, kw_only=True)
class RackBar:
    """The rack that the slider of this name is, and the pinion that meshes with it."""

    name: str
    slider: str
    link: str
    center: str
    radius: float


@dataclass(frozen=True, kw_only=True)
class RollingLine:
    """The line through two points of the body ``on``, on which a wheel rolls."""

    name: str
    on: str
    line: tuple[str, str]
    center: str
    radius: float


@dataclass(frozen=True, kw_only=True)
class Follower:
    """What a cam moves: ``point`` of a link is the knife edge, the roller's centre or on the face.

    The follower moves on a ``slider`` or swings about ``pivot``. ``center`` is the cam's.
    """

    name: str
    link: str
    point: str
    center: str
    contact: str
    slider: str | None = None
    pivot: str | None = None


@dataclass(frozen=True, kw_only=True)
class Contour:
    """A cam's outline or a curve of a link: points about its ``center`` in the link's frame.

    A ``slot`` is a curve that the pin ``point`` runs along.
    """

    name: str
    link: str
    center: str
    points: tuple[complex, ...]
    closed: bool = True
    point: str = ""

    @property
    def slot(self) -> bool:
        return bool(self.point)


@dataclass(frozen=True, kw_only=True)
class ContactShapes:
    """All of them that a mechanism has."""

    discs: tuple[Disc, ...] = ()
    meshes: tuple[Mesh, ...] = ()
    belts: tuple[BeltRun, ...] = ()
    racks: tuple[RackBar, ...] = ()
    rolling: tuple[RollingLine, ...] = ()
    followers: tuple[Follower, ...] = ()
    contours: tuple[Contour, ...] = ()

    @classmethod
    def of(
        cls, linkage: Linkage, outlines: Mapping[str, tuple[str, str, Iterable[complex]]]
    ) -> ContactShapes:
        """Those of a points-and-links mechanism.

        ``outlines``: body, centre and points of every cam and curve by name.
        """
        numbers = linkage.numbers
        wheels = _Wheels()
        gears = [(gear.name, wheels.pair(linkage, gear)) for gear in linkage.gears]
        for belt in linkage.belts:
            wheels.pair(linkage, belt)
        for rack in linkage.racks:
            size = numbers(rack.radius)
            wheels.add(
                Disc(name=rack.name, link=rack.pinion, center=rack.center, radius=size, kind="gear")
            )
        for part in linkage.rolling:
            wheels.rolling(linkage, part)
        followers = tuple(_follower(linkage, cam) for cam in linkage.cams)
        for cam, follower in zip(linkage.cams, followers, strict=True):
            if cam.contact == "roller":
                wheels.add(
                    Disc(
                        name=cam.name,
                        link=follower.link,
                        center=follower.point,
                        radius=numbers(cam.radius),
                        kind="roller",
                    )
                )
        return cls(
            discs=tuple(wheels.found.values()),
            meshes=tuple(
                Mesh(name=name, discs=(wheels.found[first], wheels.found[second]))
                for name, (first, second) in gears
            ),
            belts=tuple(_belts(linkage)),
            racks=tuple(_racks(linkage)),
            rolling=tuple(_lines(linkage)),
            followers=followers,
            contours=tuple(_contours(linkage, outlines)),
        )


class _Wheels:
    """Wheels and rollers by link, centre and size, each once."""

    def __init__(self) -> None:
        self.found: dict[tuple[str, str, str], Disc] = {}

    def add(self, disc: Disc) -> tuple[str, str, str]:
        """Adds a wheel if it is new, or what is new of it; its key."""
        # Radii from numbers of teeth differ by rounding from mesh to mesh.
        key = (disc.link, disc.center, f"{disc.radius:.9g}")
        known = self.found.setdefault(key, disc)
        if known.teeth is None and disc.teeth is not None:
            self.found[key] = replace(known, teeth=disc.teeth)
        return key

    def pair(
        self, linkage: Linkage, pair: Gear | Belt
    ) -> tuple[tuple[str, str, str], tuple[str, str, str]]:
        """The two wheels of a gear or belt."""
        radii = _pitch_radii(linkage, pair)
        internal = isinstance(pair, Gear) and pair.internal
        teeth = (None, None) if pair.teeth is None else tuple(map(linkage.numbers, pair.teeth))
        first, second = (
            self.add(
                Disc(
                    name=pair.name,
                    link=link,
                    center=center,
                    radius=radius,
                    kind="gear" if isinstance(pair, Gear) else "pulley",
                    ring=internal and radius == max(radii),
                    teeth=None if count is None else int(count),
                )
            )
            for link, center, radius, count in zip(
                pair.wheels, pair.centers, radii, teeth, strict=True
            )
        )
        return first, second

    def rolling(self, linkage: Linkage, part: Rolling) -> None:
        """A rolling wheel, and the circle that it rolls on."""
        small = linkage.numbers(part.radius)
        large = linkage.numbers(part.circle_radius or 0)
        wheel = Disc(
            name=part.name, link=part.wheel, center=part.center, radius=small, kind="wheel",
            ring=part.inside and small > large,
        )  # fmt: skip
        self.add(wheel)
        if part.circle is not None:
            self.add(
                replace(
                    wheel,
                    link=part.on,
                    center=part.circle,
                    radius=large,
                    ring=part.inside and large > small,
                )
            )


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


def _slider(linkage: Linkage, name: str) -> Slider:
    guide = guide_named(linkage, name)
    assert isinstance(guide, Slider)
    return guide


def _belts(linkage: Linkage) -> Iterator[BeltRun]:
    for belt in linkage.belts:
        radii = _pitch_radii(linkage, belt)
        yield BeltRun(name=belt.name, centers=belt.centers, radii=radii, crossed=belt.crossed)


def _racks(linkage: Linkage) -> Iterator[RackBar]:
    for rack in linkage.racks:
        yield RackBar(
            name=rack.name,
            slider=rack.slider,
            link=_slider(linkage, rack.slider).link,
            center=rack.center,
            radius=linkage.numbers(rack.radius),
        )


def _lines(linkage: Linkage) -> Iterator[RollingLine]:
    for part in linkage.rolling:
        if part.line is not None:
            yield RollingLine(
                name=part.name,
                on=part.on,
                line=part.line,
                center=part.center,
                radius=linkage.numbers(part.radius),
            )


def _follower(linkage: Linkage, cam: Cam) -> Follower:
    guide = guide_named(linkage, cam.slider)
    point, link = cam.point, cam.link
    if isinstance(guide, Slider):
        point, link = guide.points[0], guide.link
    elif guide is not None:
        point = guide.point
        link = next(body for body in linkage.carriers()[point] if body != guide.on)
    assert point is not None
    assert link is not None
    return Follower(
        name=cam.name,
        link=link,
        point=point,
        center=cam.center,
        contact=cam.contact,
        slider=cam.slider,
        pivot=cam.pivot,
    )


def _contours(
    linkage: Linkage, outlines: Mapping[str, tuple[str, str, Iterable[complex]]]
) -> Iterator[Contour]:
    curves = {curve.name: curve for curve in linkage.curves}
    for name, (link, center, points) in outlines.items():
        curve = curves.get(name)
        yield Contour(
            name=name,
            link=link,
            center=center,
            points=tuple(map(complex, points)),
            closed=curve is None or curve.closed,
            point="" if curve is None else curve.point,
        )
