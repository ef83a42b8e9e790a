"""What is picked for a cam, and the cam drawn from it."""

from __future__ import annotations

import math

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.viewer.live.drawn_sheet import DrawnSheet, short
from linkwork.viewer.live.part_picks import end, pick
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    end("Click the cam's centre, or the link that is the cam."),
    pick("Click the follower: a block, the end of a link, or a place.", "point", "place"),
)


def draw(sheet: DrawnSheet, disc: Picked, follower: Picked) -> None:
    """Add the cam with a follower that exists, or a new block."""
    cam, center = sheet.wheel(disc, "cam", GROUND)
    start, at = sheet.place(center), complex(follower.x, follower.y)
    base = sheet.distinct(start, at, "the cam's centre and the follower")
    frame, point = sheet.frame(center, cam), sheet.picked(follower)
    half, typed = sheet.draft.angle.turn / 2, {"name": sheet.name("lift"), "cam": cam}
    lift = sheet.draft.angle.from_radians(math.radians(20))
    arm = next((link for link in sheet.on(point) if link not in (frame, cam)), "")
    slider = sheet.slider_at(point) if point else None
    if slider is not None or not arm or len(sheet.links[arm]) < 2:
        lift = base / 2
        top = None if slider else sheet.point(at + sheet.span * (at - start) / base, frame)
        line = (center, top) if top else None
        typed["slider"] = slider.name if slider else sheet.block(follower, at - start, frame, line)
    else:
        pivots = [p for p in sheet.links[arm] if p != point and p in sheet.links[frame]]
        if not pivots:
            raise InputError(
                f'"{arm}" shares no pivot with "{frame}", on which the cam turns: fix its other '
                "end to the ground, or click a block"
            )
        typed |= {"link": arm, "pivot": pivots[0], "point": point}
    segments = [f"cycloidal, {half!r}, {sign}{short(lift)}" for sign in ("", "-")]
    sheet.finish(**typed, center=center, base=short(base), segments=tuple(segments))
