"""What is picked for a cylinder, and the cylinder drawn from it."""

from __future__ import annotations

from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.part_picks import end
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    end("Drag from one end of the cylinder to the other."),
    end("Click the other end of the cylinder."),
)


def draw(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the cylinder between two points."""
    sheet.distinct(complex(first.x, first.y), complex(second.x, second.y), "the two ends")
    name = sheet.name("c")
    ends = (sheet.end(first), sheet.end(second))
    sheet.finish(name=name, between=ends)
