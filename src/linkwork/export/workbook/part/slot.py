"""Slots: a force on the pin, normal to the slot."""

from __future__ import annotations

from linkwork.export.workbook.acting import left_of
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.part.slot import Slot

__all__ = ["drive", "write"]


def write(slot: Slot, reactions: Reactions) -> None:
    """The normal force on the pin."""
    own, across = reactions.joined[slot.point][0], left_of(reactions.along[slot.name])
    reactions.pair(f"{slot.name}.normal", own, slot.on, slot.point, across)


def drive(slot: Slot, reactions: Reactions, effort: str) -> None:
    """The force on the pin along the slot."""
    own, along = reactions.joined[slot.point][0], reactions.along[slot.name]
    reactions.pair(effort, own, slot.on, slot.point, along)
