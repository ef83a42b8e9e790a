"""Files for robots, loaded by MuJoCo, Drake and yourdfpy and compared with the sweep."""

from __future__ import annotations

import io
import logging
from importlib import import_module
from typing import Any
from xml.etree import ElementTree as Tree

import numpy as np

import linkwork as lw
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.part.part import PairKind
from linkwork.core.results.motion import Motion
from linkwork.writers.robot.files import mjcf_of, sdf_of, urdf_of
from linkwork.writers.robot.robot import Robot

__all__ = ["LOADERS", "compared_robot"]

#: Packages that load the formats.
LOADERS = {".mjcf": "mujoco", ".sdf": "pydrake", ".urdf": "yourdfpy"}
_STEP = 13  # every so many rows of a sweep


def compared_robot(name: str, suffix: str) -> str:
    """How far a loaded robot differs from the sweep, or why there is none."""
    mechanism = lw.example(name)
    try:
        robot = Robot(mechanism.model, mechanism.solve())
        if suffix == ".mjcf":
            return _moved(robot, mechanism.sweep())
        if suffix == ".sdf":
            return _posed(robot, mechanism.sweep())
        return _coupled(robot, mechanism)
    except InputError as error:
        return f"refused: {error}"


def _moved(robot: Robot, motion: Motion) -> str:
    """Joint values imposed in MuJoCo: points, gaps of loops, couplings, freedom."""
    mujoco = import_module("mujoco")
    model = mujoco.MjModel.from_xml_string(mjcf_of(robot))
    data = mujoco.MjData(model)
    size = robot.start.length * robot.metre
    values = robot.values(motion)
    away = gap = slip = 0.0
    for row in np.flatnonzero(motion.found)[::_STEP]:
        for name, (value, _) in values.items():
            data.joint(name).qpos[0] = value[row]
        mujoco.mj_forward(model, data)
        for body, points in robot.tree.graph.bodies.items():
            for point in points:
                x, y, _ = data.site(f"{body}/{point}").xpos
                place = motion.place(point).v[row] * robot.metre
                away = max(away, abs(complex(x, y) - place) / size)
        for edge in robot.tree.closing:
            first, second = (data.site(f"{body}/{edge.point}").xpos for body in edge.bodies)
            gap = max(gap, float(np.abs(first - second).max()) / size)
            if edge.kind is PairKind.FIXED:
                turned = [
                    _angle(data.body("world" if body == GROUND else body)) - robot.frame(body)[1]
                    for body in edge.bodies
                ]
                gap = max(gap, abs(np.exp(1j * turned[0]) - np.exp(1j * turned[1])))
        if model.ntendon:
            slip = max(slip, float(np.abs(data.ten_length - model.tendon_length0).max()))
    wrong = "" if away <= 1e-9 and gap <= 1e-12 and slip <= 1e-9 else " WRONG"
    return f"points {away:.1e}, gaps {gap:.1e}, couplings {slip:.1e}{wrong}"


def _angle(body: Any) -> float:
    """The angle of a body in the plane [rad]."""
    return 2.0 * float(np.arctan2(body.xquat[3], body.xquat[0]))


def _posed(robot: Robot, motion: Motion) -> str:
    """Joint values imposed in Drake: points, gaps between the two frames of each closing joint.

    Drake reads closing joints but cannot finish a plant with them: the tree alone moves.
    """
    told, log = _Warnings(), logging.getLogger("drake")
    log.propagate = False
    log.addHandler(told)
    root = Tree.fromstring(sdf_of(robot))
    every = _plant(root)
    model = root.find("model")
    assert model is not None
    closing = [j for j in model.findall("joint") if j.attrib["name"].startswith("loop:")]
    for own in closing:
        model.remove(own)
    plant = _plant(root)
    log.removeHandler(told)
    plant.Finalize()
    context, size = plant.CreateDefaultContext(), robot.start.length * robot.metre
    values, away, gap = robot.values(motion), 0.0, 0.0
    for row in np.flatnonzero(motion.found)[::_STEP]:
        position = np.zeros(plant.num_positions())
        for name, (value, _) in values.items():
            position[plant.GetJointByName(name).position_start()] = value[row]
        plant.SetPositions(context, position)
        for joint in robot.tree.joints:
            for point in robot.tree.graph.bodies[joint.child]:
                frame = plant.GetFrameByName(f"{joint.child}/{point}")
                x, y, _ = frame.CalcPoseInWorld(context).translation()
                place = motion.place(point).v[row] * robot.metre
                away = max(away, abs(complex(x, y) - place) / size)
        for own in closing:
            joint = every.GetJointByName(own.attrib["name"])
            first, second = (
                plant.GetBodyByName(frame.body().name()).EvalPoseInWorld(context)
                @ frame.GetFixedPoseInBodyFrame()
                for frame in (joint.frame_on_parent(), joint.frame_on_child())
            )
            gap = max(gap, np.abs(first.translation() - second.translation()).max() / size)
            if own.attrib["type"] == "fixed":
                turned = first.rotation().matrix() - second.rotation().matrix()
                gap = max(gap, np.abs(turned).max())
    same = every.num_joints() == len(robot.tree.joints) + len(closing)
    wrong = "" if away <= 1e-9 and gap <= 1e-12 and same and not told.texts else " WRONG"
    return f"points {away:.1e}, gaps {gap:.1e}{wrong}" + "".join(f"; {x}" for x in told.texts)


def _plant(root: Tree.Element) -> Any:
    """What Drake reads of an SDF file."""
    drake = import_module("pydrake.all")
    plant = drake.MultibodyPlant(0.0)
    drake.Parser(plant).AddModelsFromString(Tree.tostring(root, encoding="unicode"), "sdf")
    return plant


class _Warnings(logging.Handler):
    """What Drake warns about; it knows no bodies without gravity."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.texts: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        text = record.getMessage()
        if not text.endswith("Unsupported value for SDFormat element gravity: false"):
            self.texts.add(text)


def _coupled(robot: Robot, mechanism: lw.Mechanism) -> str:
    """The largest ratio of true to stated errors of polynomials on ten times finer rows."""
    text = urdf_of(robot, mechanism.sweep())
    loaded = import_module("yourdfpy").URDF.load(
        io.BytesIO(text.encode()), build_scene_graph=False, load_meshes=False
    )
    description = mechanism.description
    several = len(description.inputs) > 1
    rows = description.rows(description.inputs[0])
    step = None if several else float(rows[1] - rows[0]) / 10.0
    values, worst, stated = robot.values(mechanism.sweep(step=step)), 0.0, 0.0
    for own in Tree.fromstring(text).findall("coupling"):
        x, y = (values[own.attrib[key]][0] for key in ("driven", "joint"))
        low, high, error = (float(own.attrib[key]) for key in ("low", "high", "error"))
        inside = (x >= low) & (x <= high) & np.isfinite(y)
        s = (2.0 * x[inside] - low - high) / (high - low)
        series = np.polynomial.chebyshev.chebval(s, np.array((own.text or "").split(), float))
        seen = float(np.abs(series - y[inside]).max())
        # also where the stated error is no number
        worst = max(worst, seen / error if seen <= error else np.inf)
        stated = max(stated, error)
    same = len(loaded.robot.joints) == len(robot.tree.joints)
    wrong = "" if worst <= 1.0 and same else " WRONG"
    rows_told = " (rows of the table: several inputs)" if several else ""
    return f"error {stated:.1e} stated, {worst:.2f} of it seen{rows_told}{wrong}"
