"""Reactions of parts, by their kinds."""

from __future__ import annotations

from dataclasses import replace
from functools import singledispatch
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, ComplexArray, IndexArray
from linkwork.core.foundation.lanes import is_batched
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.mechanism.linkage import Linkage
from linkwork.core.mechanism.part.gears import Belt, Gear, Rack
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot
from linkwork.core.mechanism.part.index import open_room
from linkwork.core.mechanism.part.part import Part
from linkwork.core.mechanism.part.rolling import Rolling
from linkwork.core.mechanism.part.springs import Load, Spring, Weld
from linkwork.core.results.quantity import Kind
from linkwork.forces.reactions.coupling import LargerOf, Sided, Size
from linkwork.forces.reactions.free_bodies import Act, FreeBodies, Holder, Reading
from linkwork.forces.reactions.geometry import AppliedLoads, Geometry

# ----------------------------------------------------------------------
# Reactions of parts, by their kinds.


#: Unknowns with their factors.
Terms = tuple[tuple[int, Array | float], ...]


@singledispatch
def join_part(part: Part, bodies: FreeBodies) -> None:
    """Add the reactions of one part, or its loads."""
    raise NotImplementedError(type(part).__name__)


@singledispatch
def acts_along(part: Part, bodies: FreeBodies) -> tuple[Act, ...]:
    """A unit force along the displacement of a part, and its reaction."""
    raise NotImplementedError(type(part).__name__)


@singledispatch
def read_along(part: Part, bodies: FreeBodies, terms: Terms) -> None:
    """Name the forces that a force along the displacement exerts beside it: in most parts none."""


def join_parts(bodies: FreeBodies) -> None:
    """Add the reactions of all parts."""
    for part in bodies.parts:
        open_room(type(part), "forces")
        join_part(part, bodies)


def join_loads(bodies: FreeBodies) -> None:
    """Add the parts that load the links without joining them."""
    linkage = bodies.linkage
    for part in (*linkage.loads, *linkage.springs):
        open_room(type(part), "forces")
        join_part(part, bodies)


def drive_part(bodies: FreeBodies, name: str) -> int:
    """Add the force along the displacement of the part with this name."""
    part = part_named(bodies, name)
    force = bodies.unknown(*acts_along(part, bodies))
    read_along(part, bodies, ((force, 1.0),))
    return force


def part_named(bodies: FreeBodies, name: str) -> Part:
    """The part with a displacement of this name."""
    part = next(part for part in bodies.parts if part.drive and part.label == name)
    open_room(type(part), "forces")
    return part


# ----------------------------------------------------------------------
# Contacts along curves: how a point slides on another body, and the normal of its path.


def sliding(geometry: Geometry, point: str, body: str, center: str) -> ComplexArray:
    """The velocity of a point relative to a body with a centre, per unit of each input, (p, B)."""
    arm = geometry.place(point).v - geometry.place(center).v
    found: ComplexArray = (
        geometry.partial(point) - geometry.partial(center) - 1j * geometry.turning(body) * arm
    )
    return found


def of_input(rates: AnyArray, which: IndexArray | None) -> AnyArray:
    """Rates by the input that :func:`moving_most` has chosen in every row, (B,)."""
    return rates if which is None else np.take_along_axis(rates, which, axis=0)[0]


def moving_most(rates: AnyArray) -> IndexArray | None:
    """Which input moves something most in every row, (1, B).

    ``None`` for rates (B,) of one input, as of numbers on a tape.
    """
    if is_batched(rates) or rates.ndim == 1:
        return None
    found: IndexArray = np.argmax(np.nan_to_num(np.abs(rates)), axis=0)[None, :]
    return found


def normal_away(along: ComplexArray, away: ComplexArray) -> ComplexArray:
    """The unit normal of a direction on the side of another one, (B,)."""
    with np.errstate(all="ignore"):
        normal = 1j * along / np.abs(along)
    found: ComplexArray = normal * np.where((normal.conj() * away).real < 0.0, -1.0, 1.0)
    return found


# ----------------------------------------------------------------------
# The line of a guide: its direction, and forces along it and across.


def line_of(line: tuple[str, str], geometry: Geometry) -> ComplexArray:
    """The unit vector from the first to the second point of a line, (B,)."""
    span = geometry.place(line[1]).v - geometry.place(line[0]).v
    unit: ComplexArray = span / np.abs(span)
    return unit


def along_line(
    bodies: FreeBodies, holder: Holder, point: str, on: str, line: tuple[str, str],
    turn: complex = 1.0,
) -> tuple[Act, Act]:  # fmt: skip
    """A unit force at a point of one body along a line of another, or turned to the left of it."""
    way = turn * line_of(line, bodies.geometry)
    place = bodies.geometry.place(point).v
    return Act(holder, place, way), Act(bodies.link(on), place, -way)


def rub_on_line(
    name: str, bodies: FreeBodies, size: Size, pair: tuple[Holder, Holder], point: str,
    line: tuple[str, str],
) -> None:  # fmt: skip
    """Friction of a point of one body along a line of another."""
    geometry = bodies.geometry
    rates = sliding(geometry, point, pair[1].body, line[0])
    bodies.rub_force(name, size, pair, geometry.place(point).v, line_of(line, geometry), rates)


# ----------------------------------------------------------------------
# Reactions of teeth: a force along the pitch line, and one that pushes the wheels apart.
#
# The force of a tooth acts at the pitch point along the line of action, which is inclined to the
# pitch line by the pressure angle, and pushes whatever side it turns to.


def mesh(
    name: str, bodies: FreeBodies, links: tuple[str, str], place: ComplexArray,
    away: ComplexArray, pressure: float, slope: Array | float = 0.0,
) -> None:  # fmt: skip
    """Add the force of the first link's teeth on the second's.

    Parameters
    ----------
    place : (B,)
        The pitch point.
    away : (B,)
        The unit vector from the first link's material to the second's, along the line of centres.
    pressure : float
        The pressure angle [rad].
    slope : (B,)
        The angle from the normal of the line of centres to the common tangent of the pitch curves.
    """
    first, second = map(bodies.link, links)
    along = bodies.pair(second, first, place, 1j * away)
    about = f"force of {links[0]} on {links[1]} across the line of centres"
    bodies.read(f"{name}.tangent", Kind.FORCE, about, along)
    acts = Act(second, place, away), Act(first, place, -away)
    plus, minus = (_separating(side, pressure, slope) for side in (1.0, -1.0))
    apart = bodies.follow(Sided(unknowns=(along,), plus=plus, minus=minus), *acts)
    about = f"force of {links[0]} on {links[1]} along the line of centres"
    bodies.read(f"{name}.radial", Kind.FORCE, about, follow=apart)
    friction = bodies.friction(name)
    if friction is not None:
        # teeth slide at their distance from the pitch point times the relative speed of rotation
        arm = bodies.number(friction.mu) * bodies.number(friction.radius)
        size = Sided(
            unknowns=(along,), plus=arm * np.hypot(1.0, plus), minus=arm * np.hypot(1.0, minus)
        )
        bodies.rub_couple(name, size, second, first)


def _separating(side: float, pressure: float, slope: Array | float) -> Array:
    """The force along the line of centres for a unit across it to one side.

    A tooth pushes along ± t + n tan α, t the common tangent and n its normal.
    """
    # eq. (74): p, the direction of the push in the frame of the line of centres
    push = (side * 1j + np.tan(pressure)) * np.exp(1j * slope)
    found: Array = side * push.real / push.imag
    return found


# ----------------------------------------------------------------------
# Reactions of a belt: the tensions of its two strands.


@join_part.register
def join_belt(belt: Belt, bodies: FreeBodies) -> None:
    """Half of the pull in one strand and against it in the other, and the tension of both."""
    wheels = tuple(map(bodies.link, belt.wheels))
    strands = []
    for side in (1.0, -1.0):
        start, end = _strand(belt, bodies, side)
        way = (end - start) / np.abs(end - start)
        strands.append((Act(wheels[0], start, way), Act(wheels[1], end, -way)))
    left, right = strands
    pull = bodies.unknown(*(act.times(0.5) for act in left), *(act.times(-0.5) for act in right))
    given = None if belt.pretension is None else bodies.linkage.numbers(belt.pretension)
    # without pretension the slack strand has none
    half = 0.5 if given is None else 0.0
    size = Sided(unknowns=(pull,), plus=half, minus=half, constant=given or 0.0)
    both = bodies.follow(size, *left, *right)
    for number, own in ((1, 0.5), (2, -0.5)):
        about = f"tension of the strand {'left' if number == 1 else 'right'} of the centres"
        name = f"{belt.name}.tension{number}"
        bodies.read(name, Kind.FORCE, about, pull, own, follow=both, pushes=True)


def _strand(belt: Belt, bodies: FreeBodies, side: float) -> tuple[ComplexArray, ComplexArray]:
    """The tangent points of a strand on both wheels."""
    first, second = (bodies.geometry.place(center).v for center in belt.centers)
    small, large = belt.pitch_radii(bodies.linkage)
    # the strands of a crossed belt touch the second wheel on its other side
    large = -large if belt.crossed else large
    distance = np.abs(second - first)
    cosine = (small - large) / distance
    out = (second - first) / distance * (cosine + side * 1j * np.sqrt(1.0 - cosine**2))
    return first + small * out, second + large * out


# ----------------------------------------------------------------------
# Reaction of a cylinder: it has no mass and pushes along its axis only.


@join_part.register
def join_cylinder(cylinder: Cylinder, bodies: FreeBodies) -> None:
    """A cylinder that is not driven transmits no force."""
    driven = {which.drives for which in bodies.linkage.inputs}
    coupled = {name for part in bodies.parts for name in part.pushes}
    if ("cylinder", cylinder.name) not in driven and cylinder.name not in coupled:
        read_cylinder(cylinder, bodies, ())


@acts_along.register
def along_cylinder(cylinder: Cylinder, bodies: FreeBodies) -> tuple[Act, ...]:
    """The force that pushes its ends apart."""
    first, second = (bodies.geometry.place(point).v for point in cylinder.between)
    along = (second - first) / np.abs(second - first)
    start, end = map(bodies.at, cylinder.between)
    return Act(end, second, along), Act(start, first, -along)


@read_along.register
def read_cylinder(cylinder: Cylinder, bodies: FreeBodies, terms: Terms) -> None:
    """The forces of the pins on the cylinder."""
    first, second = (bodies.geometry.place(point).v for point in cylinder.between)
    along = (second - first) / np.abs(second - first)
    for point, sign in zip(cylinder.between, (1.0, -1.0), strict=True):
        names = bodies.carriers[point]
        stem = f"{point}.force" if len(names) < 3 else f"{point}.force.{cylinder.name}"
        # the force on the link named later is read: on the other one it is the opposite
        if len(names) < 2 or (len(names) == 2 and names[-1] != cylinder.name):
            continue
        parts: dict[str, Array] = {"x": along.real, "y": along.imag}
        for axis, part in parts.items():
            about = f"force of the pin {point} on {cylinder.name}"
            name = f"{stem}.{axis}"
            own = tuple((unknown, sign * part * factor) for unknown, factor in terms)
            # a cylinder of two couplings has the forces of both
            known = [k for k, reading in enumerate(bodies.readings) if reading.name == name]
            for k in known:
                terms_of_both = (*bodies.readings[k].terms, *own)
                bodies.readings[k] = replace(bodies.readings[k], terms=terms_of_both)
            if not known:
                reading = Reading(name=name, kind=Kind.FORCE, about=about, terms=own)
                bodies.readings.append(reading)


# ----------------------------------------------------------------------
# Reactions of a gear pair: forces at its pitch point.


@join_part.register
def join_gear(gear: Gear, bodies: FreeBodies) -> None:
    """The tooth force on the line of centres at the pitch radii."""
    first, second = (bodies.geometry.place(center).v for center in gear.centers)
    along = (second - first) / np.abs(second - first)
    small, large = gear.pitch_radii(bodies.linkage)
    inside = gear.internal and small < large  # the first wheel is inside the second
    place = first - small * along if inside else first + small * along
    # a pinion in a ring pushes outwards, from the centres to the pitch point
    away = -along if gear.internal else along
    mesh(gear.name, bodies, gear.wheels, place, away, gear.pressure(bodies.linkage))


# ----------------------------------------------------------------------
# Given forces and torques.


@join_part.register
def join_load(load: Load, bodies: FreeBodies) -> None:
    """A load has no reaction of its own."""
    apply_load(load, bodies.applied)


def apply_load(load: Load, applied: AppliedLoads) -> None:
    """The force or torque in all rows."""
    if load.torque is not None:
        assert load.link is not None
        applied.turn(load.link, applied.value(load.torque))
        return
    assert load.point is not None
    x, y = map(applied.value, load.force or ())
    force = x + 1j * y
    if load.turns_with is not None:
        force = force * applied.geometry.direction(load.turns_with).v
    applied.push(load.point, force, load.link)


# ----------------------------------------------------------------------
# Reactions of a rack and pinion: forces at the pitch point.


@join_part.register
def join_rack(rack: Rack, bodies: FreeBodies) -> None:
    """The tooth force where the pitch circle touches the pitch line of the rack."""
    linkage, geometry = bodies.linkage, bodies.geometry
    slider = rack.guide(linkage)
    assert slider is not None
    # from the pinion to the rack
    side = linkage.side_of(slider.line, rack.center)
    away = -side * 1j * line_of(slider.line, geometry)
    place = geometry.place(rack.center).v + linkage.numbers(rack.radius) * away
    links = (rack.pinion, slider.link)
    mesh(rack.name, bodies, links, place, away, rack.pressure(linkage))


# ----------------------------------------------------------------------
# Reactions of a rolling wheel: a normal force and a grip at the point of contact.


@join_part.register
def join_rolling(rolling: Rolling, bodies: FreeBodies) -> None:
    """The force that presses on the wheel, and the grip that keeps it from slipping."""
    place, away, along = _contact(rolling, bodies)
    wheel, on = bodies.link(rolling.wheel), bodies.link(rolling.on)
    normal = bodies.pair(wheel, on, place, away)
    about = f"force that presses {rolling.on} and {rolling.wheel} together"
    bodies.read(f"{rolling.name}.normal", Kind.FORCE, about, normal, pushes=True)
    grip = bodies.pair(wheel, on, place, along)
    about = f"force of {rolling.on} on {rolling.wheel} that keeps it from slipping"
    friction = bodies.friction(rolling.name)
    adhesion = None if friction is None else (normal, bodies.number(friction.mu))
    bodies.read(f"{rolling.name}.tangent", Kind.FORCE, about, grip, adhesion=adhesion)


def _contact(
    rolling: Rolling, bodies: FreeBodies
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """The point of contact, the normal towards the wheel, the tangent."""
    geometry, linkage = bodies.geometry, bodies.linkage
    center, small = geometry.place(rolling.center).v, linkage.numbers(rolling.radius)
    if rolling.line is not None:
        along = line_of(rolling.line, geometry)
        away = linkage.side_of(rolling.line, rolling.center) * 1j * along
        return center - small * away, away, along
    assert rolling.circle is not None
    middle, large = geometry.place(rolling.circle).v, linkage.numbers(rolling.circle_radius or 0)
    out = (center - middle) / np.abs(center - middle)
    if not rolling.inside:
        return middle + large * out, out, 1j * out
    side = 1.0 if large > small else -1.0  # the smaller of both is inside the other
    return middle + side * large * out, -out, 1j * out


@acts_along.register
def along_rolling(rolling: Rolling, bodies: FreeBodies) -> tuple[Act, ...]:
    """The force on the wheel's centre along the line."""
    assert rolling.line is not None
    pin = bodies.at(rolling.center)
    return along_line(bodies, pin, rolling.center, rolling.on, rolling.line)


# ----------------------------------------------------------------------
# Reactions of a slider: a force normal to its line and a moment.


@join_part.register
def join_slider(slider: Slider, bodies: FreeBodies) -> None:
    """The normal force at the slider's first point, positive to the left, and the moment."""
    link, on = bodies.link(slider.link), bodies.link(slider.on)
    force = bodies.unknown(*along_line(bodies, link, slider.points[0], slider.on, slider.line, 1j))
    about = f"force of {slider.on} on {slider.link} at {slider.points[0]}, to the left of its line"
    bodies.read(f"{slider.name}.normal", Kind.FORCE, about, force)
    # a slider transmits a moment: its link cannot turn on the other
    moment, length = bodies.couple(link, on), bodies.geometry.length
    about = f"moment of {slider.on} on {slider.link} about {slider.points[0]}"
    bodies.read(f"{slider.name}.moment", Kind.MOMENT, about, moment, length)
    friction = bodies.friction(slider.name)
    if friction is None:
        return
    mu = bodies.number(friction.mu)
    size: Size = Sided(unknowns=(force,), plus=mu, minus=mu)
    if friction.length is not None:
        # both ends push: N/2 ± M/l, together N, or 2 M/l where they push opposite ways
        factors = (mu, 2.0 * mu * length / bodies.number(friction.length))
        size = LargerOf(unknowns=(force, moment), factors=factors)
    rub_on_line(slider.name, bodies, size, (link, on), slider.points[0], slider.line)


@acts_along.register
def along_slider(slider: Slider, bodies: FreeBodies) -> tuple[Act, ...]:
    """The force along the line at the slider's first point."""
    return along_line(bodies, bodies.link(slider.link), slider.points[0], slider.on, slider.line)


# ----------------------------------------------------------------------
# Reaction of a slot: a force on the pin, normal to the slot.


@join_part.register
def join_slot(slot: Slot, bodies: FreeBodies) -> None:
    """The normal force on the pin, positive to the left of the line."""
    pin = bodies.at(slot.point)
    force = bodies.unknown(*along_line(bodies, pin, slot.point, slot.on, slot.line, 1j))
    about = f"force of the slot on the pin {slot.point}, to the left of its line"
    bodies.read(f"{slot.name}.normal", Kind.FORCE, about, force)
    friction = bodies.friction(slot.name)
    if friction is not None:
        mu = bodies.number(friction.mu)
        size = Sided(unknowns=(force,), plus=mu, minus=mu)
        rub_on_line(slot.name, bodies, size, (pin, bodies.link(slot.on)), slot.point, slot.line)


@acts_along.register
def along_slot(slot: Slot, bodies: FreeBodies) -> tuple[Act, ...]:
    """The force on the pin along the slot."""
    return along_line(bodies, bodies.at(slot.point), slot.point, slot.on, slot.line)


# ----------------------------------------------------------------------
# Forces of springs and dampers.


@join_part.register
def join_spring(spring: Spring, bodies: FreeBodies) -> None:
    """Its tension between two points, or its torque between two links."""
    if not spring.pulls:
        return
    if spring.between is not None:
        _pull(spring, spring.between, bodies)
    elif spring.links is not None:
        _wind(spring, spring.links, bodies)


def _pull(spring: Spring, between: tuple[str, str], bodies: FreeBodies) -> None:
    applied, numbers = bodies.applied, bodies.geometry.numbers
    start, end = map(bodies.geometry.place, between)
    span = end - start
    length = np.abs(span.v) * applied.passed.get(spring.name, 1.0)
    with np.errstate(all="ignore"):
        # a spring of no length has no direction
        along: Any = np.where(length == 0.0, 0.0, span.v / length)
        rate = (along.conj() * span.d1).real
    tension = _force(spring, bodies, length - numbers(spring.free), rate)
    pull = tension * along
    applied.push(between[0], pull)
    applied.push(between[1], -pull)
    about = "tension of the spring and its damper"
    bodies.read(f"{spring.name}.tension", Kind.FORCE, about, constant=tension)


def _wind(spring: Spring, links: tuple[str, str], bodies: FreeBodies) -> None:
    linkage, geometry, applied = bodies.linkage, bodies.geometry, bodies.applied
    first, second = map(geometry.angle, links)
    turn = second - first
    torque = _force(spring, bodies, turn.v - wound_angle(spring, linkage), turn.d1)
    applied.turn(links[0], torque)
    applied.turn(links[1], -torque)
    about = f"torque of the spring on {links[0]}, and against it on {links[1]}"
    bodies.read(f"{spring.name}.torque", Kind.MOMENT, about, constant=torque)


def wound_angle(spring: Spring, linkage: Linkage) -> float:
    """The angle [rad] from the first link to the second of an unloaded torsion spring.

    The sketch is within half a turn of it; from there windings count.
    """
    assert spring.links is not None
    free = linkage.numbers(spring.free) * linkage.angle.radians
    first, second = map(linkage.sketched_angle, spring.links)
    return free + FULL_TURN * round((second - first - free) / FULL_TURN)


def _force(spring: Spring, bodies: FreeBodies, stretch: Array, rate: Array) -> Array:
    """Stiffness times stretch and damping times its rate; the energy of the spring is noted."""
    numbers, applied = bodies.geometry.numbers, bodies.applied
    stiffness, damping = numbers(spring.stiffness), numbers(spring.damping)
    speed = rate * applied.rate if applied.moves else np.zeros(bodies.geometry.shape)
    applied.stored.append(0.5 * stiffness * stretch**2)
    applied.stored_rates.append(stiffness * stretch * speed)
    found: Array = stiffness * stretch + damping * speed
    return found


# ----------------------------------------------------------------------
# Reaction of a weld: a moment beside the force of the pin that its links share.


@join_part.register
def join_weld(weld: Weld, bodies: FreeBodies) -> None:
    """The moment on the link named later in the file."""
    links = bodies.linkage.links
    earlier, later = sorted(weld.links, key=list(links).index)
    moment, length = bodies.couple(bodies.link(later), bodies.link(earlier)), bodies.geometry.length
    point = next(point for point in links[earlier] if point in links[later])
    stem = point if len(bodies.joined[point]) == 2 else f"{point}.{later}"
    about = f"moment of {earlier} on {later} at their weld"
    bodies.read(f"{stem}.moment", Kind.MOMENT, about, moment, length)
