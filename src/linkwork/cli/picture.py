"""Picture files of the commands."""

from __future__ import annotations

from collections.abc import Sequence

from linkwork.api import Mechanism
from linkwork.cli.terminal import progress
from linkwork.drawing.charts.plotting import motion_plot
from linkwork.drawing.mechanism_scene import SceneOptions, scene_of
from linkwork.drawing.picture_file import check_picture, write
from linkwork.drawing.pose import no_points
from linkwork.drawing.scene import Scene
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["check_picture", "check_points", "sweep_scene", "write", "write_plot"]

_FURTHER = 4  # further positions drawn in a sweep: every fifth of a crank's turn


def check_points(mechanism: Mechanism) -> None:
    """Reject a mechanism without points before any computation.

    Raises
    ------
    InputError
        If the mechanism has no points.
    """
    if not mechanism.model.compiled.points.names:
        raise no_points(mechanism.name)


def write_plot(motion: Motion, names: Sequence[str], path: str, over: str = "the input") -> str:
    """Plot columns, or unknowns and outputs, if there are positions; returns a line about it."""
    if not motion.found.any():
        return f"Did not write {path}: there is no position to plot."
    with progress("drawing"):
        write(motion_plot(motion, names), path)
    return f"Wrote {path}: {', '.join(names) or 'unknowns and outputs'} over {over}."


def sweep_scene(position: Position, motion: Motion) -> Scene:
    """The start position of a sweep, faint further positions, its limits and the traced paths."""
    if not motion.found.any():
        return scene_of(position)
    return scene_of(position, motion, options=SceneOptions(further=_FURTHER))
