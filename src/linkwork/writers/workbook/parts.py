"""Cells of the reactions of parts, by their kinds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import singledispatch

from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.gears import Belt, Gear, Rack, ToothedPart
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot
from linkwork.core.mechanism.part.part import Part
from linkwork.core.mechanism.part.rolling import Rolling
from linkwork.core.mechanism.part.weld import Weld
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.drives import effort_name
from linkwork.writers.workbook.acting import (
    SPAN,
    Act,
    Contact,
    Entry,
    Reading,
    Unknown,
    computed,
    left_of,
    minus,
    offset_contact,
    opposite,
)
from linkwork.writers.workbook.reactions import Reactions

# ----------------------------------------------------------------------
# Cells of the reactions of parts, by their kinds.
#
# A part may also give the places where it pushes links in contact, and those numbers on which its
# forces alone depend: word, value, kind, description.


Numbers = Iterable[tuple[str, float, Kind, str]]


@singledispatch
def write_reactions(part: Part, reactions: Reactions) -> None:
    """Add the cells of a part's reactions; some parts have none."""


@singledispatch
def write_drive(part: Part, reactions: Reactions, effort: str) -> None:
    """Add the cells of the force along the displacement of a part that can be driven."""


@singledispatch
def part_contacts(part: Part, linkage: Linkage) -> Iterable[Contact]:
    """Where a part pushes links in contact."""
    return ()


@singledispatch
def part_numbers(part: Part, linkage: Linkage) -> Numbers:
    """The numbers on which the forces of a part alone depend."""
    return ()


def contacts_of(linkage: Linkage) -> Iterator[Contact]:
    """Where the parts of a linkage push links in contact."""
    for part in linkage.parts:
        yield from part_contacts(part, linkage)


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
    reactions.pair(tangent, second, first, name, left_of(way))
    names = {"p": reactions.cells[f"{name} pressure"]}
    acts = opposite(second, first, name, way)
    # eq. (74) for round wheels
    reactions.follow(f"{name}.radial", tangent, "tan(p)*abs(t)", names, acts)


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
def belt_contacts(belt: Belt, linkage: Linkage) -> Iterator[Contact]:
    """The tangent points of both strands; the unit vectors are their pull on the wheels."""
    first, second = belt.pitch_radii(linkage)
    if belt.crossed:  # the strands touch the second wheel on its other side
        second = -second
    cosine = f"({(first - second)!r}/{SPAN})"
    sine = f"sqrt(1-{cosine}^2)"
    for side in (1, -1):
        # the direction from both centres to the tangent points
        out_x = f"((bx-ax)*{cosine} - {side}*(by-ay)*{sine})/{SPAN}"
        out_y = f"((by-ay)*{cosine} + {side}*(bx-ax)*{sine})/{SPAN}"
        for wheel, (letter, radius) in enumerate((("a", first), ("b", second))):
            way = side if wheel == 0 else -side
            yield Contact(
                name=_strand(belt, side, wheel),
                points=dict(zip("ab", belt.centers, strict=True)),
                place=(f"{letter}x + {radius!r}*{out_x}", f"{letter}y + {radius!r}*{out_y}"),
                # normal to the radii
                way=(f"{way}*{out_y}", f"{-way}*{out_x}"),
            )


def _strand(belt: Belt, side: int, wheel: int) -> str:
    return f"{belt.name} {'left' if side > 0 else 'right'} on {belt.wheels[wheel]}"


@write_reactions.register
def write_belt(belt: Belt, reactions: Reactions) -> None:
    """The pull, the mean tension, and the tensions of both strands."""
    halves, whole = [], []
    for side, half in ((1, "0.5*w"), (-1, "-0.5*w")):
        for wheel, link in enumerate(belt.wheels):
            point = _strand(belt, side, wheel)
            x, y = reactions.way[point]
            halves.append(Act(link, point, computed(half, {"w": x}), computed(half, {"w": y})))
            whole.append(Act(link, point, x, y))
    pull, mean = f"{belt.name}.pull", f"{belt.name}.mean"
    reactions.unknowns.append(Unknown(pull, reactions.force, tuple(halves)))
    names: dict[str, Entry] = {}
    size = "0.5*abs(t)"  # without pretension the slack strand has none
    if belt.pretension is not None:
        size, names = "p", {"p": reactions.cells[f"{belt.name} pretension"]}
    reactions.follow(mean, pull, size, names, tuple(whole))
    for number, text in ((1, "b+0.5*a"), (2, "b-0.5*a")):
        name = f"{belt.name}.tension{number}"
        reactions.readings.append(Reading(name, reactions.force, text, (pull, mean)))


# ----------------------------------------------------------------------
# Cylinders push along their axis; those that are not driven transmit no force.


@write_drive.register
def drive_cylinder(cylinder: Cylinder, reactions: Reactions, effort: str) -> None:
    """The force that pushes the ends apart, and the forces of its pins on the cylinder."""
    along = reactions.along[cylinder.name]
    start, end = cylinder.between
    acts = (
        Act(reactions.joined[end][0], end, *along),
        Act(reactions.joined[start][0], start, minus(along[0]), minus(along[1])),
    )
    reactions.unknowns.append(Unknown(effort, reactions.force, acts))
    for point, sign in ((start, ""), (end, "-")):
        names = reactions.carriers[point]
        # the force on the link named later is read: on the other one it is the opposite
        if len(names) == 2 and names[-1] != cylinder.name:
            continue
        stem = reactions.stem(point, "force", cylinder.name)
        for axis, component in zip("xy", along, strict=True):
            reading = Reading(
                f"{stem}.{axis}", reactions.force, f"{sign}a*w", (effort,), {"w": component}
            )
            reactions.readings.append(reading)


# ----------------------------------------------------------------------
# Gears: teeth at the pitch point.


numbers = pressure


@part_contacts.register
def gear_contacts(gear: Gear, linkage: Linkage) -> Iterator[Contact]:
    """The pitch point, and the direction from the first wheel's material to the second's."""
    first, second = gear.pitch_radii(linkage)
    # in the ratio of the radii, also where a changed arm changes the distance
    share = first / (first - second if gear.internal else first + second)
    sign = "-" if gear.internal else ""
    yield Contact(
        name=gear.name,
        points=dict(zip("ab", gear.centers, strict=True)),
        place=(f"ax + {share!r}*(bx-ax)", f"ay + {share!r}*(by-ay)"),
        way=(f"{sign}(bx-ax)/{SPAN}", f"{sign}(by-ay)/{SPAN}"),
    )


@write_reactions.register
def write_gear(gear: Gear, reactions: Reactions) -> None:
    """The forces of the teeth."""
    mesh(gear.name, gear.wheels, reactions)


# ----------------------------------------------------------------------
# Racks: teeth where the pitch circle touches the pitch line.


@part_contacts.register
def rack_contacts(rack: Rack, linkage: Linkage) -> Iterator[Contact]:
    """The pitch point, and the direction from the pinion to the rack."""
    slider = rack.guide(linkage)
    assert slider is not None
    side = -linkage.side_of(slider.line, rack.center)
    yield offset_contact(
        rack.name, rack.center, slider.line, side, side * linkage.numbers(rack.radius)
    )


@write_reactions.register
def write_rack(rack: Rack, reactions: Reactions) -> None:
    """The forces of the teeth."""
    slider = rack.guide(reactions.linkage)
    assert slider is not None
    mesh(rack.name, (rack.pinion, slider.link), reactions)


# ----------------------------------------------------------------------
# Rolling wheels: a normal force and a grip at the point of contact.


@part_contacts.register
def rolling_contacts(rolling: Rolling, linkage: Linkage) -> Iterator[Contact]:
    """The point of contact, and the normal towards the wheel."""
    small = linkage.numbers(rolling.radius)
    if rolling.line is not None:
        side = linkage.side_of(rolling.line, rolling.center)
        yield offset_contact(rolling.name, rolling.center, rolling.line, side, -side * small)
        return
    assert rolling.circle is not None
    large = linkage.numbers(rolling.circle_radius or 0)
    away = -1.0 if rolling.inside else 1.0
    reach = -large if rolling.inside and large < small else large
    yield Contact(
        name=rolling.name,
        points={"a": rolling.circle, "b": rolling.center},
        place=(f"ax + {reach!r}*(bx-ax)/{SPAN}", f"ay + {reach!r}*(by-ay)/{SPAN}"),
        way=(f"{away!r}*(bx-ax)/{SPAN}", f"{away!r}*(by-ay)/{SPAN}"),
    )


@write_reactions.register
def write_rolling(rolling: Rolling, reactions: Reactions) -> None:
    """The forces of the ground, or of another link, on the wheel."""
    away, name = reactions.way[rolling.name], rolling.name
    reactions.pair(f"{name}.normal", rolling.wheel, rolling.on, name, away)
    grip = left_of(away)
    line = rolling.line
    # along the line, or counter-clockwise about the centre of the circle
    on_left = line is not None and reactions.linkage.side_of(line, rolling.center) > 0.0
    if rolling.inside or on_left:
        grip = minus(grip[0]), minus(grip[1])
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
    across, point = left_of(reactions.along[slider.name]), slider.points[0]
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
    body, across = reactions.joined[slot.point][0], left_of(reactions.along[slot.name])
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
