"""Points, rigid links and the shapes of links."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, TypeVar

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.lanes import choose, estimated, phase, plain_value, sqrt, vector
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.precise import (
    Precise,
    joined,
    phase as direction_of,
    precise,
    sqrt as root_of,
)
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.machine import LoadedBodies

P = TypeVar("P")
_HALF_TURN = -math.pi + 1e-12  # [rad]


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A dimension that was not given and was measured between sketched points."""

    link: str
    points: tuple[str, str]
    length: float


@dataclass(frozen=True)
class Shapes:
    """Local coordinates of every link's points; real axis from the first to the second point.

    ``local[link][point]`` is complex, in the mechanism's length unit; ground is in absolute
    coordinates.
    """

    local: Mapping[str, Mapping[str, complex]] = field(default_factory=dict)
    measured: tuple[Measured, ...] = ()
    #: What ``local`` loses where it is rounded to floats.
    rest: Mapping[str, Mapping[str, complex]] = field(default_factory=dict)

    def place(self, link: str, point: str) -> Precise:
        """The coordinates of a point in its link."""
        return Precise(self.local[link][point], self.rest[link][point])

    def direction(self, link: str, line: tuple[str, str]) -> Precise:
        """The unit vector from the first to the second point of a line."""
        span = self.place(link, line[1]) - self.place(link, line[0])
        return span / abs(span)


@dataclass(frozen=True, kw_only=True)
class Bodies(LoadedBodies):
    """The rigid links of a mechanism; parts join them.

    Fields as of :class:`~linkwork.core.mechanism.linkage.Linkage`.
    """

    points: Mapping[str, tuple[Number, ...]] = FrozenDict()
    links: Mapping[str, tuple[str, ...]] = FrozenDict()
    lengths: Mapping[str, Number] = FrozenDict()
    angles: Mapping[str, Number] = FrozenDict()
    sketch: bool = False
    clearances: Mapping[str, Number] = FrozenDict()
    #: The exact shape of every link in local coordinates, and the measured dimensions.
    shapes: Shapes = field(init=False, repr=False, compare=False)

    @property
    def carried(self) -> Mapping[str, tuple[str, ...]]:
        return self.links

    @property
    def placed(self) -> Iterable[str]:
        return self.points

    @property
    def parts(self) -> tuple[object, ...]:
        """Every part, in the order of the tables of a file."""
        return ()

    def of(self, kind: type[P]) -> tuple[P, ...]:
        """The parts of one kind."""
        return tuple(part for part in self.parts if isinstance(part, kind))

    def sketched(self, point: str) -> complex:
        """The point's coordinates in ``points`` as x + iy."""
        x, y = self.points[point]
        return vector(self.numbers(x), self.numbers(y))

    def precisely_sketched(self, point: str) -> Precise:
        """:meth:`sketched`, as exact as the formulas of coordinates."""
        x, y = map(self.numbers.precise, self.points[point])
        return joined(x, y)

    def side_of(self, line: tuple[str, str], point: str) -> float:
        """The side of a line on which a point is sketched: 1 for left, -1 for right."""
        start, end, place = map(self.sketched, (*line, point))
        return math.copysign(1.0, plain_value(((place - start) * (end - start).conjugate()).imag))

    def bodies_at(self, point: str) -> Iterator[str]:
        """The links that carry a point, in the file's order."""
        for link, points in self.links.items():
            if point in points:
                yield link

    def sketched_angle(self, link: str, *, of_start: bool = False) -> float:
        """The angle of a link in the sketch [rad]; 0 for ground and wheels of one point.

        ``of_start``: for estimates, without formulas.
        """
        if link == GROUND:
            return 0.0
        angle = phase(self.sketched_span(link, of_start=of_start))
        # half a turn is positive, whichever way it is rounded
        return choose(angle < _HALF_TURN, angle + math.tau, angle)

    def sketched_span(self, link: str, *, of_start: bool = False) -> complex:
        """A vector in the direction of a link in the sketch, longer for larger links.

        A link of more than two points is turned so that its points are nearest to the sketched
        ones, whichever of them is the first. 1 for a wheel of one point. ``of_start``: for
        estimates, without formulas.
        """
        sketched = [self.sketched(point) for point in self.links[link]]
        local = self.shapes.local.get(link)
        if of_start and local is not None:
            local = {point: estimated(place) for point, place in local.items()}
        span: complex = _span(sketched, local, sqrt)
        return span

    def exact_angle(self, link: str) -> Precise:
        """:meth:`sketched_angle`, as exact as the formulas of coordinates."""
        return Precise(0.0) if link == GROUND else direction_of(self.exact_span(link))

    def exact_span(self, link: str) -> Precise:
        """:meth:`sketched_span`, as exact as the formulas of coordinates."""
        sketched = [self.precisely_sketched(point) for point in self.links[link]]
        places = {point: self.shapes.place(link, point) for point in self.shapes.local[link]}
        return precise(_span(sketched, places, root_of))


def _span(
    sketched: Sequence[Any], local: Mapping[str, Any] | None, root: Callable[..., Any]
) -> Any:
    """The span of a link from its points in the sketch and in its frame."""
    if len(sketched) == 1:
        return 1.0 + 0j
    if len(sketched) == 2 or local is None:
        return sketched[1] - sketched[0]
    count = float(len(sketched))
    middle, center = (sum(places) / count for places in (sketched, local.values()))
    exact = [place - center for place in local.values()]
    size = root(2.0 * sum((place * place.conjugate()).real for place in exact))
    pairs = zip(sketched, exact, strict=True)
    return sum(((z - middle) * place.conjugate() for z, place in pairs), 0j) / size


# ----------------------------------------------------------------------
# Geometric figures of parts: discs, contours and guides.


_CORNERS = 72  # of a circle

#: Body, centre, and points relative to it in the body's frame [length].
Outline = tuple[str, str, Iterable[complex]]
#: Outlines by name.
Outlines = Mapping[str, Outline]


def circle(radius: float) -> list[complex]:
    """Corners of a circle about the origin [length]."""
    return [cmath.rect(radius, math.tau * k / _CORNERS) for k in range(_CORNERS)]


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure of a part.

    ``over``: drawn over the links, not under them; ``shown_again``: also drawn in further positions
    of a motion.
    """

    over: ClassVar[bool] = False
    shown_again: ClassVar[bool] = False

    name: str

    @property
    def pins(self) -> tuple[str, ...]:
        """Points always drawn as pins, regardless of the number of their links."""
        return ()

    @property
    def ends(self) -> tuple[str, ...]:
        """Points to which the figure is attached."""
        return ()

    @property
    def laid_by(self) -> tuple[str, ...]:
        """Ground points that only locate the figure."""
        return ()

    @property
    def turns_with(self) -> tuple[str, str] | None:
        """The two points whose line rotates with the figure."""
        return None


@dataclass(frozen=True, kw_only=True)
class DiscFigure(Figure):
    """A round part of a link about one of its points.

    ``kind`` is gear, pulley, wheel or roller; a ``ring`` surrounds its partner. ``teeth`` is the
    number of teeth, if known.
    """

    link: str
    center: str
    radius: float
    kind: str
    ring: bool = False
    teeth: int | None = None

    @property
    def pins(self) -> tuple[str, ...]:
        return (self.center,) if self.kind == "roller" else ()

    @property
    def key(self) -> tuple[str, str, str]:
        """A key equal for the same wheel in another mesh: radii from teeth are rounded."""
        return (self.link, self.center, f"{self.radius:.9g}")


@dataclass(frozen=True, kw_only=True)
class Mesh(Figure):
    """Two gears whose teeth are in mesh; one may be a ring."""

    discs: tuple[DiscFigure, DiscFigure]


@dataclass(frozen=True, kw_only=True)
class Contour(Figure):
    """An outline of a link: points about its ``center`` in the link's frame.

    ``filled`` marks a body; otherwise it is a line on a body.
    """

    shown_again: ClassVar[bool] = True
    filled: ClassVar[bool] = True

    link: str
    center: str
    points: tuple[complex, ...]
    closed: bool = True

    @property
    def laid_by(self) -> tuple[str, ...]:
        return (self.center,) if self.link == GROUND else ()


@dataclass(frozen=True, kw_only=True)
class Guide(Figure):
    """A slider or slot: ``point`` runs along the line through two points of the body ``on``.

    ``offset`` is the distance of ``point`` to the left of the line. ``block`` marks a sliding
    block (prismatic joint), otherwise a pin in a slot; ``link`` is the sliding link.
    """

    point: str
    on: str
    line: tuple[str, str]
    offset: float = 0.0
    block: bool = False
    link: str = ""

    @property
    def pins(self) -> tuple[str, ...]:
        return () if self.block else (self.point,)


class CamOutline(Contour):
    """The outline of a cam; the wing of contacts draws it."""

    wing: ClassVar[str] = "linkwork.contacts"


@dataclass(frozen=True, kw_only=True)
class Follower(Figure):
    """The follower of a cam: ``point`` is the knife edge, the roller's centre or on the face.

    It moves on a ``slider`` or swings about ``pivot``. ``center`` is that of the cam.
    """

    shown_again: ClassVar[bool] = True
    wing: ClassVar[str] = "linkwork.contacts"

    link: str
    point: str
    center: str
    contact: str
    slider: str | None = None
    pivot: str | None = None
