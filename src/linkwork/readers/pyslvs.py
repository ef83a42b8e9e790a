"""Pyslvs expressions: ``M[J[R, P[0, 0], L[ground, crank]], …]``.

The grammar is that of Pyslvs' parser (github.com/KmolYuan/pyslvs, ``expression_parser.py``): joints
``R``, ``P`` and ``RP``; of the last two the first link has the line, at the angle ``A`` [deg].
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import Assembly, Drawn, JointRow, Source, add_joints

TITLE, SUFFIXES = "Pyslvs expression", (".pyslvs",)
_DEEPEST = 3  # brackets in brackets
_TOKEN = re.compile(r"\s*(?:#[^\n]*\n\s*)*([\[\],]|[^\s\[\],#]+)")


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    return re.match(r"M\s*\[", head.strip()) is not None


def read(source: Source) -> Assembly:
    """Read an expression; the input is not in it."""
    parser = _Parser(source)
    whole = parser.term()
    if whole.word != "M" or parser.word:
        source.refuse(
            f'expected M[…] alone, got "{parser.word[:40] or whole.word[:40]}"', parser.line
        )
    assembly = Assembly(source)
    joints = enumerate(whole.parts, start=1)
    add_joints(assembly, [_joint(parser, count, term) for count, term in joints])
    source.leave_out("the expression", "the input: an expression does not state it")
    return assembly


@dataclass(frozen=True)
class _Term:
    """A word that ends ``at`` this character, with the terms in brackets behind it."""

    word: str
    at: int
    parts: list[_Term]


class _Parser:
    def __init__(self, source: Source) -> None:
        self.source, self.text = source, source.text()
        self.at = 0
        self.word = self._next()

    @property
    def line(self) -> int:
        return self.line_of(self.at)

    def line_of(self, at: int) -> int:
        """The line of a character."""
        return self.text.count("\n", 0, at) + 1

    def _next(self) -> str:
        match = _TOKEN.match(self.text, self.at)
        self.at = match.end() if match else len(self.text)
        return match[1] if match else ""

    def take(self, expected: str = "") -> str:
        """The next word, or the sign that is expected."""
        word = self.word
        if word != expected if expected else word in ("", *"[],"):
            got = f'"{word[:40]}"' if word else "the end"
            self.source.refuse(f'expected "{expected or "a word"}", got {got}', self.line)
        self.word = self._next()
        return word

    def term(self, depth: int = 0) -> _Term:
        """A word, with or without brackets."""
        if depth > _DEEPEST:
            self.source.refuse("a bracket too many", self.line)
        at, word = self.at, self.take()
        parts: list[_Term] = []
        if self.word == "[":
            self.take("[")
            while self.word != "]":
                parts.append(self.term(depth + 1))
                if self.word != "]":
                    self.take(",")
            self.take("]")
        return _Term(word, at, parts)


def _joint(parser: _Parser, count: int, term: _Term) -> JointRow:
    source, place, line = parser.source, f"joint {count}", parser.line_of(term.at)
    kind, *parts = term.parts or [term]
    if term.word != "J" or kind.word not in ("R", "P", "RP"):
        source.refuse(f'"{kind.word[:40]}" is not a joint R, P or RP', line)
    fields = {part.word: [inner.word for inner in part.parts] for part in parts}
    if len(fields) < len(parts):
        source.refuse("a joint has a field twice", line)
    at, angle = fields.get("P", []), fields.get("A", ["0"])
    if len(at) != 2 or len(angle) != 1:
        source.refuse("a joint needs its place, P[x, y], and its angle, A[degrees]", line)
    for name in fields:
        if name not in ("P", "A", "L"):
            source.leave_out(place, "colour" if name == "color" else f'unknown "{name[:40]}"')
    return JointRow(
        place=place,
        kind=kind.word,
        at=source.point(at[0], at[1], "a coordinate", line),
        links=tuple(fields.get("L", ())),
        angle=math.radians(source.number(angle[0], "the angle", line)),
        name=f"P{count - 1}",
    )


def write(drawn: Drawn) -> str:
    """Write pins, slots and sliders; the input and the names of points are left out."""
    labels = {GROUND: GROUND}
    for k, name in enumerate(drawn.linkage.links):
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            drawn.leave_out(name, "the name: it has letters that the format does not know")
        labels.setdefault(name, name if re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII) else f"L{k}")
    rows = []
    for joint in drawn.joints():
        kind = "R" if joint.kind == "R" else f"{joint.kind}, A[{math.degrees(joint.angle)!r}]"
        links = ", ".join(labels[link] for link in joint.links)
        rows.append(f"J[{kind}, P[{joint.at.real + 0.0!r}, {joint.at.imag + 0.0!r}], L[{links}]]")
    for which in drawn.linkage.inputs:
        drawn.leave_out(which.column, "the input: an expression does not state it")
    return f"M[{', '.join(rows)}]\n"
