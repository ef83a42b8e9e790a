"""Pictures, as the commands write them."""

from __future__ import annotations

from pathlib import Path

from linkwork.api import Mechanism
from linkwork.drawing.matplotlib_writer import FORMATS, write
from linkwork.drawing.mechanism_scene import SceneOptions, scene_of
from linkwork.drawing.pose import no_points
from linkwork.drawing.scene import Scene
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["check_picture", "check_points", "sweep_scene", "write"]

_FURTHER = 7  # positions of a sweep drawn besides its start: every eighth of a crank's turn


def check_picture(path: str) -> None:
    """Refuse a picture of an unknown format before anything is computed.

    Raises
    ------
    InputError
        If the suffix names no known format.
    """
    suffix = Path(path).suffix
    if suffix.lower().removeprefix(".") not in FORMATS:
        known = ", ".join(f".{name}" for name in FORMATS)
        raise InputError(f'cannot draw "{path}": its suffix must be one of {known}')


def check_points(mechanism: Mechanism) -> None:
    """Refuse a mechanism without points before anything is computed.

    Raises
    ------
    InputError
        If there is nothing to draw.
    """
    if not mechanism.model.compiled.points.names:
        raise no_points(mechanism.name)


def sweep_scene(position: Position, motion: Motion) -> Scene:
    """The start of a sweep, faint positions on the way, its limits and the traced paths."""
    if not motion.found.any():
        return scene_of(position)
    return scene_of(position, motion, options=SceneOptions(further=_FURTHER))
