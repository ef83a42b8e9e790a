"""What is picked for a gear pair, and the gears drawn from it."""

from __future__ import annotations

from linkwork.viewer.live.drawn_sheet import DrawnSheet
from linkwork.viewer.live.part_picks import wheel
from linkwork.viewer.live.part_requests import Picked
from linkwork.viewer.live.wheel_sizes import gear_teeth

__all__ = ["PICKS", "draw"]

PICKS = (
    wheel("Click the first gear's centre, or the link that is the gear."),
    wheel("Click the second gear's centre or link; drag from it to set its radius."),
)


def draw(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the two gears; teeth fit any distance of the centres."""
    wheels, centers, arm = sheet.wheels((first, second), "gear")
    distance = abs(sheet.place(centers[1]) - sheet.place(centers[0]))
    around = bool(sheet.wheel_at(centers[1])) and wheels[1] not in sheet.turning
    teeth, internal = gear_teeth(sheet.draft, wheels, distance, (first.size, second.size), around)
    flag = {"internal": "true"} if internal else {}
    sheet.finish(
        name=sheet.name("mesh"), wheels=wheels, centers=centers, arm=arm,
        teeth=(", ".join(map(str, teeth)),), **flag,
    )  # fmt: skip
