"""Racks: teeth where the pitch circle touches the pitch line."""

from __future__ import annotations

from collections.abc import Iterator

from linkwork.export.workbook.contact import Contact, offset_contact
from linkwork.export.workbook.part.teeth import mesh, pressure
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.linkage import Linkage
from linkwork.mechanism.part.rack import Rack

__all__ = ["contacts", "numbers", "write"]

numbers = pressure


def contacts(rack: Rack, linkage: Linkage) -> Iterator[Contact]:
    """The pitch point, and the direction from the pinion to the rack."""
    slider = rack.guide(linkage)
    assert slider is not None
    side = -linkage.side_of(slider.line, rack.center)
    yield offset_contact(
        rack.name, rack.center, slider.line, side, side * linkage.numbers(rack.radius)
    )


def write(rack: Rack, reactions: Reactions) -> None:
    """The forces of the teeth."""
    slider = rack.guide(reactions.linkage)
    assert slider is not None
    mesh(rack.name, (rack.pinion, slider.link), reactions)
