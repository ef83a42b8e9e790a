"""Frame entries of a slot: its point moves along a line."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.slot import Slot

__all__ = ["write"]


def write(slot: Slot, key: Key, rows: PartRows) -> None:
    """Add the displacement as a length in the frame of the link with the line."""
    rows.frames.add_guide((slot.name, slot.on, slot.line), slot.point)
