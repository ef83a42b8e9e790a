"""Where parts push links in contact, as formulas of points: teeth, wheels, strands of belts.

A contact has a place and a unit vector, as the rooms of ``forces/part`` have them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from linkwork.forces.part.guide import side_of
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.belt import Belt
from linkwork.mechanism.part.gear import Gear
from linkwork.mechanism.part.rack import Rack
from linkwork.mechanism.part.rolling import Rolling

__all__ = ["Contact", "contacts", "strand"]

_SPAN = "hypot(bx-ax, by-ay)"


@dataclass(frozen=True, kw_only=True)
class Contact:
    """A row of the sheet; ``points`` are those of the formulas' names: ``ax`` is the x of ``a``."""

    name: str
    points: dict[str, str]
    place: tuple[str, str]
    way: tuple[str, str]


def contacts(linkage: Linkage) -> Iterator[Contact]:
    """The contacts of all parts."""
    for part in linkage.parts:
        match part:
            case Gear():
                yield _pitch_point(part, linkage)
            case Rack():
                yield _rack(part, linkage)
            case Rolling():
                yield _rolling(part, linkage)
            case Belt():
                for side in (1, -1):
                    yield from _strand(part, linkage, side)


def _pitch_point(gear: Gear, linkage: Linkage) -> Contact:
    first, second = gear.pitch_radii(linkage)
    # in the ratio of the radii, also where a changed arm changes the distance
    share = first / (first - second if gear.internal else first + second)
    sign = "-" if gear.internal else ""
    return Contact(
        name=gear.name,
        points=dict(zip("ab", gear.centers, strict=True)),
        place=(f"ax + {share!r}*(bx-ax)", f"ay + {share!r}*(by-ay)"),
        way=(f"{sign}(bx-ax)/{_SPAN}", f"{sign}(by-ay)/{_SPAN}"),
    )


def _rack(rack: Rack, linkage: Linkage) -> Contact:
    slider = rack.guide(linkage)
    assert slider is not None
    side = -side_of(slider.line, rack.center, linkage)
    return _beside(rack.name, rack.center, slider.line, side, side * linkage.numbers(rack.radius))


def _rolling(rolling: Rolling, linkage: Linkage) -> Contact:
    small = linkage.numbers(rolling.radius)
    if rolling.line is not None:
        side = side_of(rolling.line, rolling.center, linkage)
        return _beside(rolling.name, rolling.center, rolling.line, side, -side * small)
    assert rolling.circle is not None
    large = linkage.numbers(rolling.circle_radius or 0)
    away = -1.0 if rolling.inside else 1.0
    reach = -large if rolling.inside and large < small else large
    return Contact(
        name=rolling.name,
        points={"a": rolling.circle, "b": rolling.center},
        place=(f"ax + {reach!r}*(bx-ax)/{_SPAN}", f"ay + {reach!r}*(by-ay)/{_SPAN}"),
        way=(f"{away!r}*(bx-ax)/{_SPAN}", f"{away!r}*(by-ay)/{_SPAN}"),
    )


def _beside(name: str, center: str, line: tuple[str, str], side: float, reach: float) -> Contact:
    """``reach`` to the left of a line from a centre; the unit vector is to its ``side``."""
    return Contact(
        name=name,
        points={"a": line[0], "b": line[1], "c": center},
        place=(f"cx - {reach!r}*(by-ay)/{_SPAN}", f"cy + {reach!r}*(bx-ax)/{_SPAN}"),
        way=(f"{-side!r}*(by-ay)/{_SPAN}", f"{side!r}*(bx-ax)/{_SPAN}"),
    )


def strand(belt: Belt, side: int, wheel: int) -> str:
    """The name of a strand's contact on one of the wheels."""
    return f"{belt.name} {'left' if side > 0 else 'right'} on {belt.wheels[wheel]}"


def _strand(belt: Belt, linkage: Linkage, side: int) -> Iterator[Contact]:
    """The tangent points of a strand; the unit vectors are its pull on the wheels."""
    first, second = belt.pitch_radii(linkage)
    if belt.crossed:  # the strands touch the second wheel on its other side
        second = -second
    cosine = f"({(first - second)!r}/{_SPAN})"
    sine = f"sqrt(1-{cosine}^2)"
    # the direction from both centres to the tangent points
    out_x = f"((bx-ax)*{cosine} - {side}*(by-ay)*{sine})/{_SPAN}"
    out_y = f"((by-ay)*{cosine} + {side}*(bx-ax)*{sine})/{_SPAN}"
    for wheel, (letter, radius) in enumerate((("a", first), ("b", second))):
        way = side if wheel == 0 else -side
        yield Contact(
            name=strand(belt, side, wheel),
            points=dict(zip("ab", belt.centers, strict=True)),
            place=(f"{letter}x + {radius!r}*{out_x}", f"{letter}y + {radius!r}*{out_y}"),
            # normal to the radii
            way=(f"{way}*{out_y}", f"{-way}*{out_x}"),
        )
