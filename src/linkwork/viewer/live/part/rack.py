"""What is picked for a rack and pinion, and the rack drawn from it."""

from __future__ import annotations

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.viewer.live.drawn_sheet import DrawnSheet, away_from_line, short
from linkwork.viewer.live.part_picks import end, pick
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    end("Click the pinion's centre, or the link that is the pinion."),
    pick("Click the block that is the rack, or where the rack runs.", "point", "place"),
)


def draw(sheet: DrawnSheet, wheel: Picked, bar: Picked) -> None:
    """Add the pinion at a rack that exists, or at a new block."""
    pinion, center = sheet.wheel(wheel, "pinion", GROUND)
    start, at = sheet.place(center), complex(bar.x, bar.y)
    slider = sheet.slider_at(sheet.picked(bar))
    if slider is None:
        radius = sheet.distinct(start, at, "the pinion's centre and the rack")
        name = sheet.block(bar, 1j * (at - start), sheet.frame(center, pinion), None)
    else:
        name, radius = slider.name, away_from_line(start, *map(sheet.place, slider.line))
        if sheet.same(radius):
            raise InputError(
                f"the rack's line {' '.join(slider.line)} runs through {center}: "
                "a pinion is beside its rack"
            )
    sheet.finish(
        name=sheet.name("rack"), pinion=pinion, center=center, slider=name,
        radius=short(radius),
    )  # fmt: skip
