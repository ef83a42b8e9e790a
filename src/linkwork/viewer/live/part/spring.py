"""What is picked for a spring, and the spring drawn from it."""

from __future__ import annotations

from linkwork.foundation.names import GROUND
from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.part_picks import end
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    end("Drag from one end of the spring to the other."),
    end("Click the other end of the spring."),
)


def draw(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the spring between two points; a new one is fixed, as springs carry none."""
    sheet.distinct(complex(first.x, first.y), complex(second.x, second.y), "the two ends")
    name = sheet.name("spring")
    ends = (sheet.end(first, GROUND), sheet.end(second, GROUND))
    sheet.finish(name=name, between=ends)
