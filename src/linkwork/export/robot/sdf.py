"""SDF: bodies and all joints, those that close loops included."""

from __future__ import annotations

from xml.etree import ElementTree as Tree

from linkwork.export.robot.joint_tree import TreeJoint
from linkwork.export.robot.markup import WORLD, element, numbers, written
from linkwork.export.robot.robot import Robot
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import GROUND
from linkwork.mechanism.part.pairs import Pair, PairKind

__all__ = ["sdf_of"]

_UNTITLED = "mechanism"
_KINDS = {PairKind.PIN: "revolute", PairKind.SLIDE: "prismatic", PairKind.FIXED: "fixed"}


def sdf_of(robot: Robot) -> str:
    """Write a mechanism as an SDF 1.9 model.

    Raises
    ------
    InputError
        If wheels are coupled: SDF has no equivalent for every such coupling; or if a link has a
        name that SDF reserves.
    """
    if robot.tree.graph.couplings:
        name = robot.tree.graph.couplings[0].name
        raise InputError(f'"{name}" couples turning wheels: SDF cannot describe it; write MJCF')
    reserved = [body for body in robot.tree.graph.bodies if _is_reserved(body)]
    if reserved:
        raise InputError(f'link "{reserved[0]}" has a name that SDF reserves: rename it')
    root = Tree.Element("sdf", version="1.9")
    notes = [*robot.notes(), "Joints whose names begin with loop: close loops."]
    driven = [joint.name for joint in robot.driven().values() if joint is not None]
    if driven:
        notes.append(f"Driven joints, whose motors a model cannot give: {', '.join(driven)}.")
    title = robot.name
    if not title or title == WORLD or _is_reserved(title) or "::" in title:
        notes.append(f'The model is named "{_UNTITLED}": SDF does not allow "{title}".')
        title = _UNTITLED
    model = element(root, "model", name=title)
    if robot.gravity():
        fall = robot.gravity()
        gravity = numbers(fall.real, fall.imag, 0.0)
        notes.append(f"The world's gravity has to be {gravity}: a model cannot give it.")
    for joint in robot.tree.joints:
        _link(model, robot, joint, gravity=bool(robot.gravity()))
    for joint in robot.tree.joints:
        _points(model, robot, joint.child)
    for joint in robot.tree.joints:
        kind = joint.edge.kind
        along = robot.axis(joint) if kind is PairKind.SLIDE else None
        _joint(model, kind, joint.name, (joint.parent, joint.child), along=along)
    for k, edge in enumerate(robot.tree.closing):
        _closing(model, robot, edge, k)
    return written(root, notes)


def _link(model: Tree.Element, robot: Robot, joint: TreeJoint, *, gravity: bool) -> None:
    link = element(model, "link", name=joint.child)
    place, angle = robot.frame(joint.child)
    element(link, "pose", numbers(place.real, place.imag, 0, 0, 0, angle))
    if not gravity:
        element(link, "gravity", "false")
    own = robot.inertia(joint.child)
    inertial = element(link, "inertial")
    element(inertial, "pose", numbers(own.center.real, own.center.imag, 0, 0, 0, 0))
    element(inertial, "mass", numbers(own.mass))
    inertia = element(inertial, "inertia")
    for name in ("ixx", "iyy", "izz"):
        element(inertia, name, numbers(own.inertia))


def _is_reserved(name: str) -> bool:
    return len(name) >= 4 and name.startswith("__") and name.endswith("__")


def _points(model: Tree.Element, robot: Robot, body: str) -> None:
    """The points of a body as frames: those of ground cannot be frames of a model."""
    for point, place in robot.points(body).items():
        frame = element(model, "frame", name=f"{body}/{point}", attached_to=body)
        element(frame, "pose", numbers(place.real, place.imag, 0, 0, 0, 0))


def _joint(
    model: Tree.Element,
    kind: PairKind,
    name: str,
    bodies: tuple[str, str],
    *,
    along: complex | None = None,
    place: complex = 0j,
) -> None:
    """A joint; its frame is at a place in the child's frame."""
    parent, child = (WORLD if body == GROUND else body for body in bodies)
    own = element(model, "joint", name=name, type=_KINDS[kind])
    element(own, "parent", parent)
    element(own, "child", child)
    element(own, "pose", numbers(place.real, place.imag, 0, 0, 0, 0))
    if kind is not PairKind.FIXED:
        axis = (0.0, 0.0, 1.0) if along is None else (along.real, along.imag, 0.0)
        element(element(own, "axis"), "xyz", numbers(*axis))


def _closing(model: Tree.Element, robot: Robot, edge: Pair, k: int) -> None:
    # the child must not be ground
    first, second = edge.bodies
    parent, child = (second, first) if second == GROUND else (first, second)
    place = robot.local(child, robot.place(edge.point))
    _joint(model, edge.kind, f"loop:{k + 1}:{edge.name}", (parent, child), place=place)
