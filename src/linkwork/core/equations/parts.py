"""Equations of parts, by their kinds."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import singledispatch

from linkwork.core.equations.frames import Frames, PartRows
from linkwork.core.foundation.lanes import choose, is_batched, leader_value, uniform_value
from linkwork.core.foundation.precise import Precise, precise
from linkwork.core.foundation.rounding import UNIT_ROUNDOFF
from linkwork.core.mechanism.description import Key, Problems
from linkwork.core.mechanism.part.gears import Rack, WheelPair
from linkwork.core.mechanism.part.guides import Cylinder, Slider, Slot
from linkwork.core.mechanism.part.index import open_room
from linkwork.core.mechanism.part.part import Part
from linkwork.core.mechanism.part.rolling import Rolling

# ----------------------------------------------------------------------
# Equations of parts, by their kinds.


@singledispatch
def write_rows(part: Part, key: Key, rows: PartRows) -> None:
    """Add the equations of a part and its entries of frames; some parts have none."""


def rows_of_parts(frames: Frames, problems: Problems) -> PartRows:
    """The rows of all parts of a linkage; their positions and rods are added to ``frames``."""
    rows = PartRows(frames, problems)
    for key, part in frames.linkage.keyed_parts:
        open_room(type(part), "equations")
        write_rows(part, key, rows)
    return rows


# ----------------------------------------------------------------------
# The linear equation between the angles of two wheels in mesh or with a belt.


# relative: sizes this near to a ratio of small integers have that ratio, since both are rounded
_RATIO = 4.0 * UNIT_ROUNDOFF
_LARGEST = 10_000  # of these integers


@write_rows.register
def write_wheel_pair(pair: WheelPair, key: Key, rows: PartRows) -> None:
    """q (θ2 - θa) ± p (θ1 - θa) = constant, p : q = r1 : r2."""
    numbers = rows.frames.linkage.numbers
    sizes = pair.radii if pair.radii is not None else pair.teeth
    assert sizes is not None
    p, q = ratio(*map(numbers.precise, sizes), whole=pair.teeth is not None)
    p = -p if pair.together else p
    phase = None
    if pair.phase is not None:
        phase = numbers.precise_angle(pair.phase) * q
    first, second = pair.wheels
    turns = [(second, q), (first, p), (pair.arm, -p - q)]
    rows.tie(pair.name, turns, total=phase, measured=("phase", q))


def ratio(
    numerator: float | Precise, denominator: float | Precise, *, whole: bool = False
) -> tuple[float, float]:
    """Two sizes as the smallest integers of their ratio if these exist, otherwise unchanged.

    With integers, whole turns of one wheel give exactly whole turns of the other.
    """
    over = precise(numerator) / precise(denominator)
    first, second = precise(numerator).high, precise(denominator).high
    if is_batched(first) or is_batched(second):
        p, q = ratio(leader_value(first), leader_value(second), whole=whole)
        if q == 1.0 and not whole:
            return uniform_value(over.high), q
        same = abs(q * first - p * second) <= _RATIO * abs(q * first)
        return uniform_value(choose(same, p, math.nan)), q
    if whole:
        fraction = Fraction(int(first), int(second))
    else:
        fraction = Fraction(over.high).limit_denominator(_LARGEST)
    if fraction > 0 and abs(float(fraction) * second - first) <= _RATIO * first:
        return float(fraction.numerator), float(fraction.denominator)
    return over.high, 1.0


# ----------------------------------------------------------------------
# Equation of a rack: its pitch line moves with the circumference of the pinion.


@write_rows.register
def write_rack(rack: Rack, key: Key, rows: PartRows) -> None:
    """Write the equation of the rack's displacement and the pinion's angle."""
    linkage = rows.frames.linkage
    slider = rack.guide(linkage)
    assert slider is not None
    side = rows.side(slider.on, slider.line, rack.center, (*key, "center"))
    r = side * linkage.numbers.precise(rack.radius).high
    turns = [(rack.pinion, -r), (slider.on, r)]
    rows.tie(
        rack.name,
        turns,
        lengths=[(rack.slider, 1.0)],
        measured=(f"{rack.slider} at {rack.pinion} = 0", 1.0),
    )


# ----------------------------------------------------------------------
# Equations of a rolling wheel: its angle against its path on a line or around a circle.


@write_rows.register
def write_rolling(rolling: Rolling, key: Key, rows: PartRows) -> None:
    """Write the equations for a line or a circle."""
    if rolling.line is not None:
        _roll_on_line(rolling, key, rows)
    else:
        _roll_on_circle(rolling, rows)


def _roll_on_line(rolling: Rolling, key: Key, rows: PartRows) -> None:
    assert rolling.line is not None
    frames, linkage = rows.frames, rows.frames.linkage
    side = rows.side(rolling.on, rolling.line, rolling.center, (*key, "center"))
    radius = linkage.numbers.precise(rolling.radius) * side
    name = f"{rolling.name}_radius"
    frames.add_guide((rolling.name, rolling.on, rolling.line), rolling.center, radius, name)
    turns = [(rolling.wheel, radius.high), (rolling.on, -radius.high)]
    measured = (f"{rolling.name} at {rolling.wheel} = 0", 1.0)
    rows.tie(rolling.name, turns, [(rolling.name, 1.0)], measured=measured)


def _roll_on_circle(rolling: Rolling, rows: PartRows) -> None:
    """Join the centres by a rod; wheel and circle mesh as gears on it."""
    assert rolling.circle is not None
    assert rolling.circle_radius is not None
    frames, numbers = rows.frames, rows.frames.linkage.numbers
    small, large = numbers.precise(rolling.radius), numbers.precise(rolling.circle_radius)
    length = abs(large - small) if rolling.inside else large + small
    a, b = rolling.circle, rolling.center
    frames.add_rod(rolling.name, (a, b), length)
    p, q = ratio(large, small)
    p = -p if rolling.inside else p
    turns = [(rolling.wheel, q), (rolling.on, p), (rolling.name, -p - q)]
    rows.tie(rolling.name, turns, measured=(f"{rolling.wheel} at {rolling.name} = 0", q))


# ----------------------------------------------------------------------
# Frame entries of a cylinder: a body of variable length.


@write_rows.register
def write_cylinder(cylinder: Cylinder, key: Key, rows: PartRows) -> None:
    """Add a rod with an unknown angle and length."""
    rows.frames.add_rod(cylinder.name, cylinder.between, angle=cylinder.angle_name)


# ----------------------------------------------------------------------
# Frame entries of a slider: its first point moves along a line of known angle.


@write_rows.register
def write_slider(slider: Slider, key: Key, rows: PartRows) -> None:
    """Add the displacement as a length in the frame of the link with the line."""
    offset, name = rows.frames.linkage.numbers.precise(slider.offset), f"{slider.name}_offset"
    guide = (slider.name, slider.on, slider.line)
    rows.frames.add_guide(guide, slider.points[0], offset, name)


# ----------------------------------------------------------------------
# Frame entries of a slot: its point moves along a line.


@write_rows.register
def write_slot(slot: Slot, key: Key, rows: PartRows) -> None:
    """Add the displacement as a length in the frame of the link with the line."""
    rows.frames.add_guide((slot.name, slot.on, slot.line), slot.point)
