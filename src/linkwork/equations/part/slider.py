"""Frame entries of a slider: its first point moves along a line of known angle."""

from __future__ import annotations

from linkwork.equations.part_rows import PartRows
from linkwork.mechanism.description import Key
from linkwork.mechanism.part.slider import Slider

__all__ = ["write"]


def write(slider: Slider, key: Key, rows: PartRows) -> None:
    """Add the displacement as a length in the frame of the link with the line."""
    offset, name = rows.frames.linkage.numbers.precise(slider.offset), f"{slider.name}_offset"
    guide = (slider.name, slider.on, slider.line)
    rows.frames.add_guide(guide, slider.points[0], offset, name)
