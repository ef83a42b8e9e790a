"""Inversion: another link of the same chain becomes the ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from linkwork.foundation.elementwise import phase
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.names import GROUND, as_name, canonical, free_name
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.directed import named_in
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.inverted_values import Frame, inverted_input, inverted_output
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.cylinder import Cylinder
from linkwork.mechanism.part.index import PARTS
from linkwork.mechanism.part.part import Inversion, Part
from linkwork.mechanism.part.slider import Slider

__all__ = ["inverted", "settled"]

#: Fields that inversion supports; others might refer to the old ground.
_CARRIED = frozenset(
    {
        "points",
        "links",
        "lengths",
        "angles",
        "clearances",
        "inputs",
        "outputs",
        "trace",
        "dimensions",
        *PARTS,
    }
)

Places = Mapping[str, complex]
Coordinates = tuple[Number, ...]


def settled(linkage: Linkage, places: Places) -> Linkage:
    """The linkage with an assembled position as its sketch; measured lengths do not change.

    Parameters
    ----------
    places : Mapping[str, complex]
        All points of one position, in the linkage's length unit.
    """
    ground = linkage.links[GROUND]
    moved = {
        # coordinates of ground points may be formulas: they are kept as given
        name: given if name in ground else (places[name].real, places[name].imag)
        for name, given in linkage.points.items()
    }
    lengths = {**linkage.lengths, **_measured(linkage)}
    return replace(linkage, points=moved, lengths=lengths, configuration="")


def inverted(linkage: Linkage, link: str, places: Places, which: Input | None = None) -> Linkage:
    """The linkage with another link as ground; the old ground becomes the link ``frame``.

    The new ground's first point is the origin, its second lies on the positive x axis. Wheels and a
    ground of one point need a second point for their direction: see :func:`directed`. Every input
    drives the same relative angle, or the same length, as before, unless ``which`` is given.
    Outputs keep their values: they are rewritten relative to the old ground. Masses, loads, gravity
    and tolerances are left out: they belong to the machine with the old ground.

    Parameters
    ----------
    places : Mapping[str, complex]
        All points of one assembled position; they become the sketch.

    Raises
    ------
    UnknownNameError
        If there is no such link.
    InputError
        If the inversion cannot be written with points and links.
    """
    if as_name(link) not in linkage.links:
        cylinder = any(link == c.name for c in linkage.of(Cylinder))
        if cylinder:
            raise InputError(
                f'"{link}" is a cylinder, whose length varies: it cannot be ground. Write it as '
                "two links with a slider"
            )
        known = choices("links", linkage.links, link)
        raise UnknownNameError(f'"{link}" is not a link of {linkage.name} {known}')
    if link == GROUND:
        return linkage if which is None else replace(linkage, inputs=(which,))
    none: FrozenDict[str, Any] = FrozenDict()
    linkage = replace(linkage, masses=none, friction=none, gravity=None, loads=(), tolerances=none)
    _check_carried(linkage)
    return _Inverting(linkage, link, places).done(which)


def _check_carried(linkage: Linkage) -> None:
    held = [
        entry.name
        for entry in fields(linkage)
        if isinstance(getattr(linkage, entry.name), tuple | Mapping)
        and getattr(linkage, entry.name)
        and entry.name not in _CARRIED
    ]
    if held:
        raise InputError(
            f"an inversion of {linkage.name} cannot move [{held[0]}] to another ground: "
            "remove it, or write the inversion by hand"
        )


@dataclass
class _Inverting:
    """The construction of one inversion."""

    linkage: Linkage
    link: str
    places: Places

    def __post_init__(self) -> None:
        linkage = self.linkage
        self.taken = set(map(canonical, named_in(linkage)))
        self.frame = free_name("frame", self.taken)
        own = linkage.shapes.local[self.link]
        self.first = linkage.links[self.link][0]
        axis = self._axis()
        # a rotation by the unit vector of the axis: lengths keep their digits
        self.seen = {
            name: (z - self.places[self.first]) / axis for name, z in self.places.items()
        } | dict(own)
        self.fixed = list(linkage.links[self.link])
        fixed, (origin, second) = linkage.shapes.local[GROUND], linkage.links[GROUND][:2]
        # angles on the frame are measured from its first two points, on ground from the x axis
        self.turn = phase(fixed[second] - fixed[origin])

    def _axis(self) -> complex:
        """The direction of the new ground's x axis in the old one's coordinates."""
        points = self.linkage.links[self.link]
        if len(points) > 1:
            along = self.places[points[1]] - self.places[points[0]]
        else:  # a one-point block slides along a line
            slider = next(s for s in self.linkage.of(Slider) if s.link == self.link)
            along = self.places[slider.line[1]] - self.places[slider.line[0]]
        return along / abs(along)

    def done(self, which: Input | None) -> Linkage:
        """The inverted linkage."""
        linkage = self.linkage
        frame = self._seen_frame()
        inversion = Inversion(
            linkage=linkage, link=self.link, frame=self.frame, ground=GROUND, turn=self.turn,
            seen=self.seen, fixed=self.fixed, taken=self.taken,
        )  # fmt: skip
        parts: dict[str, tuple[Part, ...]] = {
            table: tuple(part.inverted(inversion) for part in getattr(linkage, table))
            for table in PARTS
        }
        links = {GROUND: tuple(self.fixed)} | {
            inversion.name(name): points
            for name, points in linkage.links.items()
            if name != self.link
        }
        inputs = tuple(
            inverted_input(linkage, given, frame, self.places) for given in linkage.inputs
        )
        changes: dict[str, Any] = {
            "name": f"{linkage.name}, {self.link} fixed",
            "points": self._points(),
            "links": links,
            "lengths": self._lengths(),
            "angles": self._angles(),
            **parts,
            "inputs": inputs if which is None else (which,),
            "outputs": {
                name: inverted_output(linkage, formula, frame)
                for name, formula in linkage.outputs.items()
            },
            # points of the new ground are fixed and have no path
            "trace": tuple(point for point in linkage.trace if point not in self.fixed),
            # the sketch is an assembled position: it selects the configuration
            "configuration": "",
        }
        return replace(linkage, **changes)

    def _seen_frame(self) -> Frame:
        origin = self.linkage.links[GROUND][0]
        return Frame(
            ground=self.link,
            name=self.frame,
            origin=origin,
            place=self.linkage.shapes.local[GROUND][origin],
            turn=self.turn,
        )

    def _points(self) -> dict[str, Coordinates]:
        """The new ground exactly, with its length as in the file; other points as a sketch."""
        found: dict[str, Coordinates] = {name: (z.real, z.imag) for name, z in self.seen.items()}
        own = self.linkage.links[self.link]
        if len(own) == 2:
            given = self.linkage.lengths
            # a key may name the two points in either order
            length = given.get(" ".join(own), given.get(" ".join(own[::-1])))
            if length is not None:
                found[own[1]] = (length, 0.0)
        return found

    def _lengths(self) -> dict[str, Number]:
        """Given lengths, measured lengths, and those of the old ground from its coordinates."""
        linkage = self.linkage
        first, *others = ground = linkage.links[GROUND]
        found = {
            key: number
            for key, number in linkage.lengths.items()
            if not set(key.split()).issubset(ground)
        }
        found |= _measured(linkage)
        for point in others:
            length = _distance(linkage, first, point)
            for key in (f"{first} {point}", f"{point} {first}"):
                given = linkage.lengths.get(key)
                # a formula keeps the dependence on dimensions; a number would duplicate the
                # coordinates
                if isinstance(given, str) and _same(linkage, given, length):
                    length = given
            found[f"{first} {point}"] = length
        return found

    def _angles(self) -> dict[str, Number]:
        """Given angles, and those of further points of the old ground from its first two."""
        linkage = self.linkage
        first, second, *others = ground = linkage.links[GROUND]
        found = {
            key: number
            for key, number in linkage.angles.items()
            if not set(key.split()).issubset(ground)
        }
        for point in others:
            found[f"{second} {first} {point}"] = _angle(linkage, second, first, point)
        return found


def _same(linkage: Linkage, given: Number, exact: Number) -> bool:
    """Whether two lengths agree to rounding; given lengths need only agree to 1e-9."""
    length = linkage.numbers(exact)
    return abs(linkage.numbers(given) - length) <= 4e-16 * length


def _measured(linkage: Linkage) -> dict[str, Number]:
    """Lengths measured between sketched points, by key."""
    return {
        " ".join(entry.points): _distance(linkage, *entry.points, measured=entry.length)
        for entry in linkage.shapes.measured
    }


def _texts(linkage: Linkage, *points: str) -> Iterator[tuple[str, str]]:
    """Coordinates as formulas."""
    for point in points:
        x, y = (
            f"({number})" if isinstance(number, str) else f"({float(number)!r})"
            for number in linkage.points[point]
        )
        yield x, y


def _formulas(linkage: Linkage, *points: str) -> bool:
    return any(isinstance(number, str) for point in points for number in linkage.points[point])


def _distance(linkage: Linkage, a: str, b: str, *, measured: float | None = None) -> Number:
    """The distance of two points; a formula if their coordinates are formulas."""
    drawn = abs(linkage.sketched(b) - linkage.sketched(a))
    # a shape that is only nearest to its sketch has other distances
    as_drawn = measured is None or abs(measured - drawn) <= 4e-16 * drawn
    if as_drawn and _formulas(linkage, a, b):
        (ax, ay), (bx, by) = _texts(linkage, a, b)
        return f"hypot({bx} - {ax}, {by} - {ay})"
    return drawn if measured is None else measured


def _angle(linkage: Linkage, a: str, vertex: str, b: str) -> Number:
    """The angle from the ray to ``a`` to the ray to ``b``, in the file's unit or as a formula."""
    if _formulas(linkage, a, vertex, b):
        (ax, ay), (vx, vy), (bx, by) = _texts(linkage, a, vertex, b)
        return f"atan2({by} - {vy}, {bx} - {vx}) - atan2({ay} - {vy}, {ax} - {vx})"
    start, end = (linkage.sketched(point) - linkage.sketched(vertex) for point in (a, b))
    return linkage.angle.from_radians(phase(end * start.conjugate()))
