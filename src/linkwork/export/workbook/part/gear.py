"""Gears: teeth at the pitch point."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.export.workbook.contact import SPAN, Contact
from linkwork.export.workbook.part.teeth import mesh, pressure
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.gear import Gear

__all__ = ["contacts", "numbers", "write"]

numbers = pressure


def contacts(gear: Gear, linkage: Linkage) -> Iterator[Contact]:
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


def write(gear: Gear, reactions: Reactions) -> None:
    """The forces of the teeth."""
    mesh(gear.name, gear.wheels, reactions)
