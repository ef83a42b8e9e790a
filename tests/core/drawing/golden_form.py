"""SVG files in a form that does not depend on the program that wrote them, and ten golden ones.

Kept are the outlines of every group ``role:name`` as straight pieces between their corners, and
every text with its place: what a drawing shows and where, not in which font.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import linkwork as lw
from linkwork.core.drawing import SceneOptions, render

__all__ = ["FOLDER", "GOLDEN", "Shape", "drawn", "read", "written"]

FOLDER = Path(__file__).with_name("golden")

#: What is drawn of which mechanism: vectors or not, and options of the scene.
GOLDEN: dict[str, tuple[bool, SceneOptions]] = {
    "belt-drive": (False, SceneOptions(link_names=True)),
    "cam-roller-follower": (False, SceneOptions()),
    "crank-shaper": (False, SceneOptions(further=3)),
    "elliptic-trammel": (False, SceneOptions(centres=True, centrodes=("rod",))),
    "excavator": (False, SceneOptions()),
    "four-bar": (False, SceneOptions(dimensions=True)),
    "jansen-leg": (False, SceneOptions(speed=True)),
    "planetary-gear": (False, SceneOptions()),
    "rapier-drive": (True, SceneOptions()),
    "slider-crank": (False, SceneOptions(velocities=True, accelerations=True)),
}

_SVG = "{http://www.w3.org/2000/svg}"
_PLACE = re.compile(r"translate\((\S+) (\S+)\)")
_STEP = re.compile(r"([MLCQZ])([^MLCQZ]*)", re.IGNORECASE)


@dataclass(frozen=True)
class Shape:
    """A line or outline (text empty), or a text at one point; points from the upper left corner."""

    name: str
    text: str
    points: tuple[tuple[float, float], ...]


def drawn(name: str) -> str:
    """The golden drawing of a mechanism as it is today, in normal form."""
    vectors, options = GOLDEN[name]
    scene = lw.example(name).scene(vectors=vectors, options=options)
    return written(_shapes(render(scene, "svg")))


def written(shapes: list[Shape]) -> str:
    """Shapes as a plain SVG file that a browser shows."""
    ends = [point for shape in shapes for point in shape.points]
    width, height = (max(values) + 20 for values in zip(*ends, strict=True))
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}">']
    for shape in shapes:
        own = f"id={quoteattr(shape.name)}"
        places = [f"{x:.2f} {y:.2f}" for x, y in shape.points]
        if shape.text:
            x, y = places[0].split()
            lines.append(f'<text {own} x="{x}" y="{y}">{escape(shape.text)}</text>')
        else:
            way = "M" + " L".join(places)
            lines.append(f'<path {own} d="{way}" fill="none" stroke="black"/>')
    return "\n".join([*lines, "</svg>"]) + "\n"


def read(text: str) -> list[Shape]:
    """The shapes of a file in normal form."""
    found = []
    for element in ElementTree.fromstring(text):
        if element.tag == f"{_SVG}text":
            place = (float(element.get("x", "")), float(element.get("y", "")))
            found.append(Shape(element.get("id", ""), element.text or "", (place,)))
        else:
            points = _corners(element.get("d", ""))
            found.append(Shape(element.get("id", ""), "", points))
    return found


def _shapes(svg: bytes) -> list[Shape]:
    """What the groups of a file of Matplotlib's show, bottom to top, and its headings."""
    reader = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    found = []
    for group in ElementTree.fromstring(svg, parser=reader).iter(f"{_SVG}g"):
        name = group.get("id", "")
        if ":" not in name:
            continue
        comment: Any = ElementTree.Comment  # which types do not know as a kind of element
        texts = [e.text.strip() for e in group.iter(comment) if e.text]
        if texts:
            place = next(_PLACE.search(g.get("transform", "")) for g in group.iter(f"{_SVG}g")
                         if "translate" in g.get("transform", ""))  # fmt: skip
            assert place is not None
            at = (float(place[1]), float(place[2]))
            found.append(Shape(name, texts[0].replace("&#45;", "-"), (at,)))
            continue
        found += [
            Shape(name, "", corners)
            for path in group.iter(f"{_SVG}path")
            if (corners := _corners(path.get("d", "")))
        ]
    return found


def _corners(way: str) -> tuple[tuple[float, float], ...]:
    """Where the pieces of a path end, curved ones too."""
    found = []
    for _, numbers in _STEP.findall(way):
        values = [float(number) for number in re.findall(r"-?[\d.]+(?:e-?\d+)?", numbers)]
        if values:
            found.append((values[-2], values[-1]))
    return tuple(found)
