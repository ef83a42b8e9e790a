"""Inversion: another link of the same chain becomes the ground."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import canonical
from linkwork.mechanism.directed import free_name, named_in
from linkwork.mechanism.inverted_contacts import inverted_cam, inverted_curve
from linkwork.mechanism.inverted_values import Frame, inverted_input, inverted_output
from linkwork.mechanism.linkage import GROUND, PART_KINDS, Linkage
from linkwork.mechanism.parts import Input, Number, Slider

__all__ = ["inverted", "settled"]

#: What a linkage may hold and still be inverted; anything else might refer to the old ground.
_CARRIED = frozenset(
    {
        "points",
        "links",
        "lengths",
        "angles",
        "inputs",
        "outputs",
        "trace",
        "dimensions",
        *PART_KINDS,
    }
)

Places = Mapping[str, complex]
Coordinates = tuple[Number, ...]


def settled(linkage: Linkage, places: Places) -> Linkage:
    """The linkage with an assembled position as its sketch; measured lengths stay what they were.

    Parameters
    ----------
    places : Mapping[str, complex]
        All points of one position, in the linkage's length unit.
    """
    ground = linkage.links[GROUND]
    moved = {
        name: given if name in ground else (places[name].real, places[name].imag)
        for name, given in linkage.points.items()
    }
    lengths = {**linkage.lengths, **_measured(linkage)}
    return replace(linkage, points=moved, lengths=lengths, configuration="")


def inverted(linkage: Linkage, link: str, places: Places, which: Input | None = None) -> Linkage:
    """The linkage with another link as ground; the old ground becomes the link ``frame``.

    The new ground's first point is the origin, its second lies on the positive x axis. Wheels and
    a ground of one point need a second one for their direction: see :func:`directed`. Every
    input drives the same relative angle, or the same length, as before, unless ``which`` is given.
    Outputs keep their meaning: they are rewritten to be seen from the old ground.

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
    if link not in linkage.links:
        cylinder = any(link == c.name for c in linkage.cylinders)
        if cylinder:
            raise InputError(
                f'"{link}" is a cylinder, whose length varies: it cannot be ground. Write it as '
                "two links with a slider"
            )
        known = choices("links", linkage.links, link)
        raise UnknownNameError(f'"{link}" is not a link of {linkage.name} {known}')
    if link == GROUND:
        return linkage if which is None else replace(linkage, inputs=(which,))
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
    """One inversion while it is written."""

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
        self.seen = {
            name: (z - self.places[self.first]) / axis for name, z in self.places.items()
        } | dict(own)
        self.fixed = list(linkage.links[self.link])
        fixed, (origin, second) = linkage.shapes.local[GROUND], linkage.links[GROUND][:2]
        self.turn = cmath.phase(fixed[second] - fixed[origin])

    def _axis(self) -> complex:
        """The direction of the new ground's x axis in the old one's coordinates."""
        points = self.linkage.links[self.link]
        if len(points) > 1:
            along = self.places[points[1]] - self.places[points[0]]
        else:  # a block of one point slides along a line
            slider = next(s for s in self.linkage.sliders if s.link == self.link)
            along = self.places[slider.line[1]] - self.places[slider.line[0]]
        return along / abs(along)

    def done(self, which: Input | None) -> Linkage:
        """The inversion."""
        linkage = self.linkage
        frame = self._seen_frame()
        sliders = tuple(self._slider(slider) for slider in linkage.sliders)
        slots = tuple(replace(slot, on=self._name(slot.on)) for slot in linkage.slots)
        links = {GROUND: tuple(self.fixed)} | {
            self._name(name): points for name, points in linkage.links.items() if name != self.link
        }
        inputs = tuple(inverted_input(linkage, given, frame) for given in linkage.inputs)
        changes: dict[str, Any] = {
            "name": f"{linkage.name}, {self.link} fixed",
            "points": self._points(),
            "links": links,
            "lengths": self._lengths(),
            "angles": self._angles(),
            "slots": slots,
            "sliders": sliders,
            **self._contacts(),
            "inputs": inputs if which is None else (which,),
            "outputs": {
                name: inverted_output(linkage, formula, frame)
                for name, formula in linkage.outputs.items()
            },
            "trace": tuple(point for point in linkage.trace if point not in self.fixed),
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

    def _name(self, link: str) -> str:
        return {GROUND: self.frame, self.link: GROUND}.get(link, link)

    def _contacts(self) -> dict[str, tuple[object, ...]]:
        """Welds and wheels between the same links; angles between them as they are assembled."""
        linkage, name = self.linkage, self._name

        def both(links: tuple[str, str]) -> tuple[str, str]:
            return name(links[0]), name(links[1])

        return {
            "welds": tuple(replace(w, links=both(w.links), angle=None) for w in linkage.welds),
            "gears": tuple(
                replace(g, wheels=both(g.wheels), arm=name(g.arm), phase=None)
                for g in linkage.gears
            ),
            "belts": tuple(
                replace(b, wheels=both(b.wheels), arm=name(b.arm), phase=None)
                for b in linkage.belts
            ),
            "racks": tuple(replace(r, pinion=name(r.pinion)) for r in linkage.racks),
            "rolling": tuple(
                replace(r, wheel=name(r.wheel), on=name(r.on)) for r in linkage.rolling
            ),
            "cams": tuple(inverted_cam(linkage, c, name, self.turn) for c in linkage.cams),
            "curves": tuple(inverted_curve(c, name, self.turn) for c in linkage.curves),
        }

    def _slider(self, slider: Slider) -> Slider:
        """The slider; one of the new ground turns round, so that the other link slides on it.

        Its displacement stays the same: the new line runs the other way. The guide of a cam's
        follower or of a rack stays the guide.
        """
        linkage = self.linkage
        guides = {cam.slider for cam in linkage.cams} | {rack.slider for rack in linkage.racks}
        if slider.link != self.link or slider.name in guides:
            same = replace(slider, link=self._name(slider.link), on=self._name(slider.on))
            return replace(same, angle=self._angle_from_line(slider))
        start, end = (self.seen[point] for point in slider.line)
        along = (end - start) / abs(end - start)
        own = self.seen[slider.points[0]]
        foot = own - 1j * along * self.linkage.numbers(slider.offset)
        line = []
        for name, place in (("foot", foot), ("guide", foot - (end - start))):
            line.append(free_name(f"{slider.name}_{name}", self.taken))
            self.seen[line[-1]] = place
        if foot == own:  # then the block's own point is the foot
            del self.seen[line[0]]
            line[0] = slider.points[0]
        self.fixed += [point for point in line if point not in self.fixed]
        return Slider(
            name=slider.name,
            link=self._name(slider.on),
            points=slider.line,
            on=GROUND,
            line=(line[0], line[1]),
        )

    def _angle_from_line(self, slider: Slider) -> Number | None:
        """The angle of a slider of one point; ground's is counted from its x axis."""
        angle = slider.angle
        if angle is None or slider.link != GROUND or not self.turn:
            return angle
        turn = self.linkage.angle.from_radians(self.turn)
        return f"({angle}) + ({turn!r})" if isinstance(angle, str) else angle + turn

    def _points(self) -> dict[str, Coordinates]:
        """The new ground exactly, with its length as the file gives it; the rest as a sketch."""
        found: dict[str, Coordinates] = {name: (z.real, z.imag) for name, z in self.seen.items()}
        own = self.linkage.links[self.link]
        if len(own) == 2:
            given = self.linkage.lengths
            length = given.get(" ".join(own), given.get(" ".join(own[::-1])))
            if length is not None:
                found[own[1]] = (length, 0.0)
        return found

    def _lengths(self) -> dict[str, Number]:
        """All that were given, those measured, and the old ground's from its coordinates."""
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
                if isinstance(given, str) and _same(linkage, given, length):
                    length = given
            found[f"{first} {point}"] = length
        return found

    def _angles(self) -> dict[str, Number]:
        """Those given, and the old ground's further points against its first two."""
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
    """Whether two lengths differ by rounding only: given ones need to agree to 1e-9 only."""
    length = linkage.numbers(exact)
    return abs(linkage.numbers(given) - length) <= 4e-16 * length


def _measured(linkage: Linkage) -> dict[str, Number]:
    """Lengths that were measured between sketched points, by their key."""
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
    """The distance of two points; a formula where their coordinates are formulas."""
    if _formulas(linkage, a, b):
        (ax, ay), (bx, by) = _texts(linkage, a, b)
        return f"hypot({bx} - {ax}, {by} - {ay})"
    if measured is not None:
        return measured
    return abs(linkage.sketched(b) - linkage.sketched(a))


def _angle(linkage: Linkage, a: str, vertex: str, b: str) -> Number:
    """The angle from the ray to ``a`` to that to ``b``, in the file's unit, as a formula if so."""
    if _formulas(linkage, a, vertex, b):
        (ax, ay), (vx, vy), (bx, by) = _texts(linkage, a, vertex, b)
        return f"atan2({by} - {vy}, {bx} - {vx}) - atan2({ay} - {vy}, {ax} - {vx})"
    start, end = (linkage.sketched(point) - linkage.sketched(vertex) for point in (a, b))
    return linkage.angle.from_radians(cmath.phase(end * start.conjugate()))
