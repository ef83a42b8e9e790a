"""XML as a tree of elements with their lines: no document types, no entities, nothing external."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import NoReturn
from xml.parsers import expat

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.lanes import phase
from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import Assembly, Source

_DEEPEST = 100
_MOST = 50_000


@dataclass(frozen=True)
class Element:
    """An element of a source, its attributes and line; texts between elements are not kept."""

    source: Source
    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    @property
    def place(self) -> str:
        """Where it is, for notes."""
        return f"line {self.line}"

    def leave_out(self, what: str) -> None:
        """Note that it, or a part of it, is not carried over."""
        self.source.leave_out(self.place, what)

    def refuse(self, message: str) -> NoReturn:
        """Refuse the file for it; raises as :meth:`Source.refuse`."""
        self.source.refuse(message, self.line)

    def get(self, name: str, default: str = "") -> str:
        """An attribute."""
        return self.attributes.get(name, default)

    def number(self, name: str, default: str = "") -> float:
        """An attribute that is a finite number."""
        return self.source.number(self.get(name, default), name, self.line)

    def numbers(self, name: str, count: int, default: str = "") -> list[float]:
        """An attribute of so many numbers."""
        return self.source.numbers(self.get(name, default), count, name, self.line)

    def all(self, tag: str) -> Iterator[Element]:
        """The children with a tag."""
        return (child for child in self.children if child.tag == tag)

    def one(self, tag: str) -> Element | None:
        """The first child with a tag."""
        return next(self.all(tag), None)


def xml_tree(data: bytes, source: Source, *roots: str) -> Element:
    """The root of an XML document.

    Raises
    ------
    MechanismFileError
        If it is not well-formed, has a document type or another root, or is too deep or too long.
    """
    parser = expat.ParserCreate()
    top = Element(source, "", {}, 1)
    nested, count = [top], itertools.count(1)

    def refuse(message: str) -> NoReturn:
        source.refuse(message, parser.CurrentLineNumber)

    def start(tag: str, attributes: dict[str, str]) -> None:
        # readers descend by recursion
        if len(nested) > _DEEPEST:
            refuse(f"has elements nested deeper than {_DEEPEST} levels")
        if next(count) > _MOST:
            refuse(f"has more than {_MOST} elements")
        element = Element(source, tag, attributes, parser.CurrentLineNumber)
        nested[-1].children.append(element)
        nested.append(element)

    # entities are declared in a document type only: without it none can expand
    parser.StartDoctypeDeclHandler = lambda *_: refuse(
        "has a document type (DOCTYPE): entities are not read, remove it"
    )
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: nested.pop()
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        what = expat.ErrorString(error.code)
        source.refuse(f"is not XML: {what} (column {error.offset + 1})", error.lineno)
    except (ValueError, LookupError):  # encodings that Python does not have
        source.refuse("is in an encoding that is not read: save it as UTF-8", 1)
    root = top.children[0]
    if root.tag not in roots:
        expected = " or ".join(f"<{tag}>" for tag in roots)
        root.refuse(f"begins with <{root.tag[:40]}>, expected {expected}")
    return root


# ----------------------------------------------------------------------
# Bodies of robots in space whose motion is planar, as links: shared by MJCF and URDF.


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


@dataclass(frozen=True, kw_only=True)
class Weld:
    """Two bodies that are one: the second has this pose in the world where the first is drawn."""

    one: str
    two: str
    pose: Pose
    line: int


#: A rotation (of size 1) and a translation in the plane.
_Move = tuple[complex, complex]


class Planar:
    """Bodies projected on the plane that is normal to their hinges.

    ``links`` and ``points`` give the link of a body and the point of a joint; ``spots`` the places
    of the points of every link in the pose in which its first body is drawn. Where links do not
    meet as drawn, their points are a sketch and the lengths are exact.
    """

    def __init__(
        self, source: Source, name: str, bodies: list[Body], welds: Iterable[Weld] = ()
    ) -> None:
        self.source, self.assembly = source, Assembly(source, name)
        self.assembly.length = "m"
        self.bodies = {body.name: body for body in bodies}
        self._same: dict[str, tuple[str, _Move]] = {}
        self._basis(bodies)
        self.links: dict[str, str] = {}
        self.points: dict[str, str] = {}
        self._slides: list[tuple[str, str, complex, bool]] = []
        places = [self.at(place) for body in bodies for place in self._points_of(body)]
        self.size = max((abs(p - places[0]) for p in places), default=0.0) or 1.0
        for weld in welds:
            self._weld(weld)
        for body in bodies:
            if self._placed(body.name)[0] == body.name and body.name != GROUND:
                self.links[body.name] = self.assembly.add_link(body.name)
        self.spots: dict[str, dict[str, complex]] = {n: {} for n in (GROUND, *self.links.values())}
        for body in bodies:
            if body.joint is not None:
                self._join(body, body.joint)

    def _points_of(self, body: Body) -> Iterable[Array]:
        return [*body.sites.values(), *([body.joint.at] if body.joint else [body.pose.at])]

    def _weld(self, weld: Weld) -> None:
        """Make two bodies one: ground stays, otherwise the first."""
        drawn = self.bodies[weld.two].pose
        turn = weld.pose.turn @ drawn.turn.T
        if float((turn @ self.normal) @ self.normal) < 1.0 - _PARALLEL:
            self.source.leave_out(f"line {weld.line}", "weld that turns a body out of the plane")
            return
        rotation = self.at(turn @ self.first)
        shift = self.at(weld.pose.at) - rotation * self.at(drawn.at)
        (kept, first), (lost, second) = self._placed(weld.one), self._placed(weld.two)
        move = _after(_after(first, (rotation / abs(rotation), shift)), _back(second))
        if abs(move[0] - 1.0) <= _NEAR and abs(move[1]) <= _NEAR * self.size:
            move = (1.0 + 0j, 0j)
        if lost == GROUND:
            kept, lost, move = lost, kept, _back(move)
        if kept != lost:
            self._same[lost] = kept, move
        elif move != (1.0, 0.0):
            self.source.leave_out(f"line {weld.line}", "weld that contradicts other welds")

    def _placed(self, body: str) -> tuple[str, _Move]:
        """The body that this one is fixed on, and its movement from where it is drawn to there."""
        move: _Move = (1.0 + 0j, 0j)
        while body != GROUND:
            if body in self._same:
                body, moved = self._same[body]
                move = _after(moved, move)
            elif self.bodies[body].joint is None:
                body = self.bodies[body].parent
            else:
                break
        return body, move

    def spot(self, body: str, place: Array) -> complex:
        """A place of a body in the pose of its link."""
        rotation, shift = self._placed(body)[1]
        return rotation * self.at(place) + shift

    def link(self, body: str) -> str:
        """The link of a body, or ground."""
        root = self._placed(body)[0]
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
        link, on = self.link(body.name), self.link(body.parent)
        if link == on:
            self.source.leave_out(f"line {body.line}", f'joint "{joint.name[:40]}" inside one link')
            return
        if joint.kind == "hinge":
            self.points[joint.name] = self.pin(
                joint.name, (body.parent, joint.at), (body.name, joint.at)
            )
            return
        point = self.pin(joint.name, (body.name, joint.at))
        along = complex(float(joint.axis @ self.first), float(joint.axis @ self.second))
        turns = [self._placed(each)[1][0] for each in (body.parent, body.name)]
        at = self.spot(body.parent, joint.at)
        line = self.assembly.guide(on, point, turns[0] * along, at)
        self.spots[on].update({end: self.assembly.points[end] for end in line})
        slide = self.assembly.add_slider(joint.name.partition(":")[0], link, point, on, line)
        self.points[joint.name] = slide
        self._slides.append((slide, link, turns[1] * along, turns != [1.0, 1.0]))

    def pin(self, name: str, *ends: tuple[str, Array]) -> str:
        """A point at places of bodies: one that is there, or a new one, called like a site."""
        # the place of a point on ground is exact
        pinned = sorted(
            ((self.link(body), self.spot(body, at), body) for body, at in ends),
            key=lambda end: end[0] != GROUND,
        )
        near = _NEAR * self.size
        # two pins at one place are one pin of three links
        known = [
            p
            for link, at, _ in pinned
            for p, q in sorted(self.spots[link].items())
            if abs(q - at) <= near
        ]
        known.sort(key=lambda point: point not in self.assembly.fixed)
        if not known:
            sites = ((s, b, at, p) for _, at, b in pinned for s, p in self.bodies[b].sites.items())
            site = next((s for s, b, at, p in sites if abs(self.spot(b, p) - at) <= near), name)
            spots = [at for _, at, _ in pinned]
            # between the places of two links that do not meet: neither is more right
            middle = spots[0] if pinned[0][0] == GROUND else sum(spots) / len(spots)
            at = spots[0] if max(abs(p - spots[0]) for p in spots) <= near else middle
            known.append(self.assembly.add_point(site.rpartition("/")[2].partition(":")[0], at))
        point = known[0]
        for link, at, _ in pinned:
            self.assembly.put_on(link, point)
            self.spots[link].setdefault(point, at)
        place = self.spots[GROUND].get(point, self.assembly.points[point])
        # points of one link at one place become one
        self.assembly.points.update(dict.fromkeys(known, place))
        return point

    def add_sites(self) -> None:
        """Points of links at sites where no joint is."""
        for body in self.bodies.values():
            for name, place in body.sites.items():
                self.pin(name, (body.name, place))

    def contradictory(self) -> bool:
        """Whether two links, or ground and a link, share two points at different distances."""
        distances: dict[frozenset[str], float] = {}
        for spots in self.spots.values():
            for a, b in itertools.combinations(spots, 2):
                distance = abs(spots[a] - spots[b])
                known = distances.setdefault(frozenset((a, b)), distance)
                if abs(known - distance) > _NEAR * self.size:
                    return True
        return False

    def measure(self) -> None:
        """Give the exact dimensions of the links whose points are drawn elsewhere."""
        drawn, near = self.assembly.points, _NEAR * self.size
        for link, points in self.assembly.links.items():
            spots, first = self.spots[link], next(iter(points), "")
            # points at one place are joined
            rest = [p for p in points if abs(spots[p] - spots[first]) > near]
            if not rest:
                continue
            base = spots[rest[0]] - spots[first]
            moved = any(
                abs(abs(spots[a] - spots[b]) - abs(drawn[a] - drawn[b])) > near
                for a, b in itertools.combinations(spots, 2)
            )
            if moved:
                self._follow(link, spots)
            for point in rest if moved else ():
                arm = spots[point] - spots[first]
                self.assembly.lengths[f"{first} {point}"] = abs(arm)
                if point != rest[0]:
                    angle = math.degrees(phase(arm / base))
                    self.assembly.angles[f"{rest[0]} {first} {point}"] = angle
            angles = {
                slide: math.degrees(phase(base / along))
                for slide, sliding, along, turned in self._slides
                if sliding == link and (moved or turned)
            }
            self.assembly.parts["sliders"] = [
                replace(part, angle=angles.get(part.name))
                for part in self.assembly.parts["sliders"]
            ]

    def _follow(self, link: str, spots: dict[str, complex]) -> None:
        """Move the points that belong to this link alone along with its other points."""
        drawn = self.assembly.points
        shared = [p for p in spots if len(self.assembly.carriers(p)) > 1]
        # a link that meets no other is drawn as it is
        first, second = (shared[0], shared[-1]) if shared else ("", "")
        for point in spots if shared else ():
            if point not in shared:
                arm = (drawn[second] - drawn[first]) * (spots[second] - spots[first]).conjugate()
                turn = arm / abs(arm) if arm else 1.0
                drawn[point] = drawn[first] + turn * (spots[point] - spots[first])

    def angle(self, link: str) -> float:
        """The direction of a link as drawn [rad]; 0 of ground."""
        if link == GROUND:
            return 0.0
        a, b = (self.assembly.points[point] for point in self.assembly.links[link][:2])
        return math.atan2((b - a).imag, (b - a).real)


def _after(second: _Move, first: _Move) -> _Move:
    """The first movement, then the second."""
    return second[0] * first[0], second[0] * first[1] + second[1]


def _back(move: _Move) -> _Move:
    return move[0].conjugate(), -move[0].conjugate() * move[1]
