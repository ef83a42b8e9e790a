"""URDF: the tree; joints follow the driven one by ``mimic``, their polynomials are stated."""

from __future__ import annotations

import math
from xml.etree import ElementTree as Tree

from linkwork.export.robot.coupling_polynomial import Couplings, JointPolynomial, couplings_of
from linkwork.export.robot.joint_tree import TreeJoint
from linkwork.export.robot.markup import element, numbers, written
from linkwork.export.robot.robot import Robot
from linkwork.foundation.names import GROUND
from linkwork.mechanism.part.pairs import PairKind
from linkwork.results.motion import Motion

__all__ = ["urdf_of"]

_NEAR = 1e-9  # rad or m
_FASTEST, _STRONGEST = "100.0", "1000.0"  # URDF demands both limits


def urdf_of(robot: Robot, motion: Motion) -> str:
    """Write a mechanism as a tree without loops.

    Raises
    ------
    InputError
        If the joints cannot follow one driven joint.
    """
    couplings = couplings_of(robot, motion)
    root = Tree.Element("robot", name=robot.name)
    element(root, "link", name=GROUND)
    for joint in robot.tree.joints:
        _link(root, robot, joint)
        _joint(root, robot, joint, couplings)
    for name, own in couplings.joints.items():
        _polynomial(root, name, own, couplings)
    others = [j.name for j in robot.driven().values() if j not in (None, couplings.leading)]
    step = f"Driven as well, here in step with it as in the table: {', '.join(others)}."
    return written(root, [*robot.notes(), *_notes(couplings), *([step] if others else [])])


def _notes(couplings: Couplings) -> list[str]:
    low, high = couplings.limits
    ends = ["dead point" if stop else "end of the table" for stop in couplings.stopped]
    lines = [
        "URDF has no loops: joints follow the driven one; mimic is a straight line.",
        "Each element coupling has the true relation: coefficients c_k of Chebyshev polynomials",
        "T_k(s) of s = (2 x - low - high)/(high - low), x the value of the driven joint;",
        "error and mimic_error are the largest differences, estimated between table rows.",
        f"Driven joint: {couplings.leading.name} from {low:.9g} ({ends[0]}) to {high:.9g} "
        f"({ends[1]}).",
        "Limits of effort and velocity are placeholders.",
    ]
    if not low <= _NEAR or not high >= -_NEAR:
        lines.append("The start position is not between these limits.")
    return lines


def _link(root: Tree.Element, robot: Robot, joint: TreeJoint) -> None:
    own = robot.inertia(joint.child)
    inertial = element(element(root, "link", name=joint.child), "inertial")
    element(inertial, "origin", xyz=numbers(own.center.real, own.center.imag, 0.0), rpy="0 0 0")
    element(inertial, "mass", value=numbers(own.mass))
    diagonal = dict.fromkeys(("ixx", "iyy", "izz"), numbers(own.inertia))
    element(inertial, "inertia", **diagonal, ixy="0", ixz="0", iyz="0")


def _joint(root: Tree.Element, robot: Robot, joint: TreeJoint, couplings: Couplings) -> None:
    leads = joint.name == couplings.leading.name
    low, high = couplings.limits
    kind = {PairKind.FIXED: "fixed", PairKind.PIN: "revolute", PairKind.SLIDE: "prismatic"}
    whole = leads and not any(couplings.stopped) and high - low >= 2.0 * math.pi - 1e-9
    turns = whole and joint.edge.kind is PairKind.PIN
    own = element(
        root, "joint", name=joint.name, type="continuous" if turns else kind[joint.edge.kind]
    )
    place, angle = robot.mounted(joint)
    element(own, "origin", xyz=numbers(place.real, place.imag, 0.0), rpy=numbers(0, 0, angle))
    element(own, "parent", link=joint.parent)
    element(own, "child", link=joint.child)
    if joint.edge.kind is PairKind.FIXED:
        return
    along = robot.axis(joint) if joint.edge.kind is PairKind.SLIDE else None
    axis = (0.0, 0.0, 1.0) if along is None else (along.real, along.imag, 0.0)
    element(own, "axis", xyz=numbers(*axis))
    if not leads:
        low, high = couplings.joints[joint.name].range
    ends = {} if turns else {"lower": numbers(low), "upper": numbers(high)}
    element(own, "limit", **ends, effort=_STRONGEST, velocity=_FASTEST)
    if not leads:
        factor, offset = couplings.joints[joint.name].line
        leader = couplings.leading.name
        element(own, "mimic", joint=leader, multiplier=numbers(factor), offset=numbers(offset))


def _polynomial(root: Tree.Element, name: str, own: JointPolynomial, couplings: Couplings) -> None:
    low, high = own.series.domain.tolist()
    element(
        root,
        "coupling",
        numbers(*own.series.coef.tolist()),
        joint=name,
        driven=couplings.leading.name,
        low=numbers(low),
        high=numbers(high),
        error=f"{own.error:.3e}",
        mimic_error=f"{own.line_error:.3e}",
    )
