"""SVG and TikZ."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape
from math import floor, log10

from linkwork.core.drawing.scene import (
    DARK,
    LIGHT,
    XY,
    Arc,
    Box,
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

# ----------------------------------------------------------------------
# Scenes as SVG elements for HTML, with colours that follow the light or dark page.
#
# Colours are custom properties named by their light and dark values, ``--lw-0072B2-607AEA``, so
# several pictures on one page do not conflict. The elements use no identifiers, scripts or external
# files.


_FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Noto Sans','DejaVu Sans',sans-serif"
_FLATTEST = 0.36  # minimum ratio of the sides of a picture
_HALO = 0.22  # width of the outline that keeps a name legible on lines [em]
_MARGIN = 0.02  # margin as a fraction of the size


class Inks:
    """The colours of the pictures on a page, each as a pair of light and dark."""

    def __init__(self) -> None:
        self._pairs: dict[str, tuple[str, str]] = {}

    def of(self, light: str, dark: str) -> str:
        """A colour in CSS; ``none`` for an empty one."""
        if not light:
            return "none"
        name = f"--lw-{light[1:]}-{dark[1:]}"
        self._pairs[name] = (light, dark)
        return f"var({name},{light})"

    def rules(self, scope: str) -> str:
        """The style sheet that defines all colours inside elements of a class.

        The theme of the page (Jupyter, VS Code, Colab) takes precedence over that of the system.
        """
        light, dark = (
            "".join(f"{name}:{pair[k]};" for name, pair in self._pairs.items()) for k in (0, 1)
        )
        light, dark = f"{light}color-scheme:light", f"{dark}color-scheme:dark"
        return (
            f".{scope}{{{light}}}"
            f"@media (prefers-color-scheme:dark){{.{scope}{{{dark}}}}}"
            f"{_under(_LIGHT_PAGES, scope)}{{{light}}}"
            f"{_under(_DARK_PAGES, scope)}{{{dark}}}"
        )


class FixedInks(Inks):
    """The colours of the light or the dark theme alone, for files."""

    def __init__(self, *, dark: bool = False) -> None:
        super().__init__()
        self._dark = dark

    def of(self, light: str, dark: str) -> str:
        """A colour in CSS; ``none`` for an empty one."""
        return (dark if self._dark else light) or "none"


_LIGHT_PAGES = ("[data-jp-theme-light=true]", "body.vscode-light", "html[theme=light]")
_DARK_PAGES = ("[data-jp-theme-light=false]", "body.vscode-dark", "html[theme=dark]")


def _under(pages: tuple[str, ...], scope: str) -> str:
    return ",".join(f"{page} .{scope}" for page in pages)


def inline_svg(
    scene: Scene, inks: Inks, *, longest: float = 400.0, view: Box | None = None, digits: int = 5
) -> str:
    """A scene as an ``<svg>`` element.

    Parameters
    ----------
    inks : Inks
        Collects the colours; its rules must be added to the page.
    longest : float
        The displayed longer side [CSS pixels]; narrower pages reduce it.
    view : Box, optional
        The displayed part of the plane; by default the box of the scene.
    digits : int
        Digits of coordinates, relative to the size of the picture.
    """
    shown = _not_flat((view or scene.box).grown(_MARGIN * scene.measures.size))
    writer = _SvgWriter(inks, scene.measures.stroke, max(shown.width, shown.height), digits)
    scale = longest / writer.size
    name = ": ".join(filter(None, (scene.title, scene.caption)))
    box = " ".join(map(writer.number, (shown.left, -shown.top, shown.width, shown.height)))
    parts = "".join(part for primitive in scene.primitives for part in writer.drawn(primitive))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{escape(name)}" '
        f'viewBox="{box}" width="{scale * shown.width:.0f}" height="{scale * shown.height:.0f}" '
        'style="max-width:100%;height:auto;stroke-linecap:round;stroke-linejoin:round;'
        f'font-family:{_FONT}">{parts}</svg>'
    )


def _not_flat(box: Box) -> Box:
    """The box, its shorter side enlarged so that a flat mechanism has room above and below."""
    least = _FLATTEST * max(box.width, box.height)
    return box.sized(max(least, box.width), max(least, box.height))


class _SvgWriter:
    """Translates primitives into elements, with the y axis pointing down."""

    def __init__(self, inks: Inks, stroke: float, size: float, digits: int) -> None:
        self.inks, self.stroke, self.size = inks, stroke, size
        self.places = digits - floor(log10(size)) - 1

    def number(self, value: float) -> str:
        """A length, rounded to visible digits."""
        rounded = round(value, self.places) + 0.0  # no negative zero
        return (
            f"{rounded:.{max(self.places, 0)}f}".rstrip("0").rstrip(".")
            if rounded % 1
            else (f"{rounded:.0f}")
        )

    def drawn(self, primitive: Primitive) -> Iterator[str]:
        """The elements of a primitive."""
        match primitive:
            case Polyline() | Arc():
                yield self._line([primitive.shaft], primitive)
                if primitive.arrow_head:
                    yield self._area(primitive.arrow_head, primitive, width=0.3)
            case Hatch():
                yield self._line(list(primitive.strokes), primitive)
            case Polygon():
                yield self._area(primitive.points, primitive)
            case Disc():
                x, y = primitive.centre
                yield (
                    f'<circle cx="{self.number(x)}" cy="{self.number(-y)}" '
                    f'r="{self.number(primitive.radius)}" {self._faces(primitive)}/>'
                )
            case Text():
                yield self._text(primitive)

    def _line(self, lines: list[tuple[XY, ...]], primitive: Primitive) -> str:
        path = "".join(f"M{self._corners(line)}" for line in lines)
        width = 1 - 0.5 * primitive.fade
        return f'<path d="{path}" style="fill:none;{self._pen(primitive, width)}"/>'

    def _area(self, points: tuple[XY, ...], primitive: Primitive, width: float = 1.0) -> str:
        return f'<path d="M{self._corners(points)}Z" {self._faces(primitive, width)}/>'

    def _corners(self, points: tuple[XY, ...]) -> str:
        return " ".join(f"{self.number(x)},{self.number(-y)}" for x, y in points)

    def _faces(self, primitive: Primitive, width: float = 1.0) -> str:
        style = LIGHT.styles[primitive.role]
        fill = self.inks.of(LIGHT.fill(primitive), DARK.fill(primitive))
        opacity = style.opacity ** (1 + primitive.fade)
        clear = f";fill-opacity:{opacity:.3g}" if opacity < 1 else ""
        return f'style="fill:{fill}{clear};{self._pen(primitive, width)}"'

    def _pen(self, primitive: Primitive, width: float) -> str:
        line = self.inks.of(LIGHT.line(primitive), DARK.line(primitive))
        if line == "none":
            return "stroke:none"
        style = LIGHT.styles[primitive.role]  # line styles are the same in every theme
        wide = style.width * width * self.stroke
        dashes = ",".join(self.number(part * wide) for part in style.dashes)
        return (
            f"stroke:{line};stroke-width:{self.number(wide)}"
            f"{f';stroke-dasharray:{dashes}' if dashes else ''}"
        )

    def _text(self, primitive: Text) -> str:
        x, y = primitive.start
        anchor = ("start", "middle", "end")[primitive.align + 1]
        fill = self.inks.of(LIGHT.fill(primitive), DARK.fill(primitive))
        page = self.inks.of(LIGHT.background, DARK.background)
        halo = f"paint-order:stroke;stroke:{page};"
        return (
            f'<text x="{self.number(x)}" y="{self.number(-y)}" text-anchor="{anchor}" '
            f'style="font-size:{self.number(primitive.height)}px;fill:{fill};'
            f'{halo}stroke-width:{self.number(_HALO * primitive.height)}">'
            f"{escape(primitive.text)}</text>"
        )


# ----------------------------------------------------------------------
# An SVG file as a part of a page, whose names and styles act on nothing else there.


_IDENTIFIER = re.compile(r'(\bid="|url\(#|href="#)')


def embedded_svg(picture: bytes, own: str, label: str) -> str:
    """The element of an SVG file.

    ``own``: a name that no other picture of the page has; ``label``: what it shows.
    """
    text = picture.decode()
    text = text[text.index("<svg") :].strip()
    # identifiers and the style sheet of one picture must not act on another
    text = _IDENTIFIER.sub(lambda match: f"{match[1]}{own}-", text)
    text = text.replace("*{", f"#{own} *{{", 1).replace("<svg ", f'<svg id="{own}" ', 1)
    return text.replace("<svg ", f'<svg role="img" aria-label="{escape(label)}" ', 1)


# ----------------------------------------------------------------------
# Scenes as TikZ pictures for LaTeX documents, in a scale that the first comment states.


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
    writer = _TikzWriter(scene, theme, scale)
    drawn = [line for primitive in scene.primitives for line in writer.drawn(primitive)]
    head = comment_lines(
        ": ".join(filter(None, (scene.title, scene.caption))),
        f"Written by Linkwork, {said}: needs \\usepackage{{tikz}}.",
    )
    begin = "\\begin{tikzpicture}[x=1mm, y=1mm, line cap=round, line join=round]"
    lines = [*head, begin, *writer.colours(), *drawn, "\\end{tikzpicture}"]
    return "\n".join(lines) + "\n"


@dataclass
class _TikzWriter:
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
