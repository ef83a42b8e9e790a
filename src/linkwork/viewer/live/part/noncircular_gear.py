"""What is picked for non-circular gears, and the gears drawn from it."""

from __future__ import annotations

from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.part_picks import end
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

_LAW = "-(phi + 2*atan(0.3*sin(phi)/(1 - 0.3*cos(phi))))"

PICKS = (
    end("Click the first gear's centre, or the link that is the gear."),
    end("Click the second gear's centre or link."),
)


def draw(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add two equal ellipses."""
    wheels, centers, arm = sheet.wheels((first, second), "gear")
    sheet.finish(name=sheet.name("n"), wheels=wheels, centers=centers, arm=arm, law=_LAW)
