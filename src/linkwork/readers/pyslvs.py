"""Pyslvs expressions: ``M[J[R, P[0, 0], L[ground, crank]], …]``.

The grammar is that of Pyslvs' parser (github.com/KmolYuan/pyslvs, ``expression_parser.py``): joints
``R``, ``P`` and ``RP``; of the last two the first link has the line, at the angle ``A`` [deg].
"""

from __future__ import annotations

import math
import re

from linkwork.core.foundation.names import GROUND
from linkwork.readers.assembly import Assembly, Drawn, JointRow, Source, add_joints

TITLE, SUFFIXES = "Pyslvs expression", (".pyslvs",)
_TOKEN = re.compile(r"\s*(?:#[^\n]*\n\s*)*([\[\],]|[^\s\[\],#]+)")


def matches(head: str) -> bool:
    """Whether a text begins like this format."""
    return re.match(r"M\s*\[", head.strip()) is not None


def read(source: Source) -> Assembly:
    """Read an expression; the input is not in it."""
    rows = _Parser(source).mechanism()
    assembly = Assembly(source)
    add_joints(assembly, rows)
    source.leave_out("the expression", "the input: an expression does not state it")
    return assembly


class _Parser:
    def __init__(self, source: Source) -> None:
        self.source, self.text = source, source.text()
        self.at = 0
        self.word = self._next()

    @property
    def line(self) -> int:
        return self.text.count("\n", 0, self.at) + 1

    def _next(self) -> str:
        match = _TOKEN.match(self.text, self.at)
        self.at = match.end() if match else len(self.text)
        return match[1] if match else ""

    def take(self, expected: str = "") -> str:
        """The next word, which must be ``expected``."""
        word = self.word
        if (expected and word != expected) or not word:
            got = f'"{word[:40]}"' if word else "the end"
            self.source.refuse(f'expected "{expected or "a word"}", got {got}', self.line)
        self.word = self._next()
        return word

    def mechanism(self) -> list[JointRow]:
        self.take("M")
        self.take("[")
        rows: list[JointRow] = []
        while self.word != "]":
            rows.append(self.joint(len(rows) + 1))
            if self.word != "]":
                self.take(",")
        self.take("]")
        if self.word:
            self.source.refuse(f'"{self.word[:40]}" follows the expression', self.line)
        return rows

    def joint(self, count: int) -> JointRow:
        line = self.line
        self.take("J")
        self.take("[")
        kind = self.take()
        if kind not in ("R", "P", "RP"):
            self.source.refuse(f'joint type "{kind[:40]}" is not R, P or RP', line)
        fields: dict[str, list[str]] = {}
        while self.word == ",":
            self.take(",")
            name = self.take()
            if name in fields:
                self.source.refuse(f'"{name[:40]}" occurs twice', self.line)
            fields[name] = self.words()
        self.take("]")
        at = fields.get("P", [])
        if len(at) != 2:
            self.source.refuse("a joint needs its place, P[x, y]", line)
        angle = self.source.number(fields.get("A", ["0"])[0], "the angle", line)
        if "color" in fields:
            self.source.leave_out(f"joint {count}", "colour")
        for name in fields:
            if name not in ("P", "A", "L", "color"):
                self.source.leave_out(f"joint {count}", f'unknown "{name[:40]}"')
        return JointRow(
            place=f"joint {count}",
            kind=kind,
            at=self.source.point(*at, "a coordinate", line),
            links=tuple(fields.get("L", ())),
            angle=math.radians(angle),
            name=f"P{count - 1}",
        )

    def words(self) -> list[str]:
        """Words between brackets."""
        self.take("[")
        words: list[str] = []
        while self.word != "]":
            words.append(self.take())
            if words[-1] == "[":
                self.source.refuse("a bracket too many", self.line)
            if self.word != "]":
                self.take(",")
        self.take("]")
        return words or [""]


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
