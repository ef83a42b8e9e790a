"""MJCF of MuJoCo: trees of bodies whose hinges are parallel, loops closed by equalities.

After the XML reference of MuJoCo (mujoco.readthedocs.io/en/stable/XMLreference.html).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

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
_BODY_PARTS = {"inertial": "mass of a body", "geom": "shape of a body"}
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
            next(self.root.all("compiler")).refuse(
                'coordinate="global" is not read, as MuJoCo does not any more: write coordinates '
                "of the parent body"
            )
        self.sequence = settings.get("eulerseq", "xyz")
        if not re.fullmatch("[xyzXYZ]{3}", self.sequence):
            self.source.refuse("eulerseq must be three of x, y, z")
        self.defaults: dict[str, dict[str, str]] = {"": {}}
        for node in self.root.all("default"):
            self._add_defaults(node, {})
        for node in self.root.children:
            if node.tag == "include":
                node.leave_out("include: other files are not read")
            elif node.tag not in _READ + _DRAWN:
                node.leave_out(f"section <{node.tag[:20]}>")
        worlds = list(self.root.all("worldbody"))
        if not worlds:
            self.root.refuse("has no <worldbody>")
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

    def _turn(self, tag: Element) -> Array:
        if tag.get("quat"):
            w, x, y, z = tag.numbers("quat", 4)
            return quaternion(w, x, y, z)
        if tag.get("axisangle"):
            *axis, angle = tag.numbers("axisangle", 4)
            return turn_about(axis, angle * self.radians)
        if tag.get("euler"):
            turn = np.eye(3)
            for letter, angle in zip(self.sequence, tag.numbers("euler", 3), strict=True):
                step = turn_about(np.eye(3)["xyz".index(letter.lower())], angle * self.radians)
                # small letters turn about moving axes
                turn = turn @ step if letter.islower() else step @ turn
            return turn
        for key in ("xyaxes", "zaxis"):
            if tag.get(key):
                tag.refuse(f"{key} is not read: write quat, euler or axisangle")
        return np.eye(3)

    def _fill(self, body: Body, element: Element, inherited: str) -> None:
        """The sites, the joint and the children of a body."""
        inherited = element.get("childclass", inherited)
        for child in element.children:
            if child.tag == "site" and child.get("fromto"):
                child.leave_out("site with fromto")
            elif child.tag == "site":
                name = child.get("name") or f"{body.name}_site{len(body.sites) + 1}"
                body.sites[name] = body.pose.place(child.numbers("pos", 3, "0 0 0"))
                self.sites[name] = (body, child)
            elif child.tag in ("joint", "freejoint"):
                self._add_joint(body, child, inherited)
            elif child.tag == "body":
                self._add_body(body, child, inherited)
            else:
                child.leave_out(_BODY_PARTS.get(child.tag, f"element <{child.tag[:20]}>"))

    def _add_body(self, parent: Body, element: Element, inherited: str) -> None:
        name = element.get("name") or f"body{len(self.bodies)}"
        if any(name == other.name for other in self.bodies):
            element.refuse(f'two bodies are called "{name[:40]}"')
        if len(self.bodies) > 400:
            element.refuse("has more than 400 bodies")
        pose = parent.pose.frame(element.numbers("pos", 3, "0 0 0"), self._turn(element))
        body = Body(name=name, parent=parent.name, pose=pose, line=element.line)
        self.bodies.append(body)
        self._fill(body, element, inherited)
        if body.joint is None:
            # a rigid child is a point of its parent
            body.sites.setdefault(name, pose.at)

    def _add_joint(self, body: Body, element: Element, inherited: str) -> None:
        # a class of the joint itself comes before that of its body
        defaults = self.defaults.get(element.get("class", inherited), self.defaults[""])
        element = replace(element, attributes={**defaults, **element.attributes})
        name = element.get("name") or f"joint{len(self.joints) + 1}"
        kind = "free" if element.tag == "freejoint" else element.get("type", "hinge")
        if kind not in ("hinge", "slide") or body.name == GROUND:
            element.refuse(f"a joint of type {kind[:20]} is not planar")
        if body.joint is not None:
            element.refuse(f'body "{body.name[:40]}" has two joints: only one is read')
        if name in self.joints:
            element.refuse(f'two joints are called "{name[:40]}"')
        axis = body.pose.turn @ np.array(element.numbers("axis", 3, "0 0 1"))
        at = body.pose.place(element.numbers("pos", 3, "0 0 0"))
        body.joint = BodyJoint(name=name, kind=kind, at=at, axis=axis)
        self.joints[name] = body.name
        for key, what in _FORCES.items():
            if element.get(key):
                element.leave_out(f"{what} of a joint")

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
            closing[-1].leave_out(what)
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
                element.leave_out(f"coupling of joints <{element.tag[:20]}>")
        planar.add_sites()
        return planar

    def _equalities(self) -> Iterator[Element]:
        """The active ones; a file may have several sections."""
        for element in (element for each in self.root.all("equality") for element in each.children):
            if element.get("active") == "false":
                element.leave_out(f"inactive <{element.tag[:20]}>")
            else:
                yield element

    def _weld(self, element: Element) -> Weld:
        """The bodies of a weld, and the pose of the second."""
        if element.get("site1"):
            (one, _), (two, _) = sites = self._two_sites(element)
            first, second = (
                Pose(np.eye(3), np.zeros(3)).frame(e.numbers("pos", 3, "0 0 0"), self._turn(e))
                for _, e in sites
            )
            turn = one.pose.turn @ first.turn @ second.turn.T
            pose = Pose(turn, one.pose.place(first.at) - turn @ second.at)
        else:
            one, two = self._two_bodies(element)
            *at, w, x, y, z = element.numbers("relpose", 7, "0 1 0 0 0 0 0")
            # without a quaternion they stay as drawn
            pose = one.pose.frame(at, quaternion(w, x, y, z)) if any((w, x, y, z)) else two.pose
        return Weld(one=one.name, two=two.name, pose=pose, line=element.line)

    def _two_sites(self, element: Element) -> list[tuple[Body, Element]]:
        ends = [self.sites[n] for k in ("site1", "site2") if (n := element.get(k)) in self.sites]
        if len(ends) < 2:
            element.refuse(f"{element.tag} refers to a site that does not exist")
        return ends

    def _two_bodies(self, element: Element) -> list[Body]:
        known = {body.name: body for body in self.bodies}
        names = element.get("body1"), element.get("body2") or GROUND
        if not set(names) <= set(known):
            element.refuse(f"{element.tag} needs body1 and body2, or two sites")
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
            at = one.pose.place(element.numbers("anchor", 3, "0 0 0"))
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
                element.leave_out("actuator that drives no joint")
            elif joint.kind == "slide":
                element.leave_out("the input: a slide without a range")
            else:
                link, on = planar.link(body), planar.link(planar.bodies[body].parent)
                # a body welded to the world drives the other side
                link, on = (on, link) if link == GROUND else (link, on)
                planar.assembly.drive(link, on)
        if not planar.assembly.inputs:
            self.source.leave_out("the file", "the input: no actuator drives a hinge")
