"""MJCF of MuJoCo: trees of bodies whose hinges are parallel, loops closed by equalities.

After the XML reference of MuJoCo (mujoco.readthedocs.io/en/stable/XMLreference.html).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import Assembly, Source
from linkwork.readers.robots import (
    Body,
    BodyJoint,
    Element,
    Planar,
    Pose,
    Weld,
    quaternion,
    turn_about,
    xml_tree,
)

TITLE, SUFFIXES = "MJCF (MuJoCo)", (".mjcf", ".xml")
_READ = ("compiler", "default", "worldbody", "equality", "actuator")
_DRAWN = ("size", "visual", "statistic", "asset")  # of pictures and buffers only


_FORCES = {
    "range": "limits", "damping": "damping", "stiffness": "stiffness", "frictionloss": "friction",
    "armature": "inertia of the rotor",
}  # fmt: skip


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    return re.search(r"<mujoco\b", head) is not None


def read(source: Source) -> Assembly:
    """Read the bodies of a world, and the equalities and actuators between them."""
    reader = _World(source, xml_tree(source.data, source, "mujoco"))
    return reader.planar().assembly


@dataclass
class _World:
    source: Source
    root: Element
    bodies: list[Body] = field(default_factory=list)
    joints: dict[str, str] = field(default_factory=dict)  # the body of each joint
    sites: dict[str, tuple[Body, Element]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        # sections of a kind are merged, the later one counts
        settings = {k: v for node in self.root.all("compiler") for k, v in node.attributes.items()}
        self.radians = 1.0 if settings.get("angle") == "radian" else math.pi / 180.0
        if settings.get("coordinate") == "global":
            self.source.refuse(
                'coordinate="global" is not read, as MuJoCo does not any more: write coordinates '
                "of the parent body",
                next(self.root.all("compiler")).line,
            )
        self.sequence = settings.get("eulerseq", "xyz")
        if not re.fullmatch("[xyzXYZ]{3}", self.sequence):
            self.source.refuse("eulerseq must be three of x, y, z")
        self.defaults: dict[str, dict[str, str]] = {"": {}}
        for node in self.root.all("default"):
            self._add_defaults(node, {})
        for node in self.root.children:
            if node.tag == "include":
                self.source.leave_out(node.place, "include: other files are not read")
            elif node.tag not in _READ + _DRAWN:
                self.source.leave_out(node.place, f"section <{node.tag[:20]}>")
        worlds = list(self.root.all("worldbody"))
        if not worlds:
            self.source.refuse("has no <worldbody>", self.root.line)
        pose = Pose(np.eye(3), np.zeros(3))
        ground = Body(name=GROUND, parent=GROUND, pose=pose, line=worlds[0].line)
        self.bodies.append(ground)
        for world in worlds:
            self._fill(ground, world, "")

    def _add_defaults(self, element: Element, above: dict[str, str]) -> None:
        joint = element.one("joint")
        defaults = {**above, **({} if joint is None else joint.attributes)}
        name = element.get("class", "main")
        self.defaults[name] = defaults
        # the first class applies to elements without one
        if name == "main":
            self.defaults[""] = defaults
        for inner in element.all("default"):
            self._add_defaults(inner, defaults)

    def _numbers(self, element: Element, key: str, count: int, default: str) -> list[float]:
        return self.source.numbers(element.get(key, default), count, key, element.line)

    def _turn(self, tag: Element) -> Array:
        if tag.get("quat"):
            w, x, y, z = self._numbers(tag, "quat", 4, "")
            return quaternion(w, x, y, z)
        if tag.get("axisangle"):
            *axis, angle = self._numbers(tag, "axisangle", 4, "")
            return turn_about(axis, angle * self.radians)
        if tag.get("euler"):
            turn = np.eye(3)
            for letter, angle in zip(
                self.sequence, self._numbers(tag, "euler", 3, ""), strict=True
            ):
                step = turn_about(np.eye(3)["xyz".index(letter.lower())], angle * self.radians)
                # small letters turn about moving axes
                turn = turn @ step if letter.islower() else step @ turn
            return turn
        for key in ("xyaxes", "zaxis"):
            if tag.get(key):
                self.source.refuse(f"{key} is not read: write quat, euler or axisangle", tag.line)
        return np.eye(3)

    def _fill(self, body: Body, element: Element, inherited: str) -> None:
        """The sites, the joint and the children of a body."""
        inherited = element.get("childclass", inherited)
        for child in element.children:
            place = child.place
            if child.tag == "site" and child.get("fromto"):
                self.source.leave_out(place, "site with fromto")
            elif child.tag == "site":
                name = child.get("name") or f"{body.name}_site{len(body.sites) + 1}"
                body.sites[name] = body.pose.place(self._numbers(child, "pos", 3, "0 0 0"))
                self.sites[name] = (body, child)
            elif child.tag in ("joint", "freejoint"):
                self._add_joint(body, child, inherited)
            elif child.tag == "body":
                self._add_body(body, child, inherited)
            elif child.tag == "inertial":
                self.source.leave_out(place, "mass of a body")
            elif child.tag == "geom":
                self.source.leave_out(place, "shape of a body")
            else:
                self.source.leave_out(place, f"element <{child.tag[:20]}>")

    def _add_body(self, parent: Body, element: Element, inherited: str) -> None:
        name = element.get("name") or f"body{len(self.bodies)}"
        if any(name == other.name for other in self.bodies):
            self.source.refuse(f'two bodies are called "{name[:40]}"', element.line)
        if len(self.bodies) > 400:
            self.source.refuse("has more than 400 bodies", element.line)
        pose = parent.pose.frame(self._numbers(element, "pos", 3, "0 0 0"), self._turn(element))
        body = Body(name=name, parent=parent.name, pose=pose, line=element.line)
        self.bodies.append(body)
        self._fill(body, element, inherited)
        if body.joint is None:
            # a rigid child is a point of its parent
            body.sites.setdefault(name, pose.at)

    def _add_joint(self, body: Body, element: Element, inherited: str) -> None:
        # a class of the joint itself comes before that of its body
        defaults = self.defaults.get(element.get("class", inherited), self.defaults[""])
        element = Element(element.tag, {**defaults, **element.attributes}, element.line)
        name = element.get("name") or f"joint{len(self.joints) + 1}"
        kind = "free" if element.tag == "freejoint" else element.get("type", "hinge")
        if kind not in ("hinge", "slide") or body.name == GROUND:
            self.source.refuse(f"a joint of type {kind[:20]} is not planar", element.line)
        if body.joint is not None:
            self.source.refuse(
                f'body "{body.name[:40]}" has two joints: only one is read', element.line
            )
        if name in self.joints:
            self.source.refuse(f'two joints are called "{name[:40]}"', element.line)
        axis = body.pose.turn @ np.array(self._numbers(element, "axis", 3, "0 0 1"))
        at = body.pose.place(self._numbers(element, "pos", 3, "0 0 0"))
        body.joint = BodyJoint(name=name, kind=kind, at=at, axis=axis)
        self.joints[name] = body.name
        for key, what in _FORCES.items():
            if element.get(key):
                self.source.leave_out(element.place, f"{what} of a joint")

    def planar(self) -> Planar:
        """The links, with loops and inputs; closures that no position meets are left out."""
        kept = list(self._equalities())
        while True:
            # notes of a trial are repeated in the final run
            planar = self._joined(kept, Source(self.source.data, self.source.name))
            closing = [element for element in kept if element.tag in ("weld", "connect")]
            if not (closing and planar.contradictory()):
                break
            what = f"<{closing[-1].tag}> that contradicts the lengths of the links"
            self.source.leave_out(f"line {closing[-1].line}", what)
            kept.remove(closing[-1])
        planar = self._joined(kept, self.source)
        planar.measure()
        self._drive(planar)
        return planar

    def _joined(self, equalities: list[Element], source: Source) -> Planar:
        welds = [self._weld(element) for element in equalities if element.tag == "weld"]
        # welds first: they decide which bodies are links
        planar = Planar(source, self.root.get("model"), self.bodies, welds)
        for element in equalities:
            if element.tag == "connect":
                self._connect(planar, element)
            elif element.tag != "weld":
                source.leave_out(element.place, f"coupling of joints <{element.tag[:20]}>")
        planar.add_sites()
        return planar

    def _equalities(self) -> Iterator[Element]:
        """The active ones; a file may have several sections."""
        for element in (element for each in self.root.all("equality") for element in each.children):
            if element.get("active") == "false":
                self.source.leave_out(element.place, f"inactive <{element.tag[:20]}>")
            else:
                yield element

    def _weld(self, element: Element) -> Weld:
        """The bodies of a weld, and the pose of the second."""
        if element.get("site1"):
            (one, _), (two, _) = sites = self._two_sites(element)
            first, second = (
                Pose(np.eye(3), np.zeros(3)).frame(
                    self._numbers(e, "pos", 3, "0 0 0"), self._turn(e)
                )
                for _, e in sites
            )
            turn = one.pose.turn @ first.turn @ second.turn.T
            pose = Pose(turn, one.pose.place(first.at) - turn @ second.at)
        else:
            one, two = self._two_bodies(element)
            *at, w, x, y, z = self._numbers(element, "relpose", 7, "0 1 0 0 0 0 0")
            # without a quaternion they stay as drawn
            pose = one.pose.frame(at, quaternion(w, x, y, z)) if any((w, x, y, z)) else two.pose
        return Weld(one=one.name, two=two.name, pose=pose, line=element.line)

    def _two_sites(self, element: Element) -> list[tuple[Body, Element]]:
        ends = [self.sites[n] for k in ("site1", "site2") if (n := element.get(k)) in self.sites]
        if len(ends) < 2:
            self.source.refuse(f"{element.tag} refers to a site that does not exist", element.line)
        return ends

    def _two_bodies(self, element: Element) -> list[Body]:
        known = {body.name: body for body in self.bodies}
        names = element.get("body1"), element.get("body2") or GROUND
        if not set(names) <= set(known):
            self.source.refuse(f"{element.tag} needs body1 and body2, or two sites", element.line)
        return [known[name] for name in names]

    def _connect(self, planar: Planar, element: Element) -> None:
        if element.get("site1"):
            names = element.get("site1"), element.get("site2")
            ends = [
                (body.name, body.sites[name])
                for name, (body, _) in zip(names, self._two_sites(element), strict=True)
            ]
        else:
            one, two = self._two_bodies(element)
            at = one.pose.place(self._numbers(element, "anchor", 3, "0 0 0"))
            ends = [(one.name, at), (two.name, at)]
        if planar.link(ends[0][0]) == planar.link(ends[1][0]):
            planar.source.leave_out(element.place, "connect inside one link")
        else:
            planar.pin(element.get("name") or f"{ends[0][0]}_{ends[1][0]}", *ends)

    def _drive(self, planar: Planar) -> None:
        for element in (element for each in self.root.all("actuator") for element in each.children):
            body = self.joints.get(element.get("joint"))
            joint = next((b.joint for b in self.bodies if b.name == body), None)
            if body is None or joint is None:
                self.source.leave_out(element.place, "actuator that drives no joint")
            elif joint.kind == "slide":
                self.source.leave_out(element.place, "the input: a slide without a range")
            else:
                link, on = planar.link(body), planar.link(planar.bodies[body].parent)
                # a body welded to the world drives the other side
                link, on = (on, link) if link == GROUND else (link, on)
                planar.assembly.drive(link, on)
        if not planar.assembly.inputs:
            self.source.leave_out("the file", "the input: no actuator drives a hinge")
