"""GeoGebra constructions that are linkages: ``.ggb`` files, or the ``geogebra.xml`` in them.

After the published XML format (geogebra.org/source/program/xml_format): a construction lists
elements with computed coordinates, and the commands between them. Free points are fixed pivots,
circles keep a distance, lines guide a point. Scripts in a file are never executed.
"""

from __future__ import annotations

import io
import itertools
import re
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field

from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import LARGEST, Assembly, Source
from linkwork.readers.robots import Element, xml_tree

TITLE, SUFFIXES = "GeoGebra construction", (".ggb",)
_ENTRY = "geogebra.xml"
_AXES = {"xAxis": 1 + 0j, "yAxis": 1j}
_WORD = re.compile(r"[^\W\d]\w*")
_BROKEN = (
    zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError, LookupError,
)  # fmt: skip


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    return head.startswith("PK") or re.search(r"<geogebra\b", head) is not None


def read(source: Source) -> Assembly:
    """Read a construction."""
    data = _unpacked(source) if source.data.startswith(b"PK") else source.data
    root = xml_tree(data, source, "geogebra")
    construction = root.one("construction")
    if construction is None:
        root.refuse("has no <construction>")
    return _Construction(source, construction).assembly


def _unpacked(source: Source) -> bytes:
    try:
        with zipfile.ZipFile(io.BytesIO(source.data)) as packed:
            if _ENTRY not in packed.namelist():
                source.refuse(f"is a ZIP file without {_ENTRY}")
            with packed.open(_ENTRY) as entry:
                # the stated size may be wrong: the amount read is bounded
                data = entry.read(LARGEST + 1)
    except _BROKEN as error:
        source.refuse(f"is a damaged ZIP file: {str(error)[:80] or type(error).__name__}")
    if len(data) > LARGEST:
        source.refuse(f"unpacks to more than {LARGEST / 1e6:.0f} MB: more is not read")
    return data


@dataclass(frozen=True)
class _Circle:
    """A circle about a point with a constant radius."""

    center: str


@dataclass(frozen=True)
class _Line:
    """A line through two points, or through one in a direction that ground fixes."""

    points: tuple[str, ...]
    along: complex | None = None


@dataclass
class _Construction:
    source: Source
    root: Element
    assembly: Assembly = field(init=False)
    points: dict[str, str] = field(default_factory=dict)
    shapes: dict[str, _Circle | _Line] = field(default_factory=dict)
    numbers: dict[str, bool] = field(default_factory=dict)  # whether it has a slider

    def __post_init__(self) -> None:
        self.assembly = Assembly(self.source, self.root.get("title"))
        self.assembly.length = "unit"
        self.elements = {element.get("label"): element for element in self.root.all("element")}
        # elements of commands and formulas follow them: a point without one is free
        outputs = (self._outputs(command) for command in self.root.all("command"))
        formulas = (formula.get("label") for formula in self.root.all("expression"))
        self.made = {*itertools.chain.from_iterable(outputs), *formulas}
        steps = {"command": self._command, "expression": self._expression, "element": self._element}
        for element in self.root.children:
            if element.tag in steps:
                steps[element.tag](element)
        if not self.assembly.inputs:
            self.source.leave_out("the construction", "the input: no point moves on a circle")

    def _outputs(self, element: Element) -> list[str]:
        out = element.one("output")
        return [] if out is None else [name for name in out.attributes.values() if name]

    def _element(self, element: Element) -> None:
        """A free object; those of commands were made before."""
        kind, label = element.get("type"), element.get("label")
        for tag in ("ggbscript", "javascript"):
            if element.one(tag) is not None:
                element.leave_out("script: nothing is executed")
        if label not in self.made:
            if kind == "point":
                self._add_point(label, element, fixed=True)
            elif kind in ("numeric", "angle"):
                self.numbers[label] = element.one("slider") is not None
            else:
                element.leave_out(f"element of type {kind[:20]}")
        trace = element.one("trace")
        if trace is not None and trace.get("val") == "true" and label in self.points:
            self.assembly.trace.append(self.points[label])

    def _add_point(self, label: str, element: Element, fixed: bool = False) -> str:
        coords = element.one("coords")
        if coords is None:
            element.refuse(f'point "{label[:40]}" has no coordinates')
        if label in self.points:
            element.refuse(f'two points are called "{label[:40]}"')
        x, y, z = (coords.number(c, "1") for c in "xyz")
        if abs(z) < 1e-200:
            coords.refuse(f'point "{label[:40]}" is at infinity')
        place = self.source.point(x / z, y / z, "a coordinate", coords.line)
        self.points[label] = self.assembly.add_point(label, place, fixed)
        return self.points[label]

    def _expression(self, expression: Element) -> None:
        """A formula: constant points and numbers only."""
        label, text = expression.get("label"), expression.get("exp")
        element = self.elements.get(label)
        constant = not any(word not in self.numbers for word in _WORD.findall(text))
        if constant and element is not None and element.get("type") == "point":
            self._add_point(label, element, fixed=True)
        elif constant and element is not None:
            self.numbers[label] = any(self.numbers[word] for word in _WORD.findall(text))
        else:
            expression.leave_out(f'formula "{text[:40]}"')

    def _command(self, element: Element) -> None:
        name, outputs = element.get("name"), self._outputs(element)
        input_element = element.one("input")
        # a0, a1, … a10: the longer name is the later one
        entries = [] if input_element is None else input_element.attributes.items()
        inputs = [v for _, v in sorted(entries, key=lambda entry: (len(entry[0]), entry[0]))]
        rule = _RULES.get(name)
        if rule is None or (not outputs and name != "Locus"):
            element.leave_out(f"command {name[:40]}")
            return
        why = rule(self, inputs, outputs)
        if why:
            element.leave_out(f"command {name}: {why}")

    def _is_constant(self, text: str) -> bool:
        """Whether a radius does not change: numbers, and segments on one link."""
        for word in _WORD.findall(text):
            shape = self.shapes.get(word)
            if isinstance(shape, _Line) and len(shape.points) == 2:
                if self.assembly.carrier(*shape.points) is None:
                    return False
            elif word not in self.numbers:
                return False
        return True

    def _add_circle(self, names: list[str], out: list[str]) -> str:
        if len(names) != 2 or names[0] not in self.points:
            return "only a centre with a radius or a point is read"
        center = self.points[names[0]]
        through = self.points.get(names[1])
        constant = (
            self._is_constant(names[1])
            if through is None
            else bool(self.assembly.carrier(center, through))
        )
        if not constant:
            return "its radius varies"
        self.shapes[out[0]] = _Circle(center)
        return ""

    def _add_segment(self, names: list[str], out: list[str]) -> str:
        known = [self.points[name] for name in names if name in self.points]
        if len(known) != 2 or len(names) != 2:
            return "only two points are read"
        self.shapes[out[0]] = _Line(tuple(known))
        return ""

    def _add_polygon(self, names: list[str], out: list[str]) -> str:
        known = [self.points[name] for name in names if name in self.points]
        if len(known) != len(names):
            return "only points are read"
        for name, a, b in zip(out[1:], known, [*known[1:], known[0]], strict=False):
            self.shapes[name] = _Line((a, b))
        return (
            ""
            if self.assembly.carrier(*known)
            else "its points are on no common link: it is only drawn"
        )

    def _add_driven_point(self, names: list[str], out: list[str]) -> str:
        """A point that a person drags on a circle or a line."""
        shape = self._shape(names[0]) if len(names) == 1 else None
        element = self.elements.get(out[0])
        if shape is None or element is None:
            return "only circles and lines are read"
        if not isinstance(shape, _Circle) and self._carrier(shape) is None:
            return "its line is on no link"
        point = self._add_point(out[0], element)
        link = self._keep(shape, point)
        if isinstance(shape, _Circle):
            on = next(
                (name for name in self.assembly.carriers(shape.center) if name != link), GROUND
            )
            self.assembly.drive(link, on)
            return ""
        return "the input: a driven slide, whose range the file does not state"

    def _add_intersect(self, names: list[str], out: list[str]) -> str:
        shapes = [self._shape(name) for name in names[:2]]
        if len(shapes) < 2 or any(shape is None for shape in shapes):
            return "only circles with constant radii and lines are read"
        lines = [shape for shape in shapes if isinstance(shape, _Line)]
        if any(self._carrier(line) is None for line in lines):
            return "a line is on no link"
        for label in out:
            element = self.elements.get(label)
            # an intersection that does not exist has an empty element
            if element is None or not element.children:
                continue
            point = self._add_point(label, element)
            for shape in shapes:
                assert shape is not None
                self._keep(shape, point)
        return ""

    def _add_rotate(self, names: list[str], out: list[str]) -> str:
        element = self.elements.get(out[0])
        known = [self.points[name] for name in names[::2] if name in self.points]
        if len(names) != 3 or len(known) != 2 or element is None:
            return "only points about points are read"
        turned, center = known
        on = self.assembly.carrier(turned, center)
        words = _WORD.findall(names[1].replace("°", ""))
        numbers = [word for word in words if word in self.numbers]
        if on is None or (words and not numbers):
            return "the distance from its centre or its angle varies"
        point = self._add_point(out[0], element)
        if any(self.numbers[word] for word in numbers):
            self.assembly.drive(self._keep(_Circle(center), point), on)
        else:
            self.assembly.put_on(on, point)
        return ""

    def _add_midpoint(self, names: list[str], out: list[str]) -> str:
        shape = self.shapes.get(names[0]) if len(names) == 1 else None
        ends = [self.points.get(name, "") for name in names]
        if isinstance(shape, _Line):
            ends = list(shape.points)
        on = self.assembly.carrier(*ends) if len(ends) == 2 and all(ends) else None
        if on is None or out[0] not in self.elements:
            return "its points are on no common link"
        self.assembly.put_on(on, self._add_point(out[0], self.elements[out[0]]))
        return ""

    def _add_locus(self, names: list[str], out: list[str]) -> str:
        if names and names[0] in self.points:
            self.assembly.trace.append(self.points[names[0]])
            return ""
        return "only loci of points are read"

    def _shape(self, name: str) -> _Circle | _Line | None:
        if name in _AXES and name not in self.shapes:
            origin = self.assembly.add_point("origin", 0j, fixed=True)
            second = self.assembly.add_point(name, _AXES[name], fixed=True)
            self.shapes[name] = _Line((origin, second))
        return self.shapes.get(name)

    def _carrier(self, line: _Circle | _Line) -> str | None:
        return self.assembly.carrier(*line.points) if isinstance(line, _Line) else None

    def _keep(self, shape: _Circle | _Line, point: str) -> str:
        """Keep a point on a circle by a bar, or on a line by a slot."""
        if isinstance(shape, _Circle):
            return self.assembly.add_link(f"{shape.center}{point}", (shape.center, point))
        on = self._carrier(shape)
        assert on is not None  # checked by the caller
        return self.assembly.add_slot(f"s_{point}", point, on, (shape.points[0], shape.points[1]))


_Rule = Callable[[_Construction, list[str], list[str]], str]
_RULES: dict[str, _Rule] = {
    "Circle": _Construction._add_circle,
    "Segment": _Construction._add_segment,
    "Line": _Construction._add_segment,
    "Ray": _Construction._add_segment,
    "Polygon": _Construction._add_polygon,
    "Point": _Construction._add_driven_point,
    "Intersect": _Construction._add_intersect,
    "Rotate": _Construction._add_rotate,
    "Midpoint": _Construction._add_midpoint,
    "Locus": _Construction._add_locus,
}
