"""What is picked for a weld, and the weld drawn from it."""

from __future__ import annotations

from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.part_picks import pick
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    pick("Click the first link; a fixed pin is the ground.", "point", "link"),
    pick("Click the link that is welded to it.", "point", "link"),
)


def draw(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the weld of two links."""
    sheet.finish(links=(sheet.body(first), sheet.body(second)))
