"""A linkage with another link as ground."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import names_in
from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import GROUND, as_name, canonical, free_name
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.guides import Cylinder, Slider
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.mechanism.part.part import Inversion, Part
from linkwork.core.mechanism.skeleton import named_in

# ----------------------------------------------------------------------
# Inputs and outputs of an inversion: the same quantities relative to another ground.


def inverted_input(
    linkage: Linkage, which: Input, inversion: Inversion, places: Mapping[str, complex]
) -> Input:
    """The input that drives the same relative angle or length.

    An angle relative to ground was measured from the x axis; now it is measured from the line of
    the old ground's first two points, so the table may begin at another number. If the new ground
    was driven, the other link is driven relative to it in the opposite sense. The table is shifted
    by whole turns, which count for wheels, to where the input is sketched: within half a turn.

    Parameters
    ----------
    places : Mapping[str, complex]
        All points of the assembled position that becomes the sketch.
    """
    kind, name = which.drives
    # a length between two links is the same from every ground
    if kind in ("slider", "cylinder"):
        return which
    link, against = name, which.relative_to or GROUND
    if kind == "joint":
        against, link = linkage.bodies_at(name)
        if link == GROUND:
            link, against = against, link
    if inversion.link in (link, against) and len(linkage.links[inversion.link]) < 2:
        raise InputError(
            f'the input turns relative to "{inversion.link}", which has one point and no '
            "direction: give input= for the inversion"
        )
    turn = linkage.angle.from_radians(inversion.turn) if against == GROUND else 0.0
    ways = [_direction(linkage, body, places) for body in (link, against)]
    seen = linkage.angle.from_radians(phase(ways[0] * ways[1].conjugate()))
    other = inversion.frame if against == GROUND else against
    speed = linkage.speed(which)
    if link == inversion.link:
        # relative to the driven link, the old ground turns in the opposite direction
        back = None if speed is None else -speed
        against_it = replace(which, link=other, joint=None, relative_to=None, speed=back)
        return _ranged(linkage, against_it, -1.0, turn, seen)
    same = replace(
        which,
        link=link,
        joint=None,
        relative_to=None if against == inversion.link else other,
    )
    return _ranged(linkage, same, 1.0, -turn, seen)


def _direction(linkage: Linkage, link: str, places: Mapping[str, complex]) -> complex:
    """A vector along a link in a position, along the x axis for ground."""
    points = linkage.links[link]
    straight = link == GROUND or len(points) < 2
    return 1.0 + 0j if straight else places[points[1]] - places[points[0]]


def _ranged(linkage: Linkage, which: Input, sign: float, shift: float, seen: float) -> Input:
    """The input with the table sign · value + shift; ``seen`` is a value that is sketched."""
    there = sign * seen + shift
    shift -= linkage.angle.turn * round(there / linkage.angle.turn)
    if sign > 0 and not shift:
        return which
    start: Number = 0.0 if which.from_ is None else which.from_
    stop: Number = linkage.angle.turn if which.to is None else which.to
    step = None if which.step is None else _shifted(which.step, sign, 0.0)
    return replace(
        which, from_=_shifted(start, sign, shift), to=_shifted(stop, sign, shift), step=step
    )


def _shifted(number: Number, sign: float, shift: float) -> Number:
    if isinstance(number, str):
        signed = f"-({number})" if sign < 0 else f"({number})"
        return f"{signed} + ({shift!r})" if shift else signed
    return sign * number + shift


def inverted_output(linkage: Linkage, formula: str, inversion: Inversion) -> str:
    """A formula of the same value: angles and coordinates relative to the old ground."""
    turn = linkage.angle.from_radians(inversion.turn)
    angles = {canonical(name): name for name in linkage.links if name != GROUND}
    angles |= {canonical(c.angle_name): c.angle_name for c in linkage.of(Cylinder)}
    text = formula
    # from the end of the text, so that the columns of earlier names stay valid
    for node in reversed(list(names_in(parse(formula)))):
        if node.name in angles:
            seen = "0" if angles[node.name] == inversion.link else angles[node.name]
            new = f"({seen} - {inversion.frame} + ({turn!r}))"
        elif node.name[-2:] in (".x", ".y"):
            new = _coordinate(linkage, node.spelling[:-2], node.name[-1], inversion)
        else:
            continue
        at = node.column - 1
        text = text[:at] + new + text[at + len(node.spelling) :]
    return text


def _coordinate(linkage: Linkage, point: str, axis: str, inversion: Inversion) -> str:
    """A coordinate in the old ground, rotated from the direction of the link that it becomes."""
    origin = linkage.links[GROUND][0]
    place = linkage.shapes.local[GROUND][origin]
    x, y = f"({point}.x - {origin}.x)", f"({point}.y - {origin}.y)"
    angle = f"({inversion.frame} - ({linkage.angle.from_radians(inversion.turn)!r}))"
    if axis == "x":
        return f"({place.real!r} + cos{angle}*{x} + sin{angle}*{y})"
    return f"({place.imag!r} + cos{angle}*{y} - sin{angle}*{x})"


# ----------------------------------------------------------------------
# Inversion: another link of the same chain becomes the ground.


#: Fields that inversion supports; others might refer to the old ground.
_CARRIED = {
    "points", "links", "lengths", "angles", "clearances", "inputs", "outputs", "trace",
    "dimensions", *PARTS,
}  # fmt: skip

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
        if any(link == c.name for c in linkage.of(Cylinder)):
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
        linkage, places = self.linkage, self.places
        taken = set(map(canonical, named_in(linkage)))
        first, axis = places[linkage.links[self.link][0]], self._axis()
        # a rotation by the unit vector of the axis: lengths keep their digits
        seen = {name: (z - first) / axis for name, z in places.items()}
        fixed, (origin, second) = linkage.shapes.local[GROUND], linkage.links[GROUND][:2]
        self.inversion = Inversion(
            linkage=linkage,
            link=self.link,
            frame=free_name("frame", taken),
            ground=GROUND,
            # angles on the frame are measured from its first two points, on ground from the x axis
            turn=phase(fixed[second] - fixed[origin]),
            seen=seen | dict(linkage.shapes.local[self.link]),
            fixed=list(linkage.links[self.link]),
            taken=taken,
        )

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
        linkage, inversion = self.linkage, self.inversion
        parts: dict[str, tuple[Part, ...]] = {
            table: tuple(part.inverted(inversion) for part in getattr(linkage, table))
            for table in PARTS
        }
        links = {GROUND: tuple(inversion.fixed)} | {
            inversion.name(name): points
            for name, points in linkage.links.items()
            if name != self.link
        }
        inputs = tuple(
            inverted_input(linkage, given, inversion, self.places) for given in linkage.inputs
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
                name: inverted_output(linkage, formula, inversion)
                for name, formula in linkage.outputs.items()
            },
            # points of the new ground are fixed and have no path
            "trace": tuple(point for point in linkage.trace if point not in inversion.fixed),
            # the sketch is an assembled position: it selects the configuration
            "configuration": "",
        }
        return replace(linkage, **changes)

    def _points(self) -> dict[str, Coordinates]:
        """The new ground exactly, with its length as in the file; other points as a sketch."""
        found: dict[str, Coordinates] = {
            name: (z.real, z.imag) for name, z in self.inversion.seen.items()
        }
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
