"""DXF sketches: circles are pins, lines and polylines between them are links.

Pairs of group codes and values after Autodesk's DXF Reference, ASCII form. Pins and lines on a
layer ``ground`` are fixed, a line on a layer ``input`` is driven.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import Assembly, Source, drive_joint

TITLE, SUFFIXES = "DXF sketch", (".dxf",)
_GROUND_LAYERS = ("ground", "frame", "fixed", "base")
_INPUT_LAYERS = ("input", "driver", "crank", "motor")
_TRACE_LAYERS = ("trace", "path")
_UNITS = {"1": "in", "2": "ft", "4": "mm", "5": "cm", "6": "m", "13": "µm", "14": "dm"}
_TOLERANCE = 1e-6  # of a circle's radius or a line's length: drawn at the same place
_ARCS = "arc of a polyline: read as straight"
_MOST = 20_000  # circles, lines and polylines


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    begin = r"\s*(999\s*\n[^\n]*\n\s*)*0\s*\r?\n\s*SECTION\b"
    return head.startswith("AutoCAD Binary DXF") or re.match(begin, head) is not None


@dataclass
class _Entity:
    source: Source
    kind: str
    line: int
    codes: dict[int, list[str]] = field(default_factory=dict)

    def all(self, code: int) -> list[str]:
        return self.codes.get(code, [])

    def one(self, code: int, default: str = "0") -> str:
        return self.all(code)[0] if self.all(code) else default

    @property
    def place(self) -> str:
        """Where it is, for notes."""
        return f"line {self.line}"

    def leave_out(self, what: str) -> None:
        """Note that it is not carried over."""
        self.source.leave_out(self.place, what)

    def corner(self, x: str, y: str) -> complex:
        """A place of two words."""
        return self.source.point(x, y, f"a coordinate of {self.kind[:20]}", self.line)

    @property
    def layer(self) -> str:
        return self.one(8, "").strip().lower()

    @property
    def is_on_sheet(self) -> bool:
        """Whether it belongs to the printed sheet, not to the drawing."""
        return self.one(67) == "1"

    @property
    def has_arcs(self) -> bool:
        """Of a polyline or its corner: whether a piece is an arc, by its bulge."""
        return any(bulge.strip("-+0.") for bulge in self.all(42))

    @property
    def is_mirrored(self) -> bool:
        """Whether its plane is seen from behind: its coordinates would be mirrored."""
        return self.one(230, "1").startswith("-")

    @property
    def is_closed(self) -> bool:
        """Of a polyline: its flags are bits, of which the first says that it is closed."""
        return self.one(70).isdecimal() and int(self.one(70)[-1]) % 2 == 1


@dataclass
class _Pin:
    at: complex
    radius: float
    layers: set[str]
    name: str = ""


def read(source: Source) -> Assembly:
    """Read the entities of a drawing."""
    if source.data.startswith(b"AutoCAD Binary DXF"):
        source.refuse("is a binary DXF file: save it as ASCII DXF")
    units, entities = _entities(source)
    assembly = Assembly(source)
    assembly.length = _UNITS.get(units, "unit")
    if units not in _UNITS:
        source.leave_out("$INSUNITS", "unit of length: none is stated that is known")
    pins = _pins(source, entities)
    for k, pin in enumerate(pins):
        pin.name = assembly.add_point(f"P{k + 1}", pin.at, bool(pin.layers & set(_GROUND_LAYERS)))
        if pin.layers & set(_TRACE_LAYERS):
            assembly.trace.append(pin.name)
    driven = []
    for entity, path, closed in _paths(source, entities):
        along = _pins_of(path, closed, pins)
        if entity.kind == "LINE" and (len(along) < 2 or not {path[0], path[-1]} <= along.keys()):
            entity.leave_out("line with an end at no circle")
        elif len(along) < 2:
            entity.leave_out("polyline with fewer than two circles at its corners")
        elif entity.layer in _GROUND_LAYERS:
            assembly.fixed.update(along.values())
        else:
            link = assembly.add_link(f"L{len(assembly.links) + 1}", along.values())
            if entity.layer in _INPUT_LAYERS:
                driven.append((entity.place, link))
    for place, link in driven:
        # without a pivot on ground the drawing does not show the reference of the angle
        pivots = [p for p in assembly.links[link] if p in assembly.fixed]
        drive_joint(assembly, place, [GROUND, link] if pivots else [link])
    if not driven:
        source.leave_out("the drawing", 'the input: no line is on a layer "input"')
    return assembly


def _pairs(source: Source) -> Iterator[tuple[int, int, str]]:
    """Line, group code and value of every pair."""
    # old files have the code page of their country: only names could suffer
    rows = source.data.decode("utf-8-sig", "replace").splitlines()
    while rows and not rows[-1].strip():
        rows.pop()
    for k in range(0, len(rows) - 1, 2):
        code = rows[k].strip()
        if not re.fullmatch(r"-?\d{1,5}", code, re.ASCII):
            source.refuse(f'expected a group code, got "{code[:20]}"', k + 1)
        yield k + 1, int(code), rows[k + 1].strip()


def _entities(source: Source) -> tuple[str, list[_Entity]]:
    """The unit of the header, and the entities of the drawing, without those of blocks."""
    section = variable = units = ""
    entities: list[_Entity] = []
    wait = False
    for line, code, value in _pairs(source):
        if code == 0:
            if value == "SECTION":
                section, wait = "", True
            elif value == "ENDSEC":
                section = ""
            elif section == "ENTITIES":
                entities.append(_Entity(source, value, line))
        elif code == 2 and wait:
            section, wait = value, False
        elif section == "HEADER" and code == 9:
            variable = value
        elif section == "HEADER" and variable == "$INSUNITS" and code == 70:
            units = value
        elif section == "ENTITIES" and entities:
            entities[-1].codes.setdefault(code, []).append(value)
    if not entities:
        source.refuse("has no entities: a section ENTITIES with circles and lines is needed")
    if len(entities) > _MOST:
        source.refuse(f"has more than {_MOST} entities")
    for entity in (entity for entity in entities if entity.is_on_sheet):
        entity.leave_out("entity of the sheet (paper space)")
    return units, [entity for entity in entities if not entity.is_on_sheet]


def _pins(source: Source, entities: list[_Entity]) -> list[_Pin]:
    """The pins: concentric circles are one."""
    pins: list[_Pin] = []
    for entity in entities:
        if entity.kind != "CIRCLE":
            continue
        if entity.is_mirrored:
            entity.leave_out("circle seen from behind (extrusion)")
            continue
        at = entity.corner(entity.one(10, ""), entity.one(20, ""))
        radius = source.number(entity.one(40, ""), "the radius", entity.line)
        same = next((p for p in pins if abs(p.at - at) <= _TOLERANCE * max(radius, p.radius)), None)
        if same is None:
            if len(pins) == 400:
                source.refuse("has more than 400 circles")
            pins.append(_Pin(at, radius, {entity.layer}))
        else:
            same.radius = max(radius, same.radius)
            same.layers.add(entity.layer)
    return pins


def _paths(
    source: Source, entities: list[_Entity]
) -> Iterator[tuple[_Entity, list[complex], bool]]:
    """Lines and polylines with their corners, and whether they are closed."""
    polyline: tuple[_Entity, list[complex]] | None = None
    for entity in entities:
        if entity.kind == "LINE":
            ends = [entity.corner(entity.one(x, ""), entity.one(x + 10, "")) for x in (10, 11)]
            yield entity, ends, False
        elif entity.kind in ("LWPOLYLINE", "POLYLINE") and entity.is_mirrored:
            entity.leave_out("polyline seen from behind (extrusion)")
        elif entity.kind == "LWPOLYLINE":
            if entity.has_arcs:
                entity.leave_out(_ARCS)
            xs, ys = entity.all(10), entity.all(20)
            if len(xs) != len(ys):
                source.refuse("a corner of the polyline lacks a coordinate", entity.line)
            corners = [entity.corner(x, y) for x, y in zip(xs, ys, strict=True)]
            yield entity, corners, entity.is_closed
        elif entity.kind == "POLYLINE":
            polyline = (entity, [])
        elif entity.kind == "VERTEX" and polyline is not None:
            if entity.has_arcs:
                entity.leave_out(_ARCS)
            polyline[1].append(entity.corner(entity.one(10, ""), entity.one(20, "")))
        elif entity.kind == "SEQEND" and polyline is not None:
            yield *polyline, polyline[0].is_closed
            polyline = None
        elif entity.kind != "CIRCLE":
            entity.leave_out(f"entity {entity.kind[:20]}")


def _pins_of(path: list[complex], closed: bool, pins: list[_Pin]) -> dict[complex, str]:
    """The pins at the corners of a path and on its straight pieces, by their place on it."""
    on_path: dict[complex, str] = {}
    for k, corner in enumerate(path):
        # lines may be drawn to the rim of a circle
        nearest = min(pins, key=lambda pin: abs(pin.at - corner), default=None)
        if nearest is not None and abs(nearest.at - corner) <= nearest.radius * (1.0 + _TOLERANCE):
            on_path[corner] = nearest.name
        end = path[(k + 1) % len(path)]
        if end == corner or len(path) >= 50 or (k + 1 == len(path) and not closed):
            continue
        inside = [pin for pin in pins if _is_on(pin, corner, end)]
        for pin in sorted(inside, key=lambda pin: (abs(pin.at - corner), pin.name)):
            if pin.name not in on_path.values():
                on_path[pin.at] = pin.name
    return on_path


def _is_on(pin: _Pin, a: complex, b: complex) -> bool:
    """Whether a pin is inside a straight piece, away from its ends."""
    local = (pin.at - a) / (b - a)
    return abs(local.imag) <= _TOLERANCE and 1e-3 < local.real < 1.0 - 1e-3
