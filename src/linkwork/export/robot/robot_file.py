"""A mechanism's file for a simulator of robots, in the format of its suffix."""

from __future__ import annotations

from pathlib import Path

from linkwork.export.robot.markup import WORLD
from linkwork.export.robot.mjcf import mjcf_of
from linkwork.export.robot.robot import Robot
from linkwork.export.robot.sdf import sdf_of
from linkwork.export.robot.urdf import urdf_of
from linkwork.foundation.errors import InputError
from linkwork.foundation.paths import suffix_of
from linkwork.motion.model import Model
from linkwork.results.motion import Motion
from linkwork.results.position import Position

__all__ = ["check_robot_file", "robot_of"]

_FORMATS = (".mjcf", ".urdf", ".sdf")


def check_robot_file(file: Path) -> str:
    """The suffix of a robot's file.

    Raises
    ------
    InputError
        If there is no such format.
    """
    return suffix_of(file, "a robot", _FORMATS)


def robot_of(model: Model, start: Position, motion: Motion | None, file: Path) -> str:
    """Write a mechanism for a simulator of robots.

    Parameters
    ----------
    model : Model
    start : Position
        Where all joint values are zero.
    motion : Motion, optional
        The sweep through this position; URDF needs it for its polynomials and limits.
    file : Path
        Its suffix selects the format.

    Raises
    ------
    InputError
        If there is no such format, or it cannot describe the mechanism.
    """
    suffix = check_robot_file(file)
    robot = Robot(model, start)
    if suffix == ".urdf":
        if motion is None:
            raise InputError("URDF has no loops: its joints need a motion to follow")
        return urdf_of(robot, motion)
    if WORLD in robot.tree.graph.bodies:
        raise InputError(
            f'link "{WORLD}" has the name of the ground in MJCF and SDF: rename it, or write URDF'
        )
    return mjcf_of(robot) if suffix == ".mjcf" else sdf_of(robot)
