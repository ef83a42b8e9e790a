"""What is picked for a pin in a slot, and the slot drawn from it."""

from __future__ import annotations

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.part_picks import end, pick
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    pick("Click the pin that runs in the slot.", "point"),
    end("Click the link with the slot; or drag from the pin along a fixed slot."),
)


def draw(sheet: DrawnSheet, pin: Picked, track: Picked) -> None:
    """Add the slot on a link, or on two new fixed points."""
    point, at = sheet.picked(pin), complex(track.x, track.y)
    if not point:
        raise InputError("begin at the pin that runs in the slot")
    name = sheet.name("s")
    if track.point or track.link:
        on = sheet.body(track)
        if point in sheet.links[on]:
            raise InputError(
                f'"{on}" carries {point}, which cannot move in its slot: take the pin off this '
                "link first, or choose another link"
            )
        line = sheet.segment(on, at)
    else:
        start = sheet.place(point)
        sheet.distinct(start, at, "the pin and the end of the slot")
        on, line = GROUND, sheet.line(start, at - start, GROUND)
    sheet.finish(name=name, point=point, on=on, line=line)
