"""A slider leads its first point along a line; its link has the angle of the line."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.slider import Slider

__all__ = ["write"]


def write(slider: Slider, key: Key, rows: PartRows) -> None:
    """The displacement is a length in the frame of the link with the line."""
    offset, name = rows.frames.linkage.numbers(slider.offset), f"{slider.name}_offset"
    guide = (slider.name, slider.on, slider.line)
    rows.frames.add_guide(guide, slider.points[0], offset, name)
