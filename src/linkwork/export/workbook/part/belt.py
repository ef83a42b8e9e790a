"""Belts: half of the pull in one strand and against it in the other, and the tension of both."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.export.workbook.acting import Act, Entry, Reading, Unknown, computed
from linkwork.export.workbook.contact import SPAN, Contact
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.belt import Belt
from linkwork.results.quantity import Kind

__all__ = ["contacts", "numbers", "write"]


def numbers(belt: Belt, linkage: Linkage) -> Iterator[tuple[str, float, Kind, str]]:
    """The pretension, if it has one."""
    if belt.pretension is not None:
        about = f"tension of both strands of {belt.name} at rest"
        yield "pretension", linkage.numbers(belt.pretension), Kind.FORCE, about


def contacts(belt: Belt, linkage: Linkage) -> Iterator[Contact]:
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


def write(belt: Belt, reactions: Reactions) -> None:
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
