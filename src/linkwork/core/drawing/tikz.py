"""Scenes as TikZ pictures for LaTeX documents, in a scale that the first comment states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from linkwork.core.drawing.scene import (
    LIGHT,
    XY,
    Arc,
    Disc,
    Hatch,
    Polygon,
    Polyline,
    Primitive,
    Scene,
    Text,
    Theme,
    round_down,
    round_up,
)
from linkwork.core.foundation.names import as_latex
from linkwork.core.foundation.units import LENGTHS

_WIDEST = 150.0  # of a picture [mm]: a column of text
_LEAST = 75.0  # a smaller picture is enlarged
_POINT = 72.27 / 25.4  # TeX's points per millimetre
_SMALLEST = 6.0  # font size [pt]
_DIGITS = 3  # of coordinates, after the point [mm]
_STEPS = (1, 2, 5)


def comment_lines(*texts: str) -> Iterator[str]:
    """Comments of a LaTeX file, one a line."""
    for text in texts:
        if text:
            yield "% " + "".join(letter if letter.isprintable() else " " for letter in text)


def picture_scale(scene: Scene) -> tuple[float, str]:
    """Millimetres of the page per length unit of a scene, and the scale in words.

    The true scale 1:1 where the picture is neither wider than a column of text nor very small; else
    the nearest of 1:2, 1:5, 1:10, … or 2:1, 5:1, …. Without a known unit a unit is a millimetre of
    such a scale.
    """
    unit = float(LENGTHS.get(scene.unit, LENGTHS["mm"]) * 1000)
    size = max(scene.box.width, scene.box.height) * unit
    scale = 1.0
    if size > _WIDEST:
        scale = 1.0 / round_up(size / _WIDEST, _STEPS)
    elif size < _LEAST:
        scale = round_down(_WIDEST / size, _STEPS)
    shown = f"1:{1.0 / scale:.12g}" if scale <= 1.0 else f"{scale:.12g}:1"
    known = scene.unit in LENGTHS
    return unit * scale, f"scale {shown}" + ("" if known else ", a unit of length taken as 1 mm")


def tikz_picture(scene: Scene, theme: Theme = LIGHT) -> str:
    """A scene as a ``tikzpicture`` environment.

    Parameters
    ----------
    scene : Scene
    theme : Theme
        Its colours.
    """
    scale, said = picture_scale(scene)
    writer = _Writer(scene, theme, scale)
    drawn = [line for primitive in scene.primitives for line in writer.drawn(primitive)]
    head = comment_lines(
        ": ".join(filter(None, (scene.title, scene.caption))),
        f"Written by Linkwork, {said}: needs \\usepackage{{tikz}}.",
    )
    begin = "\\begin{tikzpicture}[x=1mm, y=1mm, line cap=round, line join=round]"
    lines = [*head, begin, *writer.colours(), *drawn, "\\end{tikzpicture}"]
    return "\n".join(lines) + "\n"


@dataclass
class _Writer:
    """Translates primitives into paths; coordinates are millimetres of the page."""

    scene: Scene
    theme: Theme
    scale: float
    used: dict[str, None] = field(default_factory=dict)

    def colours(self) -> Iterator[str]:
        """The definitions of all colours that are used."""
        for colour in self.used:
            yield f"  \\definecolor{{lw{colour[1:]}}}{{HTML}}{{{colour[1:]}}}"

    def drawn(self, primitive: Primitive) -> Iterator[str]:
        """The paths of a primitive."""
        match primitive:
            case Polyline() | Arc():
                yield self._path("draw", self._pen(primitive, 1 - 0.5 * primitive.fade),
                                 self._line(primitive.shaft))  # fmt: skip
                if primitive.arrow_head:
                    yield self._area(primitive, primitive.arrow_head, 0.3)
            case Hatch():
                lines = " ".join(self._line(stroke) for stroke in primitive.strokes)
                yield self._path("draw", self._pen(primitive, 1 - 0.5 * primitive.fade), lines)
            case Polygon():
                yield self._area(primitive, primitive.points)
            case Disc():
                place = (
                    f"{self._at(primitive.centre)} circle[radius={self._number(primitive.radius)}]"
                )
                yield self._path("path", self._faces(primitive), place)
            case Text():
                yield self._text(primitive)

    @staticmethod
    def _path(command: str, options: list[str], path: str) -> str:
        return f"  \\{command}[{', '.join(options)}] {path};"

    def _number(self, length: float) -> str:
        rounded = round(length * self.scale, _DIGITS) + 0.0
        return f"{rounded:.{_DIGITS}f}".rstrip("0").rstrip(".")

    def _at(self, place: XY) -> str:
        return f"({self._number(place[0])},{self._number(place[1])})"

    def _line(self, points: tuple[XY, ...]) -> str:
        return " -- ".join(map(self._at, points))

    def _area(self, primitive: Primitive, points: tuple[XY, ...], width: float = 1.0) -> str:
        return self._path("path", self._faces(primitive, width), f"{self._line(points)} -- cycle")

    def _colour(self, colour: str) -> str:
        self.used[colour] = None
        return f"lw{colour[1:]}"

    def _faces(self, primitive: Primitive, width: float = 1.0) -> list[str]:
        style, fill = self.theme.styles[primitive.role], self.theme.fill(primitive)
        found = []
        if fill:
            found.append(f"fill={self._colour(fill)}")
            opacity = style.opacity ** (1 + primitive.fade)
            if opacity < 1.0:
                found.append(f"fill opacity={opacity:.3g}")
        return found + self._pen(primitive, width)

    def _pen(self, primitive: Primitive, width: float) -> list[str]:
        line = self.theme.line(primitive)
        if not line:
            return []
        style = self.theme.styles[primitive.role]
        wide = style.width * width * self.scene.measures.stroke * self.scale  # mm
        found = [f"draw={self._colour(line)}", f"line width={wide * _POINT:.3g}pt"]
        if style.dashes:
            pairs = zip(style.dashes[::2], style.dashes[1::2], strict=True)
            parts = (f"on {a * wide:.3g}mm off {b * wide:.3g}mm" for a, b in pairs)
            found.append(f"dash pattern={' '.join(parts)}")
        return found

    def _text(self, primitive: Text) -> str:
        anchor = ("base west", "base", "base east")[primitive.align + 1]
        size = max(_SMALLEST, primitive.height * self.scale * _POINT)
        options = [
            f"anchor={anchor}", "inner sep=0pt", f"text={self._colour(self.theme.fill(primitive))}",
            f"font=\\fontsize{{{size:.3g}}}{{{1.2 * size:.3g}}}\\selectfont",
        ]  # fmt: skip
        node = f"{{{as_latex(primitive.text)}}}"
        return f"  \\node[{', '.join(options)}] at {self._at(primitive.start)} {node};"
