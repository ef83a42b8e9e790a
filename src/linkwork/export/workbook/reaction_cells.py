"""The reactions of a linkage as acts on its links: pins, parts, and the efforts of the inputs."""

from __future__ import annotations

from dataclasses import dataclass, field

from linkwork.export.workbook.acting import (
    NO,
    ONE,
    Act,
    Entry,
    Follower,
    Reading,
    Unknown,
    computed,
    minus,
)
from linkwork.export.workbook.contact_cells import strand
from linkwork.forces.drives import effort_name
from linkwork.foundation.names import GROUND
from linkwork.mechanism.driven_input import Input
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.belt import Belt
from linkwork.mechanism.part.cylinder import Cylinder
from linkwork.mechanism.part.gear import Gear
from linkwork.mechanism.part.load import Load
from linkwork.mechanism.part.part import Part, carriers
from linkwork.mechanism.part.rack import Rack
from linkwork.mechanism.part.rolling import Rolling
from linkwork.mechanism.part.slider import Slider
from linkwork.mechanism.part.slot import Slot
from linkwork.mechanism.part.spring import Spring
from linkwork.mechanism.part.weld import Weld
from linkwork.motion.model import Model
from linkwork.results.quantity import Kind

__all__ = ["HAVE_CELLS", "Reactions"]

#: The parts whose reactions have cells.
HAVE_CELLS = (Belt, Cylinder, Gear, Load, Rack, Rolling, Slider, Slot, Spring, Weld)


@dataclass
class Reactions:
    """All reactions.

    ``along`` has the unit vectors of lines by part, ``way`` those of contacts, whose places are
    points of the sheet; ``cells`` the cells of the sheet of loads by key.
    """

    model: Model
    linkage: Linkage
    along: dict[str, tuple[Entry, Entry]]
    way: dict[str, tuple[Entry, Entry]]
    cells: dict[str, Entry]
    unknowns: list[Unknown] = field(default_factory=list)
    followers: list[Follower] = field(default_factory=list)
    readings: list[Reading] = field(default_factory=list)

    def __post_init__(self) -> None:
        units = self.model.units
        self.force, self.moment = units.of(Kind.FORCE), units.of(Kind.MOMENT)
        self.carriers = carriers(self.linkage)
        self.joined = {
            point: [name for name in names if name in self.linkage.links]
            for point, names in self.carriers.items()
        }
        for point in self.joined:
            self._pin(point)
        for part in self.linkage.parts:
            self._part(part)
        for which in self.linkage.inputs:
            self._effort(which)

    def _pin(self, point: str) -> None:
        # loads on a pin act on its first link, so that this one needs no unknown of its own
        links = self.joined[point]
        for other in links[1:]:
            stem = self._stem(point, "force", other)
            for axis, x, y in (("x", ONE, NO), ("y", NO, ONE)):
                self._pair(f"{stem}.{axis}", other, links[0], point, (x, y))

    def _stem(self, point: str, what: str, link: str) -> str:
        """The name of a reaction on a link at a point that others may share."""
        return f"{point}.{what}" if len(self.carriers[point]) < 3 else f"{point}.{what}.{link}"

    def _part(self, part: Part) -> None:
        match part:
            case Slider():
                along = self.along[part.name]
                name, pair = f"{part.name}.normal", (part.link, part.on)
                self._pair(name, *pair, part.points[0], _left(along))
                self._couple(f"{part.name}.moment", *pair)
            case Slot():
                own = self.joined[part.point][0]
                across = _left(self.along[part.name])
                self._pair(f"{part.name}.normal", own, part.on, part.point, across)
            case Weld():
                earlier, later = sorted(part.links, key=list(self.linkage.links).index)
                at = next(p for p in self.linkage.links[earlier] if p in self.linkage.links[later])
                stem = at if len(self.joined[at]) == 2 else f"{at}.{later}"
                self._couple(f"{stem}.moment", later, earlier)
            case Gear():
                self._teeth(part.name, part.wheels)
            case Rack():
                slider = part.guide(self.linkage)
                assert slider is not None
                self._teeth(part.name, (part.pinion, slider.link))
            case Rolling():
                self._rolling(part)
            case Belt():
                self._belt(part)
            case _:  # a cylinder transmits no force unless it is driven
                pass

    def _teeth(self, name: str, links: tuple[str, str]) -> None:
        """The force at the pitch point across the line of centres, and along it."""
        first, second = links
        way, tangent = self.way[name], f"{name}.tangent"
        self._pair(tangent, second, first, name, _left(way))
        acts = _opposite(second, first, name, way)
        pressure = {"p": self.cells[f"{name} pressure"]}
        # eq. (74) with round wheels
        self.followers.append(
            Follower(f"{name}.radial", self.force, tangent, "tan(p)*abs(t)", pressure, acts)
        )

    def _rolling(self, rolling: Rolling) -> None:
        away, name = self.way[rolling.name], rolling.name
        self._pair(f"{name}.normal", rolling.wheel, rolling.on, name, away)
        grip = _left(away)
        if rolling.inside or (rolling.line is not None and self._on_left(rolling)):
            grip = minus(grip[0]), minus(grip[1])
        self._pair(f"{name}.tangent", rolling.wheel, rolling.on, name, grip)

    def _on_left(self, rolling: Rolling) -> bool:
        assert rolling.line is not None
        start, end, place = map(self.linkage.sketched, (*rolling.line, rolling.center))
        return bool(((place - start) * (end - start).conjugate()).imag >= 0.0)

    def _belt(self, belt: Belt) -> None:
        """Half of the pull in the left strand and against it in the right one; both tensions."""
        halves, whole = [], []
        for side, half in ((1, "0.5*w"), (-1, "-0.5*w")):
            for wheel, link in enumerate(belt.wheels):
                point = strand(belt, side, wheel)
                x, y = self.way[point]
                halves.append(Act(link, point, computed(half, {"w": x}), computed(half, {"w": y})))
                whole.append(Act(link, point, x, y))
        pull, both = f"{belt.name}.pull", f"{belt.name}.mean"
        self.unknowns.append(Unknown(pull, self.force, tuple(halves)))
        size, names = "0.5*abs(t)", {}
        if belt.pretension is not None:
            size, names = "p", {"p": self.cells[f"{belt.name} pretension"]}
        self.followers.append(Follower(both, self.force, pull, size, names, tuple(whole)))
        for number, text in ((1, "b+0.5*a"), (2, "b-0.5*a")):
            name = f"{belt.name}.tension{number}"
            self.readings.append(Reading(name, self.force, text, (pull, both)))

    def _effort(self, which: Input) -> None:
        kind, name = which.drives
        column = which.column
        effort = effort_name(column)
        if kind in ("slider", "cylinder"):
            part = next(own for own in self.linkage.parts if own.drive and own.label == name)
            along = self.along[name]
            match part:
                case Slider():
                    self._pair(effort, part.link, part.on, part.points[0], along)
                case Cylinder():
                    self._cylinder(part, effort, along)
                case Rolling(center=point) | Slot(point=point):
                    self._pair(effort, self.joined[point][0], part.on, point, along)
            return
        on, against = name, which.relative_to or GROUND
        if kind == "joint":
            # as the equations drive it: the later link, or the one that is not ground
            against, on = self.linkage.bodies_at(name)
            if on == GROUND:
                on, against = against, on
        self._couple(effort, on, against)

    def _cylinder(self, cylinder: Cylinder, effort: str, along: tuple[Entry, Entry]) -> None:
        """The force that pushes the ends of a driven cylinder apart, and what its pins exert."""
        start, end = cylinder.between
        acts = (
            Act(self.joined[end][0], end, *along),
            Act(self.joined[start][0], start, minus(along[0]), minus(along[1])),
        )
        self.unknowns.append(Unknown(effort, self.force, acts))
        for point, sign in ((start, ""), (end, "-")):
            names = self.carriers[point]
            # the force on the link named later is read: on the other one it is the opposite
            if len(names) == 2 and names[-1] != cylinder.name:
                continue
            stem = self._stem(point, "force", cylinder.name)
            for axis, own in zip("xy", along, strict=True):
                text = f"{sign}a*w"
                self.readings.append(
                    Reading(f"{stem}.{axis}", self.force, text, (effort,), {"w": own})
                )

    def _pair(
        self, name: str, on: str, against: str, point: str, along: tuple[Entry, Entry]
    ) -> None:
        acts = _opposite(on, against, point, along)
        self.unknowns.append(Unknown(name, self.force, acts))

    def _couple(self, name: str, on: str, against: str) -> None:
        acts = Act(on, "", moment=ONE), Act(against, "", moment=minus(ONE))
        self.unknowns.append(Unknown(name, self.moment, acts))


def _left(along: tuple[Entry, Entry]) -> tuple[Entry, Entry]:
    """A unit vector turned by a right angle."""
    return minus(along[1]), along[0]


def _opposite(on: str, against: str, point: str, along: tuple[Entry, Entry]) -> tuple[Act, ...]:
    x, y = along
    return Act(on, point, x, y), Act(against, point, minus(x), minus(y))
