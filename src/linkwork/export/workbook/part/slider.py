"""Sliders: a force normal to the line and a moment."""

from __future__ import annotations

from linkwork.export.workbook.acting import left_of
from linkwork.export.workbook.reaction_cells import Reactions
from linkwork.mechanism.part.slider import Slider

__all__ = ["drive", "write"]


def write(slider: Slider, reactions: Reactions) -> None:
    """The normal force at the slider's first point, and the moment."""
    across, point = left_of(reactions.along[slider.name]), slider.points[0]
    reactions.pair(f"{slider.name}.normal", slider.link, slider.on, point, across)
    reactions.couple(f"{slider.name}.moment", slider.link, slider.on)


def drive(slider: Slider, reactions: Reactions, effort: str) -> None:
    """The force along the line at the slider's first point."""
    along = reactions.along[slider.name]
    reactions.pair(effort, slider.link, slider.on, slider.points[0], along)
