"""Rolling wheels: a normal force and a grip at the point of contact."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.export.workbook.acting import left_of, minus
from linkwork.export.workbook.contact import SPAN, Contact, offset_contact
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.rolling import Rolling

__all__ = ["contacts", "drive", "write"]


def contacts(rolling: Rolling, linkage: Linkage) -> Iterator[Contact]:
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


def write(rolling: Rolling, reactions: Reactions) -> None:
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


def drive(rolling: Rolling, reactions: Reactions, effort: str) -> None:
    """The force on the wheel's centre along the line."""
    along, own = reactions.along[rolling.name], reactions.joined[rolling.center][0]
    reactions.pair(effort, own, rolling.on, rolling.center, along)
