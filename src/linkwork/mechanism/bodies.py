"""Points, rigid links and the shapes of links."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from linkwork.foundation.elementwise import estimated, phase, plain_value, sqrt, vector
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.names import GROUND
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.loaded import LoadedBodies

__all__ = ["Bodies", "Measured", "Shapes"]


P = TypeVar("P")


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


@dataclass(frozen=True, kw_only=True)
class Bodies(LoadedBodies):
    """The rigid links of a mechanism; parts join them.

    Fields as of :class:`~linkwork.mechanism.linkage.Linkage`.
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

    def side_of(self, line: tuple[str, str], point: str) -> float:
        """The side of a line on which a point is sketched: 1 for left, -1 for right."""
        start, end, place = map(self.sketched, (*line, point))
        return math.copysign(1.0, plain_value(((place - start) * (end - start).conjugate()).imag))

    def bodies_at(self, point: str) -> Iterator[str]:
        """The links that carry a point, in the file's order."""
        for link, points in self.links.items():
            if point in points:
                yield link

    def sketched_angle(self, link: str) -> float:
        """The angle of a link in the sketch [rad]; 0 for ground and wheels of one point."""
        return 0.0 if link == GROUND else phase(self.sketched_span(link))

    def sketched_span(self, link: str, *, of_start: bool = False) -> complex:
        """A vector in the direction of a link in the sketch, longer for larger links.

        A link of more than two points is turned so that its points are nearest to the sketched
        ones, whichever of them is the first. 1 for a wheel of one point. ``of_start``: for
        estimates, without formulas.
        """
        points = self.links[link]
        sketched = [self.sketched(point) for point in points]
        local = self.shapes.local.get(link)
        if len(points) == 1:
            return 1.0 + 0j
        if len(points) == 2 or local is None:
            return sketched[1] - sketched[0]
        exact = [estimated(local[point]) if of_start else local[point] for point in points]
        middle, center = (sum(places) / len(points) for places in (sketched, exact))
        size = sqrt(2.0 * sum(abs(place - center) ** 2 for place in exact))
        pairs = zip(sketched, exact, strict=True)
        total = sum(((z - middle) * (place - center).conjugate() for z, place in pairs), 0j)
        return total / size
