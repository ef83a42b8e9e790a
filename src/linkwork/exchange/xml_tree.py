"""XML as a tree of elements with their lines: no document types, no entities, nothing external."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from linkwork.exchange.source import Source

__all__ = ["Element", "xml_tree"]

_DEEPEST = 100
_MOST = 50_000


@dataclass(frozen=True)
class Element:
    """An element, its attributes and line; texts between elements are not kept."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def get(self, name: str, default: str = "") -> str:
        """An attribute."""
        return self.attributes.get(name, default)

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
    builder = _Builder(source)
    parser = builder.parser
    # entities are declared in a document type only: without it none can expand
    parser.StartDoctypeDeclHandler = builder.no_document_type
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        what = expat.ErrorString(error.code)
        source.refuse(f"is not XML: {what} (column {error.offset + 1})", error.lineno)
    except (ValueError, LookupError):  # encodings that Python does not have
        source.refuse("is in an encoding that is not read: save it as UTF-8", 1)
    root = builder.top.children[0]
    if root.tag not in roots:
        wanted = " or ".join(f"<{tag}>" for tag in roots)
        source.refuse(f"begins with <{root.tag[:40]}>, expected {wanted}", root.line)
    return root


class _Builder:
    def __init__(self, source: Source) -> None:
        self.source = source
        self.parser = expat.ParserCreate()
        self.top = Element("", {}, 1)
        self.open = [self.top]
        self.count = 0

    def _refuse(self, message: str) -> NoReturn:
        self.source.refuse(message, self.parser.CurrentLineNumber)

    def no_document_type(self, *_: object) -> None:
        self._refuse("has a document type (DOCTYPE): entities are not read, remove it")

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        # readers descend by recursion
        if len(self.open) > _DEEPEST:
            self._refuse(f"has elements nested deeper than {_DEEPEST} levels")
        if self.count > _MOST:
            self._refuse(f"has more than {_MOST} elements")
        own = Element(tag, attributes, self.parser.CurrentLineNumber)
        self.open[-1].children.append(own)
        self.open.append(own)

    def end(self, _: str) -> None:
        self.open.pop()
