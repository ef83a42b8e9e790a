"""What is picked for a rolling wheel, and the wheel drawn from it."""

from __future__ import annotations

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.viewer.live.drawn_sheet import DrawnSheet, away_from_line, short
from linkwork.viewer.live.part_picks import end
from linkwork.viewer.live.part_requests import Picked, Typed

__all__ = ["PICKS", "draw"]

PICKS = (
    end("Click the wheel's centre, or the link that is the wheel."),
    end("Click the link on which it rolls, the centre of a circle, or a place of the ground."),
)


def draw(sheet: DrawnSheet, rolls: Picked, track: Picked) -> None:
    """Add the wheel on a line or circle."""
    wheel, center = sheet.wheel(rolls, "wheel")
    start, at = sheet.place(center), complex(track.x, track.y)
    typed: dict[str, Typed] = {"name": sheet.name("x"), "wheel": wheel, "center": center}
    if around := sheet.picked(track):
        away = sheet.distinct(start, sheet.place(around), "the two centres")
        on = next((link for link in sheet.on(around) if link != wheel), GROUND)
        half = short(away / 2)
        sheet.finish(**typed, radius=half, on=on, circle=around, circle_radius=half)
        return
    if track.link:
        on = sheet.body(track)
        line = sheet.segment(on, at)
        radius = away_from_line(start, *map(sheet.place, line))
    else:
        radius = sheet.distinct(start, at, "the wheel's centre and the line")
        on, line = GROUND, sheet.line(at, 1j * (at - start), GROUND)
    if sheet.same(radius):
        raise InputError(f"the line runs through {center}: a wheel is beside its line")
    sheet.finish(**typed, radius=short(radius), on=on, line=line)
