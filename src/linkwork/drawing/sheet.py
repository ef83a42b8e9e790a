"""Several pictures side by side, of one scale."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from linkwork.drawing.captions import inputs_caption
from linkwork.drawing.mechanism_scene import SceneOptions, scene_of
from linkwork.drawing.scene import Box, Scene
from linkwork.foundation.errors import InputError
from linkwork.results.configurations import Configurations

__all__ = ["TALLEST", "Sheet", "configuration_sheet"]

_WIDTH, _SMALLEST_CELL = 7.5, 2.2  # inches
_USUAL = 5.2  # inches: in smaller pictures names and symbols are larger than usual
_LARGEST = 2.0
_WHOLE = 6.0  # inches: in larger pictures, of a single configuration, names are smaller

#: The height of a picture over its width, at most.
TALLEST = 1.6


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """Scenes in rows; all show the same part of the plane."""

    title: str
    caption: str
    scenes: tuple[Scene, ...]

    @property
    def columns(self) -> int:
        """How many scenes stand in a row."""
        return _columns(len(self.scenes))

    @property
    def cell(self) -> float:
        """The width of a scene in inches, with what is left free beside it."""
        return _cell(len(self.scenes))

    @property
    def view(self) -> Box:
        """What every scene shows."""
        box = self.scenes[0].box
        for scene in self.scenes[1:]:
            box = box.with_box(scene.box)
        return box


def configuration_sheet(found: Configurations) -> Sheet:
    """Every configuration as a picture, its name above it.

    Raises
    ------
    InputError
        If there is no configuration, or the mechanism has no points to draw.
    """
    if not len(found):
        raise InputError(f'"{found.mechanism}" has no configuration to draw: {found.message}')
    within, *others = (scene_of(position).within for position in found)
    for other in others:
        # one frame for all, so that sizes compare
        within = within.with_box(other)
    printed = _printed(within, _cell(len(found)))
    larger = min(max(_USUAL / printed, min(_WHOLE / printed, 1.0)), _LARGEST)
    scenes = [
        replace(
            scene_of(
                position,
                options=SceneOptions(title=position.configuration, within=within, larger=larger),
            ),
            caption="",
        )
        for position in found
    ]
    count = len(scenes)
    where = inputs_caption(found.input, found.input_units, found.positions[0].units)
    what = f"{count} configuration{'' if count == 1 else 's'}"
    return Sheet(
        title=found.mechanism,
        caption=f"{what} at {where}" if where else what,
        scenes=tuple(scenes),
    )


def _printed(box: Box, cell: float) -> float:
    """The longer side of a box in inches, where it fills a cell."""
    width, height = max(box.width, 1e-9), max(box.height, 1e-9)
    return max(width, height) * min(cell / width, TALLEST * cell / height)


def _columns(count: int) -> int:
    return max(1, min(4, math.ceil(math.sqrt(count))))


def _cell(count: int) -> float:
    return max(_SMALLEST_CELL, _WIDTH / _columns(count))
