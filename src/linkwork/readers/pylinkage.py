"""pylinkage JSON: linkages of joints with parents, and mechanisms of joints and links.

After ``linkage/serialization.py`` and ``mechanism/serialization.py`` of
github.com/HugoFara/pylinkage.
"""

from __future__ import annotations

import json
import math
import re
from typing import Any, NoReturn

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import Assembly, Drawn, Source

TITLE, SUFFIXES = "pylinkage JSON", (".json",)
_STEP = "angle of a step or speed of the input: pylinkage states no time"


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    return (
        head.lstrip().startswith("{")
        and re.search(r'"(joints|links|solve_order)"', head) is not None
    )


def read(source: Source) -> Assembly:
    """Read a linkage or a mechanism."""
    data = _data(source)
    joints = _tables(source, data, "joints")
    for key in data:
        if key not in ("name", "joints", "links", "solve_order", "ground"):
            source.leave_out(f'"{key[:40]}"', "unknown key")
    name = data.get("name")
    assembly = Assembly(source, name if isinstance(name, str) else "")
    assembly.length = "unit"
    if "links" in data:
        _Mechanism(assembly, joints).add(_tables(source, data, "links"))
    else:
        _Parents(assembly, joints).add()
    return assembly


def _data(source: Source) -> dict[str, Any]:
    def pairs(entries: list[tuple[str, Any]]) -> dict[str, Any]:
        # the last of two equal keys would win unseen
        table = dict(entries)
        if len(table) < len(entries):
            source.refuse("gives a key twice in one object")
        return table

    def constant(word: str) -> NoReturn:
        source.refuse(f"contains {word}: numbers must be finite")

    try:
        data = json.loads(source.text(), object_pairs_hook=pairs, parse_constant=constant)
    except json.JSONDecodeError as error:
        source.refuse(f"is not JSON: {error.msg.lower()} (column {error.colno})", error.lineno)
    except (RecursionError, ValueError):
        source.refuse("is nested too deeply, or has a number that is too long")
    if not isinstance(data, dict):
        source.refuse("must be an object with joints")
    return data


def _tables(source: Source, data: dict[str, Any], key: str) -> list[dict[str, Any]]:
    entries = data.get(key)
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        source.refuse("must be a list of objects", key=(key,))
    return entries


class _Reading:
    """What both forms share: points by name."""

    def __init__(self, assembly: Assembly, joints: list[dict[str, Any]]) -> None:
        self.assembly, self.source, self.joints = assembly, assembly.source, joints
        self.points: dict[str, str] = {}

    def refuse(self, key: str, k: int, message: str) -> NoReturn:
        self.source.refuse(message, key=(key, k))

    def named(self, entry: dict[str, Any], key: str, table: str, k: int) -> str:
        name = entry.get(key)
        if not isinstance(name, str) or not name:
            self.refuse(table, k, f"needs {key}, a text")
        return name

    def add_point(self, name: str, k: int, x: object, y: object, fixed: bool) -> str:
        if name in self.points:
            self.refuse("joints", k, f'"{name[:40]}" is the name of two joints')
        place = f"a coordinate of joints[{k}]"
        self.points[name] = self.assembly.add_point(name, self.source.point(x, y, place), fixed)
        return self.points[name]

    def size(self, entry: dict[str, Any], key: str, k: int) -> float | None:
        value = entry.get(key)
        return None if value is None else self.source.number(value, f"{key} of joints[{k}]")


class _Parents(_Reading):
    """Joints that name the joints from which they are solved: Static, Crank, Revolute, Fixed, …"""

    def add(self) -> None:
        """Add all joints: points first, since they may refer to later ones."""
        for k, entry in enumerate(self.joints):
            name, kind = self.named(entry, "name", "joints", k), entry.get("type")
            if not isinstance(kind, str) or kind not in _PARENTS:
                self.refuse("joints", k, f"has an unknown type {str(kind)[:40]!r}")
            self.add_point(name, k, entry.get("x"), entry.get("y"), kind == "Static")
        for k, entry in enumerate(self.joints):
            _PARENTS[entry["type"]](self, entry, k, self.points[entry["name"]])

    def parent(self, entry: dict[str, Any], key: str, k: int) -> str:
        """The point of a parent: by name, or at a fixed place."""
        parent = entry.get(key)
        if not isinstance(parent, dict):
            self.refuse("joints", k, f"needs {key}")
        if parent.get("inline"):
            name = parent.get("name")
            place = f"a coordinate of joints[{k}].{key}"
            at = self.source.point(parent.get("x"), parent.get("y"), place)
            preferred = name if isinstance(name, str) else f"O{k}"
            # inline joints are written again wherever they are used
            same = self.points.get(preferred)
            if same in self.assembly.fixed and self.assembly.points[str(same)] == at:
                return str(same)
            point = self.assembly.add_point(preferred, at, fixed=True)
            self.points.setdefault(preferred, point)
            return point
        ref = parent.get("ref")
        if not isinstance(ref, str) or ref not in self.points:
            self.refuse("joints", k, f"{key} refers to {str(ref)[:40]!r}, which is no joint")
        return self.points[ref]

    def bar(self, a: str, b: str, length: float | None) -> str:
        """A link between two points with its stated length."""
        link = self.assembly.add_link(f"{a}_{b}", (a, b))
        if length is not None:
            self.assembly.lengths[f"{a} {b}"] = length
        return link

    def static(self, entry: dict[str, Any], k: int, point: str) -> None:
        pass

    def crank(self, entry: dict[str, Any], k: int, point: str) -> None:
        base = self.parent(entry, "joint0", k)
        link = self.bar(base, point, self.size(entry, "distance", k))
        if entry.get("angle") is not None:
            self.source.leave_out(f"joints[{k}]", _STEP)
        carriers = [n for n in self.assembly.carriers(base) if n != link]
        self.assembly.drive(link, carriers[0] if carriers else GROUND)  # ground is the first

    def revolute(self, entry: dict[str, Any], k: int, point: str) -> None:
        for number in "01":
            base = self.parent(entry, f"joint{number}", k)
            self.bar(base, point, self.size(entry, f"distance{number}", k))

    def fixed(self, entry: dict[str, Any], k: int, point: str) -> None:
        a, b = (self.parent(entry, f"joint{number}", k) for number in "01")
        # a place relative to two joints is rigid only on a link with both
        on = self.assembly.carrier(a, b)
        if on is None:
            self.source.leave_out(
                f"joints[{k}]", "joint fixed to two joints that are on no common link"
            )
            return
        self.assembly.put_on(on, point)
        length, angle = self.size(entry, "distance", k), self.size(entry, "angle", k)
        if on == GROUND:
            return
        if length is not None:
            self.assembly.lengths[f"{a} {point}"] = length
        if angle is not None:
            self.assembly.angles[f"{b} {a} {point}"] = math.degrees(angle)

    def slide(self, entry: dict[str, Any], k: int, point: str) -> None:
        base, first, second = (self.parent(entry, f"joint{number}", k) for number in "012")
        on = self.assembly.carrier(first, second)
        if on is None:
            self.source.leave_out(f"joints[{k}]", "slide on two joints that are on no common link")
            return
        self.bar(base, point, self.size(entry, "revolute_radius", k))
        self.assembly.add_slot(f"s_{point}", point, on, (first, second))


_PARENTS = {
    "Static": _Parents.static,
    "Crank": _Parents.crank,
    "Revolute": _Parents.revolute,
    "Pivot": _Parents.revolute,
    "Fixed": _Parents.fixed,
    "Linear": _Parents.slide,
    "Prismatic": _Parents.slide,
}


class _Mechanism(_Reading):
    """Joints with places, and links with joints."""

    def add(self, links: list[dict[str, Any]]) -> None:
        """Add points, links, the driver, then slides and followers."""
        for k, entry in enumerate(self.joints):
            name, at = self.named(entry, "id", "joints", k), entry.get("position")
            if not isinstance(at, list) or len(at) != 2:
                self.refuse("joints", k, "needs position, a list of two numbers")
            self.add_point(name, k, at[0], at[1], entry.get("type") == "ground")
        # links first: slides and trackers look for links of their joints
        for k, entry in enumerate(links):
            self._add_link(entry, k)
        for k, entry in enumerate(self.joints):
            kind, point = entry.get("type", "revolute"), self.points[entry["id"]]
            if kind == "prismatic":
                self._slide(entry, k, point)
            elif kind == "tracker":
                self._follow(entry, k, point)
            elif kind not in ("ground", "revolute"):
                self.source.leave_out(f"joints[{k}]", "unknown type, read as a pin")

    def _add_link(self, entry: dict[str, Any], k: int) -> None:
        name, ends = self.named(entry, "id", "links", k), entry.get("joints")
        if not isinstance(ends, list) or any(
            not isinstance(j, str) or j not in self.points for j in ends
        ):
            self.refuse("links", k, "needs joints, a list of ids of joints")
        points = [self.points[joint] for joint in ends]
        kind = entry.get("type", "link")
        if kind == "ground":
            self.assembly.fixed.update(points)
            return
        motor = entry.get("motor_joint")
        if motor in ends:  # the angle of a link counts from its first point
            first = self.points[str(motor)]
            points.sort(key=lambda point: point != first)
        link = self.assembly.add_link(name, points)
        if kind in ("driver", "arc_driver"):
            self._drive(entry, k, link, ends)
        elif kind != "link":
            self.source.leave_out(f"links[{k}]", "unknown type, read as a link")

    def _drive(self, entry: dict[str, Any], k: int, link: str, joints: list[str]) -> None:
        motor = entry.get("motor_joint")
        if motor not in joints or self.points[motor] not in self.assembly.fixed:
            self.source.leave_out(f"links[{k}]", "driver without a motor at a fixed joint")
            return
        if entry.get("angular_velocity") is not None:
            self.source.leave_out(f"links[{k}]", _STEP)
        ends: dict[str, float] = {}
        for field, key in (("from_", "arc_start"), ("to", "arc_end")):
            angle = self.size(entry, key, k) if entry.get("type") == "arc_driver" else None
            if angle is not None:
                ends[field] = math.degrees(angle)
        self.assembly.drive(link, GROUND, **ends)

    def _slide(self, entry: dict[str, Any], k: int, point: str) -> None:
        axis = entry.get("axis", [1.0, 0.0])
        if not isinstance(axis, list) or len(axis) != 2:
            self.refuse("joints", k, "needs axis, a list of two numbers")
        along = self.source.point(axis[0], axis[1], f"the axis of joints[{k}]")
        if not along:
            self.refuse("joints", k, "has an axis of length zero")
        line = self.assembly.guide(GROUND, point, along)
        self.assembly.add_slot(f"s_{point}", point, GROUND, line)

    def _follow(self, entry: dict[str, Any], k: int, point: str) -> None:
        refs = [entry.get(f"ref_joint{number}_id") for number in "12"]
        known = [self.points[ref] for ref in refs if isinstance(ref, str) and ref in self.points]
        on = self.assembly.carrier(*known) if len(known) == 2 else None
        if on is not None:
            self.assembly.put_on(on, point)
        else:
            self.source.leave_out(
                f"joints[{k}]", "tracker of two joints that are on no common link"
            )


def write(drawn: Drawn) -> str:
    """Write a mechanism of pins, and slots along lines of ground.

    Raises
    ------
    InputError
        If the linkage has sliders, or slots on moving links.
    """
    driven = drawn.driven_pins()
    joints: list[dict[str, Any]] = []
    for row in drawn.joints():
        joint: dict[str, Any] = {"id": row.name, "position": [row.at.real, row.at.imag]}
        if row.kind == "R":
            joint["type"] = "ground" if GROUND in row.links else "revolute"
        elif row.kind == "RP" and row.links[0] == GROUND:
            joint |= {"type": "prismatic", "axis": [math.cos(row.angle), math.sin(row.angle)]}
        else:
            raise InputError(
                f'"{row.place}" has no equivalent in pylinkage: it slides on a moving link or '
                "without turning"
            )
        joints.append(joint)
    tables = []
    for name, joints_of_link in drawn.linkage.links.items():
        table: dict[str, Any] = {"id": name, "type": "link", "joints": list(joints_of_link)}
        motors = [
            point
            for point, which in driven.items()
            if which.link == name or (which.link is None and point in joints_of_link)
        ]
        if name == GROUND:
            table["type"] = GROUND
        elif motors and motors[0] in drawn.linkage.links[GROUND]:
            table |= {"type": "driver", "motor_joint": motors[0]}
        tables.append(table)
    data = {"name": drawn.linkage.name, "joints": joints, "links": tables, "ground": GROUND}
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"
