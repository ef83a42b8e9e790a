"""What is picked for a load, and the force drawn from it."""

from __future__ import annotations

from linkwork.foundation.errors import InputError
from linkwork.viewer.live.drawn_sheet import DrawnSheet, short
from linkwork.viewer.live.part_picks import pick
from linkwork.viewer.live.part_requests import Picked

__all__ = ["PICKS", "draw"]

PICKS = (
    pick("Drag from a point in the direction of its force.", "point"),
    pick("Click the tip of the force: a unit of length is a unit of force.", "place"),
)


def draw(sheet: DrawnSheet, start: Picked, tip: Picked) -> None:
    """Add the force on a point; its length in the drawing is its size."""
    point = sheet.picked(start)
    if not point:
        raise InputError("a force acts on a point: pick one")
    place = sheet.place(point)
    force = complex(tip.x, tip.y) - place
    sheet.distinct(place, place + force, "the point and the tip")
    components = ", ".join(map(short, (force.real, force.imag)))
    sheet.finish(point=point, force=(components,))
