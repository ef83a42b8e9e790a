"""URDF: trees of links with parallel axes; joints that follow another one by ``mimic``.

After the specification at wiki.ros.org/urdf/XML. A tree has no loops: every joint is driven.
"""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.inputs import Input
from linkwork.readers.assembly import Assembly, Source
from linkwork.readers.robots import Body, BodyJoint, Element, Planar, Pose, turn_about, xml_tree

TITLE, SUFFIXES = "URDF", (".urdf",)
_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}
_ROWS = 72  # steps of the table: those of 5 degrees of a turn


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    return re.search(r"<robot\b", head) is not None


def read(source: Source) -> Assembly:
    """Read the tree."""
    root = xml_tree(source.data, source, "robot")
    tree = _Tree(source, root)
    planar = Planar(source, root.get("name"), tree.bodies)
    planar.add_sites()
    tree.drive(planar)
    return planar.assembly


class _Tree:
    def __init__(self, source: Source, root: Element) -> None:
        self.source = source
        self.links = {element.get("name"): element for element in root.all("link")}
        if len(self.links) < len(list(root.all("link"))) or "" in self.links:
            root.refuse("two links have the same name, or one has none")
        self.joints = list(root.all("joint"))
        names = [element.get("name") for element in self.joints]
        if len(set(names)) < len(names):
            root.refuse("two joints have the same name")
        for element in root.children:
            if element.tag not in ("link", "joint"):
                element.leave_out(f"element <{element.tag[:20]}>")
        self.bodies: list[Body] = []
        self._grow()
        for name in self.links:
            if name not in self.names:
                source.leave_out(f'link "{name[:40]}"', "it is not joined to the root")

    def _grow(self) -> None:
        """Bodies from the root on; the root is ground."""
        below: dict[str, list[Element]] = {}
        carried = set()
        for joint in self.joints:
            ends = [joint.one(tag) for tag in ("parent", "child")]
            parent, child = ("" if end is None else end.get("link") for end in ends)
            if parent not in self.links or child not in self.links or child in carried:
                joint.refuse("needs a parent and a child that no other joint carries")
            below.setdefault(parent, []).append(joint)
            carried.add(child)
        # the specification allows one root
        roots = [name for name in self.links if name not in carried]
        if not roots:
            reason = "every link is carried by a joint" if self.links else "it has no link"
            self.source.refuse(f"has no root: {reason}")
        if len(self.links) > 400:
            self.source.refuse("has more than 400 links")
        self.names = {roots[0]: GROUND}
        self.bodies.append(
            Body(name=GROUND, parent=GROUND, pose=Pose(np.eye(3), np.zeros(3)), line=1)
        )
        reached = [roots[0]]
        for parent in reached:  # grows meanwhile
            frame = next(b.pose for b in self.bodies if b.name == self.names[parent])
            reached += [self._add_child(joint, parent, frame) for joint in below.get(parent, [])]

    def _add_child(self, node: Element, parent: str, frame: Pose) -> str:
        child = node.one("child")
        assert child is not None  # checked
        name = child.get("link")
        self.names[name] = name if name != GROUND else f"{GROUND}_link"
        at, turn = self._origin(node)
        pose = frame.frame(at, turn)
        body = Body(name=self.names[name], parent=self.names[parent], pose=pose, line=node.line)
        kind = node.get("type")
        if kind in _KINDS:
            axis = node.one("axis")
            # the default of the specification
            local = [1.0, 0.0, 0.0] if axis is None else axis.numbers("xyz", 3, "1 0 0")
            along = pose.turn @ np.array(local)
            body.joint = BodyJoint(name=node.get("name"), kind=_KINDS[kind], at=pose.at, axis=along)
        elif kind != "fixed":
            node.refuse(f'a joint of type "{kind[:20]}" is not read')
        else:
            # a rigid child is a point of its parent
            body.sites[name] = pose.at
        self.bodies.append(body)
        for inner in self.links[name].children:
            if inner.tag == "inertial":
                # a link at the end of the tree has no second joint: this gives it a direction
                place, _ = self._origin(inner)
                body.sites[f"{name}_center"] = pose.place(place)
            what = "mass of a link" if inner.tag == "inertial" else "shape of a link"
            inner.leave_out(what)
        return name

    def _origin(self, element: Element) -> tuple[list[float], Array]:
        origin = element.one("origin")
        if origin is None:
            return [0.0, 0.0, 0.0], np.eye(3)
        at = origin.numbers("xyz", 3, "0 0 0")
        angles = origin.numbers("rpy", 3, "0 0 0")
        turn = np.eye(3)
        for axis, angle in zip(np.eye(3), angles, strict=True):  # about fixed axes
            turn = turn_about(axis, angle) @ turn
        return at, turn

    def drive(self, planar: Planar) -> None:
        """Drive every joint over its limits; mimic joints move in step."""
        bodies = {body.joint.name: body for body in self.bodies if body.joint is not None}
        for row in self.joints:
            body = bodies.get(row.get("name"))
            if body is None or body.joint is None:
                continue
            if row.one("coupling") is not None:
                row.leave_out("polynomial of a coupling")
            self._add_input(planar, body, body.joint, *self._moved(row))
        self.source.leave_out("the file", "loops: a tree has none, every joint is driven")

    def _moved(self, joint: Element, depth: int = 0) -> tuple[float, float]:
        """The range of a joint, or the range that follows from its leading joint."""
        mimic = joint.one("mimic")
        if mimic is None:
            return self._range(joint)
        leading = next((j for j in self.joints if j.get("name") == mimic.get("joint")), None)
        if leading is None:
            mimic.refuse("mimic refers to a joint that does not exist")
        if depth == len(self.joints):
            mimic.refuse("mimic joints follow each other in a circle")
        factor = mimic.number("multiplier", "1")
        offset = mimic.number("offset", "0")
        # inputs move in step, so that a straight line is exact
        low, high = self._moved(leading, depth + 1)
        return factor * low + offset, factor * high + offset

    def _range(self, element: Element) -> tuple[float, float]:
        limit = element.one("limit")
        if element.get("type") == "continuous" or limit is None:
            return 0.0, 2.0 * math.pi
        low = limit.number("lower", "0")
        return low, limit.number("upper", "0")

    def _add_input(
        self, planar: Planar, body: Body, joint: BodyJoint, low: float, high: float
    ) -> None:
        link, on = planar.link(body.name), planar.link(body.parent)
        # the angle of a link with one point is not known
        turning = (link, on) if joint.kind == "hinge" else ()
        known = (name == GROUND or len(planar.assembly.links[name]) > 1 for name in turning)
        if joint.name not in planar.points or not all(known):
            self.source.leave_out(f"line {body.line}", "the input of a link with one point")
            return
        if joint.kind == "slide":
            drives: dict[str, Any] = {"slider": planar.points[joint.name]}
            start, stop = low, high
        else:
            drives = {"link": link} if on == GROUND else {"link": link, "relative_to": on}
            # angles count about the normal of the plane
            sign = 1.0 if float(joint.axis @ planar.normal) > 0.0 else -1.0
            zero = planar.angle(link) - planar.angle(on)
            start, stop = (math.degrees(zero + sign * end) for end in (low, high))
        step = (stop - start) / _ROWS
        planar.assembly.inputs.append(Input(**drives, from_=start, to=stop, step=step or None))
