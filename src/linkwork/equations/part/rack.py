"""Equation of a rack: its pitch line moves with the circumference of the pinion."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.rack import Rack

__all__ = ["write"]


def write(rack: Rack, key: Key, rows: PartRows) -> None:
    """Write the equation of the rack's displacement and the pinion's angle."""
    linkage = rows.frames.linkage
    slider = rack.guide(linkage)
    assert slider is not None
    side = rows.side(slider.on, slider.line, rack.center, (*key, "center"))
    r = side * linkage.numbers.precise(rack.radius).high
    turns = [(rack.pinion, -r), (slider.on, r)]
    rows.tie(
        rack.name,
        turns,
        length=(rack.slider, 1.0),
        measured=(f"{rack.slider} at {rack.pinion} = 0", 1.0),
    )
