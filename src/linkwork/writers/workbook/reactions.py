"""What acts on links: forces at points and moments, as numbers that know their formulas of cells.

Such a number is a :class:`~linkwork.writers.formulas.traced.TracedNumber`, complex for a vector, or
a plain number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import singledispatch
from typing import Any

import numpy as np

from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.gears import Belt, Gear, Rack, ToothedPart
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot
from linkwork.core.mechanism.part.part import Part, carriers
from linkwork.core.mechanism.part.rolling import Rolling
from linkwork.core.mechanism.part.springs import Weld
from linkwork.core.motion.model import Model
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.drives import effort_name


@dataclass(frozen=True, kw_only=True)
class Contact:
    """Where a part pushes links in contact: a place and a unit vector."""

    name: str
    place: Any
    way: Any


@dataclass(frozen=True)
class Act:
    """What a unit of something, or a load, does to a link at a point."""

    link: str
    point: str
    force: Any = 0.0
    moment: Any = 0.0


def opposite(on: str, against: str, point: str, along: Any) -> tuple[Act, ...]:
    """A unit force on one link, and its reaction on another."""
    return Act(on, point, along), Act(against, point, -along)


@dataclass(frozen=True)
class Unknown:
    """A reaction: its name, unit and acts."""

    name: str
    unit: str
    acts: tuple[Act, ...]


@dataclass(frozen=True)
class Follower:
    """A force whose size is a function of one unknown, which it must not change."""

    name: str
    unit: str
    of: str
    size: Callable[[Any], Any]
    acts: tuple[Act, ...]


@dataclass(frozen=True)
class Reading:
    """A sum of reactions by name, with weights."""

    name: str
    unit: str
    weights: dict[str, Any]


# ----------------------------------------------------------------------
# The reactions of a linkage as acts on its links: pins, parts, and the efforts of the inputs.


@dataclass
class Reactions:
    """All reactions.

    ``along`` has the unit vectors of lines by part, ``way`` those of contacts, whose places are
    points of the sheet; ``number`` gives a number of the sheet of loads by key.
    """

    model: Model
    linkage: Linkage
    along: dict[str, Any]
    way: dict[str, Any]
    number: Callable[[str], Any]
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
        for point, links in self.joined.items():
            # loads on a pin act on its first link, so that this one needs no further unknown
            for other in links[1:]:
                stem = self.stem(point, "force", other)
                self.pair(f"{stem}.x", other, links[0], point, 1.0)
                self.pair(f"{stem}.y", other, links[0], point, 1j)

    def stem(self, point: str, what: str, link: str) -> str:
        """The name of a reaction on a link at a point that other links may share."""
        return f"{point}.{what}" if len(self.carriers[point]) < 3 else f"{point}.{what}.{link}"

    def pair(self, name: str, on: str, against: str, point: str, along: Any) -> None:
        """A force on one link at a point, and its reaction on another."""
        self.unknowns.append(Unknown(name, self.force, opposite(on, against, point, along)))

    def couple(self, name: str, on: str, against: str) -> None:
        """A moment on one link, and its reaction on another."""
        acts = Act(on, "", moment=1.0), Act(against, "", moment=-1.0)
        self.unknowns.append(Unknown(name, self.moment, acts))


# ----------------------------------------------------------------------
# Cells of the reactions of parts, by their kinds.


# ----------------------------------------------------------------------
# Cells of the reactions of parts, by their kinds.
#
# A part may also give the places where it pushes links in contact, and those numbers on which its
# forces alone depend: word, value, kind, description.


Numbers = Iterable[tuple[str, float, Kind, str]]
Places = Mapping[str, Any]


@singledispatch
def write_reactions(part: Part, reactions: Reactions) -> None:
    """Add the cells of a part's reactions; some parts have none."""


@singledispatch
def write_drive(part: Part, reactions: Reactions, effort: str) -> None:
    """Add the cells of the force along the displacement of a part that can be driven."""


@singledispatch
def part_contacts(part: Part, linkage: Linkage, at: Places) -> Iterable[Contact]:
    """Where a part pushes links in contact; ``at`` are the places of points."""
    return ()


@singledispatch
def part_numbers(part: Part, linkage: Linkage) -> Numbers:
    """The numbers on which the forces of a part alone depend."""
    return ()


def contacts_of(linkage: Linkage, at: Places) -> Iterator[Contact]:
    """Where the parts of a linkage push links in contact."""
    for part in linkage.parts:
        yield from part_contacts(part, linkage, at)


def offset_contact(
    name: str, place: Any, line: tuple[str, str], at: Places, side: float, reach: float
) -> Contact:
    """``reach`` to the left of a line from a place; the unit vector is to its ``side``."""
    along = at[line[1]] - at[line[0]]
    left = 1j * along / abs(along)
    return Contact(name=name, place=place + reach * left, way=side * left)


def numbers_of(linkage: Linkage) -> Iterator[tuple[str, str, float, Kind, str]]:
    """The name of a part, and a number on which its forces depend."""
    for part in linkage.parts:
        for number in part_numbers(part, linkage):
            yield (part.label, *number)


# ----------------------------------------------------------------------
# Teeth: a force across the line of centres, and one that pushes the wheels apart.


def mesh(name: str, links: tuple[str, str], reactions: Reactions) -> None:
    """The force of the first link's teeth on the second's, at the contact of this name."""
    first, second = links
    way, tangent = reactions.way[name], f"{name}.tangent"
    reactions.pair(tangent, second, first, name, 1j * way)
    pressure = reactions.number(f"{name} pressure") * reactions.linkage.angle.radians
    acts = opposite(second, first, name, way)

    def size(force: Any) -> Any:
        return pressure.apply(np.tan, pressure) * force.apply(np.fabs, force)  # eq. (74)

    radial = Follower(f"{name}.radial", reactions.force, tangent, size, acts)
    reactions.followers.append(radial)


@part_numbers.register(Gear)
@part_numbers.register(Rack)
def pressure(part: ToothedPart, linkage: Linkage) -> Iterator[tuple[str, float, Kind, str]]:
    """The pressure angle."""
    angle = part.pressure(linkage) / linkage.angle.radians
    yield "pressure", angle, Kind.ANGLE, f"pressure angle of {part.label}"


# ----------------------------------------------------------------------
# Belts: half of the pull in one strand and against it in the other, and the tension of both.


@part_numbers.register
def belt_numbers(belt: Belt, linkage: Linkage) -> Iterator[tuple[str, float, Kind, str]]:
    """The pretension, if it has one."""
    if belt.pretension is not None:
        about = f"tension of both strands of {belt.name} at rest"
        yield "pretension", linkage.numbers(belt.pretension), Kind.FORCE, about


@part_contacts.register
def belt_contacts(belt: Belt, linkage: Linkage, at: Places) -> Iterator[Contact]:
    """The tangent points of both strands; the unit vectors are their pull on the wheels."""
    first, second = belt.pitch_radii(linkage)
    if belt.crossed:  # the strands touch the second wheel on its other side
        second = -second
    start, end = (at[center] for center in belt.centers)
    span = abs(end - start)
    cosine = (first - second) / span
    sine = span.apply(np.sqrt, 1.0 - cosine * cosine)
    for side in (1, -1):
        # the direction from both centres to the tangent points
        out = (end - start) * (cosine + side * 1j * sine) / span
        for wheel, (center, radius) in enumerate(((start, first), (end, second))):
            way = side if wheel == 0 else -side
            yield Contact(
                name=_strand(belt, side, wheel),
                place=center + radius * out,
                way=-1j * way * out,  # normal to the radii
            )


def _strand(belt: Belt, side: int, wheel: int) -> str:
    return f"{belt.name} {'left' if side > 0 else 'right'} on {belt.wheels[wheel]}"


@write_reactions.register
def write_belt(belt: Belt, reactions: Reactions) -> None:
    """The pull, the mean tension, and the tensions of both strands."""
    halves, whole = [], []
    for side, half in ((1, 0.5), (-1, -0.5)):
        for wheel, link in enumerate(belt.wheels):
            point = _strand(belt, side, wheel)
            way = reactions.way[point]
            halves.append(Act(link, point, half * way))
            whole.append(Act(link, point, way))
    pull, mean, force = f"{belt.name}.pull", f"{belt.name}.mean", reactions.force
    reactions.unknowns.append(Unknown(pull, force, tuple(halves)))

    def size(pulled: Any) -> Any:
        if belt.pretension is not None:
            return reactions.number(f"{belt.name} pretension")
        return 0.5 * pulled.apply(np.fabs, pulled)  # the slack strand has no tension

    reactions.followers.append(Follower(mean, force, pull, size, tuple(whole)))
    for number, share in ((1, 0.5), (2, -0.5)):
        tension = Reading(f"{belt.name}.tension{number}", force, {mean: 1.0, pull: share})
        reactions.readings.append(tension)


# ----------------------------------------------------------------------
# Cylinders push along their axis; those that are not driven transmit no force.


@write_drive.register
def drive_cylinder(cylinder: Cylinder, reactions: Reactions, effort: str) -> None:
    """The force that pushes the ends apart, and the forces of its pins on the cylinder."""
    along = reactions.along[cylinder.name]
    start, end = cylinder.between
    acts = (
        Act(reactions.joined[end][0], end, along),
        Act(reactions.joined[start][0], start, -along),
    )
    reactions.unknowns.append(Unknown(effort, reactions.force, acts))
    for point, sign in ((start, 1.0), (end, -1.0)):
        names = reactions.carriers[point]
        # the force on the link named later is read: on the other one it is the opposite
        if len(names) == 2 and names[-1] != cylinder.name:
            continue
        stem = reactions.stem(point, "force", cylinder.name)
        for axis, part in (("x", along.real), ("y", along.imag)):
            reading = Reading(f"{stem}.{axis}", reactions.force, {effort: sign * part})
            reactions.readings.append(reading)


# ----------------------------------------------------------------------
# Gears: teeth at the pitch point.


@part_contacts.register
def gear_contacts(gear: Gear, linkage: Linkage, at: Places) -> Iterator[Contact]:
    """The pitch point, and the direction from the first wheel's material to the second's."""
    first, second = gear.pitch_radii(linkage)
    # in the ratio of the radii, also where a changed arm changes the distance
    share = first / (first - second if gear.internal else first + second)
    start, end = (at[center] for center in gear.centers)
    way = (end - start) / abs(end - start)
    place = start + share * (end - start)
    yield Contact(name=gear.name, place=place, way=-way if gear.internal else way)


@write_reactions.register
def write_gear(gear: Gear, reactions: Reactions) -> None:
    """The forces of the teeth."""
    mesh(gear.name, gear.wheels, reactions)


# ----------------------------------------------------------------------
# Racks: teeth where the pitch circle touches the pitch line.


@part_contacts.register
def rack_contacts(rack: Rack, linkage: Linkage, at: Places) -> Iterator[Contact]:
    """The pitch point, and the direction from the pinion to the rack."""
    slider = rack.guide(linkage)
    assert slider is not None
    side = -linkage.side_of(slider.line, rack.center)
    reach = side * linkage.numbers(rack.radius)
    yield offset_contact(rack.name, at[rack.center], slider.line, at, side, reach)


@write_reactions.register
def write_rack(rack: Rack, reactions: Reactions) -> None:
    """The forces of the teeth."""
    slider = rack.guide(reactions.linkage)
    assert slider is not None
    mesh(rack.name, (rack.pinion, slider.link), reactions)


# ----------------------------------------------------------------------
# Rolling wheels: a normal force and a grip at the point of contact.


@part_contacts.register
def rolling_contacts(rolling: Rolling, linkage: Linkage, at: Places) -> Iterator[Contact]:
    """The point of contact, and the normal towards the wheel."""
    small = linkage.numbers(rolling.radius)
    if rolling.line is not None:
        side = linkage.side_of(rolling.line, rolling.center)
        center = at[rolling.center]
        yield offset_contact(rolling.name, center, rolling.line, at, side, -side * small)
        return
    assert rolling.circle is not None
    large = linkage.numbers(rolling.circle_radius or 0)
    reach = -large if rolling.inside and large < small else large
    start, end = at[rolling.circle], at[rolling.center]
    way = (end - start) / abs(end - start)
    away = -way if rolling.inside else way
    yield Contact(name=rolling.name, place=start + reach * way, way=away)


@write_reactions.register
def write_rolling(rolling: Rolling, reactions: Reactions) -> None:
    """The forces of the ground, or of another link, on the wheel."""
    away, name = reactions.way[rolling.name], rolling.name
    reactions.pair(f"{name}.normal", rolling.wheel, rolling.on, name, away)
    grip = 1j * away
    line = rolling.line
    # along the line, or counter-clockwise about the centre of the circle
    on_left = line is not None and reactions.linkage.side_of(line, rolling.center) > 0.0
    if rolling.inside or on_left:
        grip = -grip
    reactions.pair(f"{name}.tangent", rolling.wheel, rolling.on, name, grip)


@write_drive.register
def drive_rolling(rolling: Rolling, reactions: Reactions, effort: str) -> None:
    """The force on the wheel's centre along the line."""
    along, body = reactions.along[rolling.name], reactions.joined[rolling.center][0]
    reactions.pair(effort, body, rolling.on, rolling.center, along)


# ----------------------------------------------------------------------
# Sliders: a force normal to the line and a moment.


@write_reactions.register
def write_slider(slider: Slider, reactions: Reactions) -> None:
    """The normal force at the slider's first point, and the moment."""
    across, point = 1j * reactions.along[slider.name], slider.points[0]
    reactions.pair(f"{slider.name}.normal", slider.link, slider.on, point, across)
    reactions.couple(f"{slider.name}.moment", slider.link, slider.on)


@write_drive.register
def drive_slider(slider: Slider, reactions: Reactions, effort: str) -> None:
    """The force along the line at the slider's first point."""
    along = reactions.along[slider.name]
    reactions.pair(effort, slider.link, slider.on, slider.points[0], along)


# ----------------------------------------------------------------------
# Slots: a force on the pin, normal to the slot.


@write_reactions.register
def write_slot(slot: Slot, reactions: Reactions) -> None:
    """The normal force on the pin."""
    body, across = reactions.joined[slot.point][0], 1j * reactions.along[slot.name]
    reactions.pair(f"{slot.name}.normal", body, slot.on, slot.point, across)


@write_drive.register
def drive_slot(slot: Slot, reactions: Reactions, effort: str) -> None:
    """The force on the pin along the slot."""
    body, along = reactions.joined[slot.point][0], reactions.along[slot.name]
    reactions.pair(effort, body, slot.on, slot.point, along)


# ----------------------------------------------------------------------
# Welds: a moment, in addition to the force of the pin that their links share.


@write_reactions.register
def write_weld(weld: Weld, reactions: Reactions) -> None:
    """The moment on the link named later in the file."""
    links = reactions.linkage.links
    earlier, later = sorted(weld.links, key=list(links).index)
    point = next(point for point in links[earlier] if point in links[later])
    stem = point if len(reactions.joined[point]) == 2 else f"{point}.{later}"
    reactions.couple(f"{stem}.moment", later, earlier)


# ----------------------------------------------------------------------
# All reactions of a linkage: of its pins, of every part, and the efforts of the inputs.


def join_links(reactions: Reactions) -> None:
    """Add the reactions of the parts, then the efforts."""
    linkage = reactions.linkage
    for part in linkage.parts:
        write_reactions(part, reactions)
    for which in linkage.inputs:
        (kind, name), effort = which.drives, effort_name(which.column)
        if kind in ("slider", "cylinder"):
            part = next(driven for driven in linkage.parts if driven.drive and driven.label == name)
            write_drive(part, reactions, effort)
            continue
        on, against = name, which.relative_to or GROUND
        if kind == "joint":
            # as the equations drive it: the later link, or the one that is not ground
            against, on = linkage.bodies_at(name)
            if on == GROUND:
                on, against = against, on
        reactions.couple(effort, on, against)
