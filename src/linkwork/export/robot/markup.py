"""XML elements of the formats of robots."""

from __future__ import annotations

from importlib import metadata
from xml.etree import ElementTree as Tree

__all__ = ["WORLD", "element", "numbers", "written"]

#: The ground in MJCF and SDF.
WORLD = "world"


def numbers(*values: float) -> str:
    """Numbers as text that reads back as the same numbers."""
    return " ".join(repr(float(value) + 0.0) for value in values)


def element(parent: Tree.Element, tag: str, text: str = "", **attributes: str) -> Tree.Element:
    """Add an element."""
    own = Tree.SubElement(parent, tag, attributes)
    own.text = text or None
    return own


def written(root: Tree.Element, notes: list[str]) -> str:
    """The document, with notes as a comment at its top."""
    Tree.indent(root)
    lines = [f"Written by Linkwork {metadata.version('linkwork')}.", *notes]
    # a comment must not contain two hyphens in a row
    text = "\n  ".join(lines).replace("--", "- -")
    return f"<!--\n  {text}\n-->\n{Tree.tostring(root, encoding='unicode')}\n"
