"""The picture of a position, as the commands write it."""

from __future__ import annotations

from pathlib import Path

from linkwork.drawing.matplotlib_writer import FORMATS, write
from linkwork.drawing.mechanism_scene import scene_of
from linkwork.drawing.scene import Scene
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["check_picture", "scene", "write"]


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


def scene(position: Position, motion: Motion | None) -> Scene:
    """The picture of a position with the traced paths of a motion, if there is one."""
    travelled = motion is not None and bool(motion.found.any())
    return scene_of(position, motion if travelled else None)
