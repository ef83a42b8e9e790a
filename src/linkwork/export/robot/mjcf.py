"""MJCF: the tree as nested bodies, loops closed by equality constraints."""

from __future__ import annotations

import math
from xml.etree import ElementTree as Tree

from linkwork.export.robot.markup import WORLD, element, numbers, written
from linkwork.export.robot.robot import Robot
from linkwork.foundation.names import GROUND
from linkwork.mechanism.part.pairs import PairKind

__all__ = ["mjcf_of"]

_KINDS = {PairKind.PIN: "hinge", PairKind.SLIDE: "slide"}


def mjcf_of(robot: Robot) -> str:
    """Write a mechanism for MuJoCo, with its real loops."""
    root = Tree.Element("mujoco", model=robot.name)
    element(root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false")
    fall = robot.gravity()
    element(root, "option", gravity=numbers(fall.real, fall.imag, 0.0))
    places = {GROUND: element(root, "worldbody")}
    for point, place in robot.points(GROUND).items():
        _site(places[GROUND], GROUND, point, place)
    for joint in robot.tree.joints:
        position, angle = robot.mounted(joint)
        body = places[joint.child] = element(
            places[joint.parent],
            "body",
            name=joint.child,
            pos=numbers(position.real, position.imag, 0.0),
            quat=numbers(math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)),
        )
        inertia = robot.inertia(joint.child)
        element(
            body,
            "inertial",
            pos=numbers(inertia.center.real, inertia.center.imag, 0.0),
            mass=numbers(inertia.mass),
            diaginertia=numbers(*[inertia.inertia] * 3),
        )
        if joint.edge.kind in _KINDS:
            along = robot.axis(joint) if joint.edge.kind is PairKind.SLIDE else None
            axis = (0.0, 0.0, 1.0) if along is None else (along.real, along.imag, 0.0)
            kind = _KINDS[joint.edge.kind]
            element(body, "joint", name=joint.name, type=kind, axis=numbers(*axis))
        for point, place in robot.points(joint.child).items():
            _site(body, joint.child, point, place)
    _constraints(root, robot)
    driven = {name: joint for name, joint in robot.driven().items() if joint is not None}
    if driven:
        motors = element(root, "actuator")
        for name, joint in driven.items():
            own = "input" if len(robot.linkage.inputs) == 1 else f"input:{name}"
            element(motors, "motor", name=own, joint=joint.name)
    return written(root, robot.notes())


def _site(body: Tree.Element, name: str, point: str, place: complex) -> None:
    pos = numbers(place.real, place.imag, 0.0)
    element(body, "site", name=f"{name}/{point}", pos=pos, size="0.002")


def _constraints(root: Tree.Element, robot: Robot) -> None:
    """Pins and welds that close loops, and couplings of wheels as tendons of fixed length."""
    tree = robot.tree
    couplings = [(one, tree.ratios(one)) for one in tree.graph.couplings]
    if couplings:
        tendons = element(root, "tendon")
        for coupling, ratios in couplings:
            size = max(ratios.values(), key=abs)
            fixed = element(tendons, "fixed", name=coupling.name)
            for name, ratio in ratios.items():
                factor = robot.per_metre(name) * ratio / size
                element(fixed, "joint", joint=name, coef=numbers(factor))
    if not (tree.closing or couplings):
        return
    equality = element(root, "equality")
    for edge in tree.closing:
        # of welds MuJoCo takes the relative pose in the start position
        if edge.kind is PairKind.FIXED:
            own = (WORLD if body == GROUND else body for body in edge.bodies)
            element(equality, "weld", **dict(zip(("body1", "body2"), own, strict=True)))
        else:
            a, b = (f"{body}/{edge.point}" for body in edge.bodies)
            element(equality, "connect", site1=a, site2=b)
    for coupling, _ in couplings:
        element(equality, "tendon", tendon1=coupling.name)
