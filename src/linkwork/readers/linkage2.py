"""Linkage by David Rector: XML with connectors, links and ratios, ``.linkage2``.

After ``CLinkageDoc::ReadIn`` and ``WriteOut`` of the program's published source. Lengths are in
1/96 inch, whatever unit the file says is shown.
"""

from __future__ import annotations

import re

from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.units import LENGTHS
from linkwork.core.mechanism.inputs import Input
from linkwork.core.mechanism.part.springs import Weld
from linkwork.readers.assembly import Assembly, Source, drive_joint
from linkwork.readers.robots import Element, xml_tree

TITLE, SUFFIXES = "Linkage (Rector) XML", (".linkage2",)
_DRAWING_LAYER = 1
#: The unit of our file by the one that is shown.
_UNITS = {
    "Millimeters": "mm", "Centimeters": "cm", "Meters": "m", "Inches": "in", "Feet": "ft",
}  # fmt: skip
_SIDES = ("link", "Link", "element")


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    return re.search(r"<linkage2\b", head) is not None


def read(source: Source) -> Assembly:
    """Read connectors and links."""
    root = xml_tree(source.data, source, "linkage2")
    return _Document(source, root).assembly


class _Document:
    def __init__(self, source: Source, root: Element) -> None:
        self.source, self.assembly = source, Assembly(source)
        program = root.one("program") or Element(source, "program", {}, root.line)
        shown = program.get("units", "Millimeters")
        self.assembly.length = source.chosen(shown, _UNITS, program.place)
        self.scale = float(LENGTHS["in"] / LENGTHS[self.assembly.length] / 96)
        if program.get("scalefactor", "1") != "1":
            program.leave_out("factor of the lengths that are shown")
        self.points: dict[str, str] = {}
        self.links: dict[str, str] = {}
        connectors = self._mechanical(root, "connector")
        links = [node for node in root.children if node.tag in _SIDES and self._is_mechanical(node)]
        for node in connectors:
            self._add_connector(node)
        for node in links:
            self._add_link(node)
        # links must be complete before gears are fastened and pins driven
        for node in (*connectors, *links):
            self._fasten(node)
        for node in connectors:
            self._drive_or_slide(node)
        for ratios in root.all("ratios"):
            for ratio in ratios.all("ratio"):
                self._add_ratio(ratio)

    def _is_mechanical(self, element: Element) -> bool:
        layer = element.get("layer", "0")
        number = int(layer) if layer.isascii() and layer.isdigit() and len(layer) < 12 else 0
        if number & _DRAWING_LAYER:
            element.leave_out(f"drawing element <{element.tag}>")
        return not number & _DRAWING_LAYER

    def _mechanical(self, root: Element, tag: str) -> list[Element]:
        return [element for element in root.all(tag) if self._is_mechanical(element)]

    def _id(self, element: Element) -> str:
        if not element.get("id"):
            element.refuse(f"<{element.tag}> has no id")
        return element.get("id")

    def _length(self, element: Element, key: str, default: str = "") -> float:
        return self.scale * element.number(key, default)

    def _add_connector(self, element: Element) -> None:
        key = self._id(element)
        if key in self.points:
            element.refuse(f'two connectors have the id "{key[:40]}"')
        x, y = (self._length(element, c) for c in "xy")
        point = self.assembly.add_point(
            element.get("name") or f"P{key}", complex(x, y), element.get("anchor") == "true"
        )
        self.points[key] = point
        if element.get("draw") == "true":
            self.assembly.trace.append(point)
        if element.get("drawcircle"):
            element.leave_out("drawn circle")

    def _add_link(self, element: Element) -> None:
        key = self._id(element)
        if key in self.links:
            element.refuse(f'two links have the id "{key[:40]}"')
        points = []
        for child in element.children:
            if child.tag not in ("connector", "fastenconnector"):
                continue
            if child.get("id") not in self.points:
                child.refuse(f'unknown connector "{child.get("id")[:40]}"')
            points.append(self.points[child.get("id")])
        if element.get("actuator") == "true" and len(points) == 2 and points[0] != points[1]:
            self._add_actuator(element, points)
            return
        self.links[key] = self.assembly.add_link(element.get("name") or f"link{key}", points)
        if element.get("actuator") == "true":
            element.leave_out("actuator with more than two connectors")

    def _add_actuator(self, element: Element, points: list[str]) -> None:
        preferred = element.get("name") or f"actuator{element.get('id')}"
        name = self.assembly.add_part("cylinders", preferred, "actuator", between=tuple(points))
        a, b = (self.assembly.points[point] for point in points)
        throw = self._length(element, "throw", "0")
        if throw > 0:
            start = abs(b - a)
            which = Input(cylinder=name, from_=start, to=start + throw, step=throw / 100.0)
            self.assembly.inputs.append(which)
        element.leave_out("strokes per minute of the actuator")

    def _fasten(self, node: Element) -> None:
        """A gear or connector that is fixed on a link."""
        to = node.get("fastenlink") or (node.get("fasten") if node.tag == "connector" else "")
        other = self.links.get(to)
        if node.get("fastenconnector"):
            node.leave_out("gear fastened to a connector")
        if other is None:
            return
        if node.tag == "connector":
            self.assembly.put_on(other, self.points[node.get("id")])
        elif node.get("id") in self.links:
            link = self.links[node.get("id")]
            if self.assembly.carries(link) & self.assembly.carries(other):
                self.assembly.parts["welds"].append(Weld(links=(other, link)))
            else:
                node.leave_out("fastened link without a common connector")

    def _drive_or_slide(self, element: Element) -> None:
        point = self.points[element.get("id")]
        if element.get("slider") == "true":
            known = (self.points.get(each.get("id")) for each in element.all("slidelimit"))
            limits = list(dict.fromkeys(known))
            if element.get("slideradius") and element.number("slideradius"):
                element.leave_out("slide on an arc")
            elif len(limits) == 2 and limits[0] and limits[1]:
                self._slide(element, point, (limits[0], limits[1]))
            else:
                element.leave_out("slide without two limits")
        if element.get("input") == "true":
            # gears turn with the links to which they are fastened
            carriers = self.assembly.carriers(point)
            pinned = [n for n in carriers if n == GROUND or len(self.assembly.links[n]) > 1]
            # a gear alone on its pin can be driven too
            pinned = pinned if len(pinned) == 2 else carriers
            speed = f"{element.number('rpm')} rpm" if element.get("rpm") else None
            drive_joint(self.assembly, element.place, pinned, speed)

    def _slide(self, element: Element, point: str, line: tuple[str, str]) -> None:
        carriers = self.assembly.carriers(*line)
        on = [name for name in carriers if point not in self.assembly.carries(name)]
        if on:
            self.assembly.add_slot(f"s_{point}", point, on[0], line)
        else:
            element.leave_out("slide whose limits are on no other link")

    def _add_ratio(self, element: Element) -> None:
        ends = [(self.links.get(link.get("id")), link) for link in element.all("link")]
        wheels = [name for name, _ in ends if name and self.assembly.links.get(name)]
        if len(ends) != 2 or len(wheels) != 2 or wheels[0] == wheels[1]:
            element.leave_out("ratio without two wheels")
            return
        sizes = [self._length(link, "size") for _, link in ends]
        centers = [self.assembly.links[wheel][0] for wheel in wheels]
        arms = [name for name in self.assembly.carriers(*centers) if name not in wheels]
        if not arms or min(sizes) <= 0 or centers[0] == centers[1]:
            element.leave_out("ratio of wheels whose centres are on no common link")
            return
        self._join(element, wheels, centers, arms[0], sizes)

    def _join(
        self, element: Element, wheels: list[str], centers: list[str], arm: str, sizes: list[float]
    ) -> None:
        pair = {"wheels": tuple(wheels), "centers": tuple(centers), "arm": arm}
        if element.get("type") != "gears":
            self.assembly.add_part("belts", "chain", "belt", **pair, radii=tuple(sizes))
            if element.get("sizeassize") != "true":
                element.leave_out("radii of the chain's wheels: the ratio is right")
            return
        a, b = (self.assembly.points[center] for center in centers)
        # only the ratio of the sizes is meant, the wheels touch
        radii = tuple(abs(b - a) * size / sum(sizes) for size in sizes)
        self.assembly.add_part("gears", "mesh", "gear", **pair, radii=radii)
