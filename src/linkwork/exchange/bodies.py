"""Bodies of robots in space whose motion is planar, as links: shared by MJCF and URDF."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from linkwork.exchange.assembly import Assembly
from linkwork.exchange.source import Source
from linkwork.foundation.arrays import Array
from linkwork.foundation.names import GROUND

__all__ = ["Body", "BodyJoint", "Planar", "Pose", "quaternion", "turn_about"]

_PARALLEL = 1e-6  # of unit vectors
_NEAR = 1e-9  # of the size of the mechanism


@dataclass(frozen=True)
class Pose:
    """A rotation (3, 3) and a place (3,) in the frame of the world."""

    turn: Array
    at: Array

    def place(self, local: Iterable[float]) -> Array:
        """A place of this frame in the world, (3,)."""
        place: Array = self.at + self.turn @ np.array(list(local))
        return place

    def frame(self, local: Iterable[float], turn: Array) -> Pose:
        """A frame inside this one."""
        return Pose(self.turn @ turn, self.place(local))


def turn_about(axis: Iterable[float], angle: float) -> Array:
    """The rotation about an axis [rad], (3, 3), by Rodrigues' formula."""
    x, y, z = _unit(np.array(list(axis)))
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
    return turned


def quaternion(w: float, x: float, y: float, z: float) -> Array:
    """The rotation of a quaternion, (3, 3)."""
    size = math.hypot(x, y, z)
    return np.eye(3) if size == 0.0 else turn_about((x, y, z), 2.0 * math.atan2(size, w))


def _unit(vector: Array) -> Array:
    # scaled first, so that squares of large numbers stay finite
    largest = float(np.abs(vector).max())
    scaled = vector / largest if largest > 0.0 else vector
    length = math.sqrt(float(scaled @ scaled))
    return scaled / length if length > 0.0 else scaled


@dataclass(frozen=True, kw_only=True)
class BodyJoint:
    """The joint that carries a body: ``kind`` hinge or slide, in the frame of the world."""

    name: str
    kind: str
    at: Array
    axis: Array


@dataclass(kw_only=True)
class Body:
    """A body of the tree with named places; without a joint it is fixed on its parent."""

    name: str
    parent: str
    pose: Pose
    line: int
    joint: BodyJoint | None = None
    sites: dict[str, Array] = field(default_factory=dict)


class Planar:
    """Bodies projected on the plane that is normal to their hinges.

    ``links`` and ``points`` give the link of a body and the point of a joint.
    """

    def __init__(self, source: Source, name: str, bodies: list[Body], same: dict[str, str]) -> None:
        self.source, self.assembly = source, Assembly(source, name)
        self.assembly.length = "m"
        self.bodies = {body.name: body for body in bodies}
        self._same = same
        self._basis(bodies)
        self.links: dict[str, str] = {}
        self.points: dict[str, str] = {}
        places = [self.at(place) for body in bodies for place in self._places(body)]
        self.size = max((abs(p - places[0]) for p in places), default=0.0) or 1.0
        for body in bodies:
            if self.root(body.name) == body.name and body.name != GROUND:
                self.links[body.name] = self.assembly.add_link(body.name)
        for body in bodies:
            if body.joint is not None:
                self._join(body, body.joint)

    def _places(self, body: Body) -> Iterable[Array]:
        return [*body.sites.values(), *([body.joint.at] if body.joint else [body.pose.at])]

    def root(self, body: str) -> str:
        """The body that this one is fixed on."""
        # welds in a circle must end
        seen = set()
        while body not in seen and body != GROUND:
            seen.add(body)
            if body in self._same:
                body = self._same[body]
            elif self.bodies[body].joint is None:
                body = self.bodies[body].parent
        return body

    def link(self, body: str) -> str:
        """The link of a body, or ground."""
        root = self.root(body)
        return GROUND if root == GROUND else self.links[root]

    def _basis(self, bodies: list[Body]) -> None:
        """The plane: its normal is the axis of the hinges; axes of slides lie in it."""
        joints = [(body, body.joint) for body in bodies if body.joint is not None]
        hinges = [joint.axis for _, joint in joints if joint.kind == "hinge"]
        if not joints:
            self.source.refuse("has no joint that moves")
        # slides alone do not fix a plane: that of x and y is taken
        axis = hinges[0] if hinges else np.array([0.0, 0.0, 1.0])
        normal = _unit(axis)
        # the x axis of the world, or y, as far as it lies in the plane
        first = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
        self.first = _unit(first - (first @ normal) * normal)
        second = np.cross(normal, self.first)
        # with z upwards, a mechanism in the plane x-z is not upside down
        flip = -1.0 if second[int(np.abs(second).argmax())] < 0.0 else 1.0
        self.second, self.normal = flip * second, flip * normal
        for body, joint in joints:
            along = abs(float(_unit(joint.axis) @ self.normal))
            wrong = along < 1.0 - _PARALLEL if joint.kind == "hinge" else along > _PARALLEL
            if wrong or not np.any(joint.axis):
                self.source.refuse(
                    f'joint "{joint.name[:40]}" does not move in one plane with the others: only '
                    "planar mechanisms are read",
                    body.line,
                )

    def at(self, place: Array) -> complex:
        """A place in the plane."""
        return complex(float(place @ self.first), float(place @ self.second))

    def _join(self, body: Body, joint: BodyJoint) -> None:
        # a weld elsewhere may have joined both sides
        own, on = self.link(body.name), self.link(body.parent)
        if own == on:
            self.source.leave_out(f"line {body.line}", f'joint "{joint.name[:40]}" inside one link')
            return
        if joint.kind == "hinge":
            self.points[joint.name] = self.pin(joint.name, joint.at, body.parent, body.name)
            return
        point = self.pin(joint.name, joint.at, body.name)
        along = complex(float(joint.axis @ self.first), float(joint.axis @ self.second))
        line = self.assembly.guide(on, point, along)
        slide = self.assembly.add_slider(joint.name.partition(":")[0], own, point, on, line)
        self.points[joint.name] = slide

    def pin(self, name: str, place: Array, *bodies: str) -> str:
        """A point of bodies: one that a body has there, or a new one, called like a site there."""
        at, links = self.at(place), [self.link(body) for body in bodies]
        near = _NEAR * self.size
        # two pins at one place are one pin of three links
        known = (p for link in links for p in sorted(self.assembly.carries(link)))
        point = next((p for p in known if abs(self.assembly.points[p] - at) <= near), None)
        if point is None:
            sites = (item for body in bodies for item in self.bodies[body].sites.items())
            wanted = next((s for s, where in sites if abs(self.at(where) - at) <= near), name)
            point = self.assembly.add_point(wanted.rpartition("/")[2].partition(":")[0], at)
        for link in links:
            self.assembly.put_on(link, point)
        return point

    def add_sites(self) -> None:
        """Points of links at sites where no joint is."""
        for body in self.bodies.values():
            for name, place in body.sites.items():
                self.pin(name, place, body.name)

    def angle(self, link: str) -> float:
        """The direction of a link as drawn [rad]; 0 of ground."""
        if link == GROUND:
            return 0.0
        a, b = (self.assembly.points[point] for point in self.assembly.links[link][:2])
        return math.atan2((b - a).imag, (b - a).real)
