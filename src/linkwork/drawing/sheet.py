"""Several pictures side by side, of one scale."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from linkwork.drawing.mechanism_scene import SceneOptions, scene_of
from linkwork.drawing.scene import Box, Scene
from linkwork.results.configurations import Configurations

__all__ = ["Sheet", "configuration_sheet"]


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """Scenes in rows; all show the same part of the plane."""

    title: str
    caption: str
    scenes: tuple[Scene, ...]

    @property
    def columns(self) -> int:
        """How many scenes stand in a row."""
        return max(1, min(4, math.ceil(math.sqrt(len(self.scenes)))))

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
        If the mechanism has no points to draw.
    """
    alone = [scene_of(position) for position in found]
    within = alone[0].within if alone else Box(0.0, 0.0, 1.0, 1.0)
    for scene in alone[1:]:
        within = within.with_box(scene.within)
    scenes = [
        replace(
            scene_of(position, options=SceneOptions(title=position.configuration, within=within)),
            caption="",
        )
        for position in found
    ]
    where = ", ".join(
        f"{name} = {value:.6g} {found.input_units.get(name, '')}".rstrip()
        for name, value in found.input.items()
    )
    count = len(scenes)
    what = f"{count} configuration{'' if count == 1 else 's'}"
    return Sheet(
        title=found.mechanism,
        caption=f"{what} at {where}" if where else what,
        scenes=tuple(scenes),
    )
