"""What is picked for a belt, and the belt drawn from it."""

from __future__ import annotations

from linkwork.viewer.live.drawn_sheet import DrawnSheet, short
from linkwork.viewer.live.part_picks import wheel
from linkwork.viewer.live.part_requests import Picked
from linkwork.viewer.live.wheel_sizes import pulley_radii

__all__ = ["PICKS", "draw"]

PICKS = (
    wheel("Click the first pulley's centre or link; drag from it to set its radius."),
    wheel("Click the second pulley's centre or link; drag from it to set its radius."),
)


def draw(sheet: DrawnSheet, first: Picked, second: Picked) -> None:
    """Add the belt around two pulleys."""
    wheels, centers, arm = sheet.wheels((first, second), "pulley")
    distance = abs(sheet.place(centers[1]) - sheet.place(centers[0]))
    radii = pulley_radii(sheet.draft, wheels, distance, (first.size, second.size))
    sheet.finish(
        name=sheet.name("belt"), wheels=wheels, centers=centers, arm=arm,
        radii=(", ".join(map(short, radii)),),
    )  # fmt: skip
