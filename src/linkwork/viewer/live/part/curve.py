"""What is picked for a curve, and the curve drawn from it."""

from __future__ import annotations

import cmath
from itertools import pairwise

from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.viewer.live.drawn_sheet import DrawnSheet, short
from linkwork.viewer.live.part_picks import ANYWHERE, pick
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    pick("Click the pin that runs along the curve.", "point"),
    pick(
        "Click places along the curve; Enter, or a click on the last place, ends it.",
        *ANYWHERE,
        repeated=True,
    ),
)


def draw(sheet: DrawnSheet, pin: Picked, *picks: Picked) -> None:
    """Add the curve through the pin and the places."""
    point = sheet.picked(pin)
    if not point:
        raise InputError("begin at the pin that runs along the curve")
    on = sheet.body(picks[0]) if picks[0].link else GROUND
    places = [sheet.place(point), *(complex(pick.x, pick.y) for pick in picks)]
    distinct = [b for a, b in pairwise(places) if not sheet.same(abs(b - a))]
    places = [places[0], *distinct]
    origin = sheet.links[on][0] if sheet.links[on] else sheet.point(places[0], on)
    turn = 0.0 if on == GROUND else sheet.draft.sketched_angle(on)
    own = [(place - sheet.place(origin)) * cmath.exp(-1j * turn) for place in places]
    through = tuple(f"{short(z.real)}, {short(z.imag)}" for z in own)
    sheet.finish(name=sheet.name("u"), point=point, on=on, origin=origin, through=through)
