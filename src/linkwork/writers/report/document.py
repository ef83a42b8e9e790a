"""Documents: sections of paragraphs, facts, equations, tables and figures, numbered."""

from __future__ import annotations

import re
import struct
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from importlib import resources
from typing import Literal
from xml.etree import ElementTree as Tree

from linkwork.core.drawing.matplotlib_writer import render
from linkwork.core.drawing.mechanism_scene import Sheet
from linkwork.core.drawing.scene import Scene
from linkwork.core.foundation.names import pretty
from linkwork.core.results.listing import Column
from linkwork.writers.charts.chart import Chart

_WIDTH = 88  # characters of a table in the type of the page
# after a digit, so that words such as "here" stay
_DECIMAL = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")
# of a number, not in a word or a range
_MINUS = re.compile(r"(?<![\w.)])-(?=\d)")
_DIGITS = 7  # of numbers in sentences
_POWER = re.compile(r"(?<=\d)e([-+]\d+)\b")
_SQUARE = re.compile(r"\^2(?!\d)")
_GAP = 3  # characters between columns
_WRAPPED = 30  # characters of a column of words, which are broken into lines
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_FIGURE_SPACE, _POINT_SPACE = "\u2007", "\u2008"  # as wide as a digit and as a point


@dataclass(frozen=True, kw_only=True)
class Text:
    """A text: a ``paragraph``, a ``note`` (a small heading), or a ``listing`` as it is written."""

    text: str
    style: Literal["paragraph", "note", "listing"] = "paragraph"


@dataclass(frozen=True, kw_only=True)
class Facts:
    """Labels with their texts; an empty label continues the one above.

    The texts of the labels in ``quoted`` are those of the file, shown as they are.
    """

    pairs: tuple[tuple[str, str], ...]
    quoted: frozenset[str] = frozenset()


@dataclass(frozen=True, kw_only=True)
class Equation:
    """An equation in MathML and in LaTeX, with its number."""

    mathml: str
    latex: str
    number: int = 0


_SHORT = 20  # rows


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table with its caption; all columns have the same number of cells."""

    caption: str
    columns: tuple[Column, ...]
    number: int = 0

    @property
    def is_short(self) -> bool:
        """Whether it is kept on one page."""
        return max((len(column.cells) for column in self.columns), default=0) <= _SHORT


@dataclass(frozen=True, kw_only=True, eq=False)
class Figure:
    """A picture with its caption."""

    caption: str
    picture: Scene | Chart | Sheet
    number: int = 0


Block = Text | Facts | Equation | Table | Figure


@dataclass(frozen=True, kw_only=True, eq=False)
class Section:
    """A heading and its blocks."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Document:
    """A title, lines about the author, and sections."""

    title: str
    byline: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]

    @property
    def author(self) -> str:
        """The author, if one is stated."""
        return dict(self.byline).get("author", "")

    @property
    def author_line(self) -> str:
        """The lines about the author as one."""
        return " · ".join(text for _, text in self.byline)

    @classmethod
    def numbered(
        cls, title: str, byline: tuple[tuple[str, str], ...], sections: Iterable[Section]
    ) -> Document:
        """The document with numbers for its equations, tables and figures."""
        counts: dict[type, int] = {}

        def number(block: Block) -> Block:
            match block:
                case Text(style="paragraph"):
                    return replace(block, text=_sentence(block.text))
                case Facts():
                    pairs = (
                        (label, text if label in block.quoted else _sentence(text))
                        for label, text in block.pairs
                    )
                    return replace(block, pairs=tuple(pairs))
                case Text():
                    return block
            count = counts[type(block)] = counts.get(type(block), 0) + 1
            if isinstance(block, Equation):
                return replace(block, number=count)
            return replace(block, number=count, caption=_sentence(block.caption))

        listed = tuple(
            replace(section, blocks=tuple(map(number, section.blocks))) for section in sections
        )
        return cls(title=title, byline=byline, sections=listed)


def template_text(name: str) -> str:
    """A file of the package that gives reports their look."""
    return resources.files(__package__).joinpath("templates", name).read_text("utf-8")


def split_columns(columns: Sequence[Column]) -> Iterator[tuple[Column, ...]]:
    """Tables as wide as a page; each begins with the first column."""
    first, *others = map(_with_units, columns)
    room = _WIDTH - _room(first)
    parts = _parts(others, room)
    # narrower tables of equal width, if they are not more
    for width in range(room // 2, room, _GAP):
        even = _parts(others, width)
        if len(even) == len(parts):
            parts = even
            break
    yield from ((first, *part) for part in parts)


def _parts(columns: Sequence[Column], room: int) -> list[list[Column]]:
    """Columns in groups that fit a width, at least one in each."""
    parts: list[list[Column]] = [[]]
    for column in columns:
        if parts[-1] and sum(map(_room, [*parts[-1], column])) > room:
            parts.append([])
        parts[-1].append(column)
    return parts


def _room(column: Column) -> int:
    most = max((_width(text) for text in (column.header, *column.cells)), default=0)
    return _GAP + (min(most, _WRAPPED) if column.align == "left" else most)


def _width(text: str) -> int:
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def shown_name(name: str) -> str:
    """A quantity with Greek letters: ``μ.velocity``."""
    base, point, rate = name.partition(".")
    return f"{pretty(base)}{point}{rate}"


def _with_units(column: Column) -> Column:
    """A column with its units in the header if they are equal, otherwise after its cells."""
    column = replace(column, header=_powers(column.header))
    units = set(map(_powers, column.units))
    if not any(units):
        return replace(column, units=())
    if len(units) == 1:
        return replace(column, header=f"{column.header} [{units.pop()}]", units=())
    cells = _at_point(column.cells) if column.align == "point" else column.cells
    joined = [
        f"{cell} {_powers(unit)}".rstrip() for cell, unit in zip(cells, column.units, strict=True)
    ]
    return Column(header=column.header, cells=joined)


def printed(column: Column) -> list[str]:
    """The cells as they are printed: decimal points below each other, powers of ten, true minus."""
    if column.align == "left":
        return list(column.cells)
    return _at_point(column.cells) if column.align == "point" else list(map(_number, column.cells))


def _at_point(cells: Sequence[str]) -> list[str]:
    shown = list(map(_number, cells))
    ends = [cell.partition(".")[2] for cell in shown]
    longest = max(map(len, ends), default=0)
    return [
        cell + (_POINT_SPACE if longest and not end else "") + _FIGURE_SPACE * (longest - len(end))
        for cell, end in zip(shown, ends, strict=True)
    ]


def _sentence(text: str) -> str:
    """A text with powers of ten, true minus signs, and numbers of at most seven digits."""
    return _MINUS.sub("\u2212", _powers(_DECIMAL.sub(_rounded, text)))


def _powers(text: str) -> str:
    """``1.5·10⁻⁷`` for 1.5e-07, and s² for s^2."""
    shown = _POWER.sub(lambda m: f"·10{str(int(m[1])).translate(_SUPERSCRIPTS)}", text)
    return _SQUARE.sub("²", shown)


def _rounded(match: re.Match[str]) -> str:
    text = match[0]
    return f"{float(text):.{_DIGITS}g}" if len(text.replace(".", "").lstrip("0")) > 8 else text


def _number(cell: str) -> str:
    """``−1.5·10⁻⁷`` for -1.5e-07, a dash for a missing number; words stay."""
    cell = _powers(cell)
    if cell == "-":
        return "–"
    return f"\u2212{cell[1:]}" if cell[:1] == "-" and cell[1:2].isdigit() else cell


# ----------------------------------------------------------------------
# The pictures of a report as bytes, with their printed size, and progress.


_DPI = 200.0  # twice that of a screen
_INCH, _POINTS = 25.4, 72.0  # [mm], [pt/in]
_WIDEST, _TALLEST = 150.0, 104.0  # printed [mm]: a heading and two figures fit a page
_SIDES = [re.compile(rb'<svg [^>]*\b%s="([\d.]+)pt"' % side) for side in (b"width", b"height")]


def figure_files(
    document: Document, kind: str, progress: Callable[[float], None]
) -> Iterator[tuple[int, bytes, float]]:
    """The number, the content, ``svg`` or ``png``, and the printed width [mm] of every figure."""
    figures = [b for section in document.sections for b in section.blocks if isinstance(b, Figure)]
    for k, figure in enumerate(figures, 1):
        content = render(figure.picture, kind, dpi=_DPI)
        wide, high = _size(content)
        width = wide * min(1.0, _WIDEST / wide, _TALLEST / high)
        yield figure.number, content, width
        progress(k / len(figures))


def _size(content: bytes) -> tuple[float, float]:
    """Width and height [mm]."""
    if content.startswith(b"\x89PNG"):
        wide, high = struct.unpack(">II", content[16:24])
        return wide * _INCH / _DPI, high * _INCH / _DPI
    wide, high = (float(side.findall(content)[0]) for side in _SIDES)
    return wide * _INCH / _POINTS, high * _INCH / _POINTS


# ----------------------------------------------------------------------
# Equations of MathML as terms, in the languages of Word and Typst, so that lines can break.


_BREAKS = ("+", "\u2212", "=")
_SILENT = ("\u2061", "\u2062")  # application of a function, times
_SPACE = '<mspace width="0.17em"/>'


def mathml_terms(mathml: str) -> list[str]:
    """The terms of a ``<math>`` element, each as an element that begins with its sign."""
    terms: list[str] = []
    for parts in _terms(mathml):
        lead = parts[0]
        if lead.tag == "mo" and len(terms):
            lead.set("form", "infix")
        inside = "".join(Tree.tostring(part, encoding="unicode") for part in parts)
        for silent in _SILENT:  # browsers leave no room for them
            inside = inside.replace(f"<mo>{silent}</mo>", _SPACE)
        terms.append(f"<math>{inside}</math>")
    return terms


def office_terms(mathml: str) -> list[str]:
    """The terms as runs of Office MathML, each the content of an ``m:oMath`` element.

    No term begins with an equals sign, which LibreOffice shows as an error.
    """
    terms: list[str] = []
    for parts in _terms(mathml):
        shown = "".join(_translated(part, _office_letter, _OFFICE) for part in parts)
        if terms and parts[0].tag == "mo" and parts[0].text == "=":
            terms[-1] += shown
        else:
            terms.append(shown)
    return terms


def typst_terms(mathml: str) -> list[str]:
    """The terms in the notation of formulas of Typst."""
    return [
        " ".join(filter(None, (_translated(part, _typst_letter, _TYPST) for part in parts)))
        for parts in _terms(mathml)
    ]


def _terms(mathml: str) -> Iterator[list[Tree.Element]]:
    """The elements of an equation, divided before every sign between terms."""
    here: list[Tree.Element] = []
    for part in Tree.fromstring(mathml):
        sign = part.tag == "mo" and part.text in _BREAKS
        # a sign after an equals sign belongs to the same term
        if sign and here and not (here[-1].tag == "mo" and here[-1].text in _BREAKS):
            yield here
            here = []
        here.append(part)
    yield here


#: Elements of MathML in the two languages: 0 and 1 are their children, ``all`` is everything.
_OFFICE = {
    "msub": "<m:sSub><m:e>{0}</m:e><m:sub>{1}</m:sub></m:sSub>",
    "msup": "<m:sSup><m:e>{0}</m:e><m:sup>{1}</m:sup></m:sSup>",
    "mfrac": "<m:f><m:num>{0}</m:num><m:den>{1}</m:den></m:f>",
    "msqrt": '<m:rad><m:radPr><m:degHide m:val="1"/></m:radPr><m:deg/><m:e>{all}</m:e></m:rad>',
}
_TYPST = {
    "msub": "attach({0}, b: {1})",
    "msup": "attach({0}, t: {1})",
    "mfrac": "frac({0}, {1})",
    "msqrt": "sqrt({all})",
}
_TYPST_SIGNS = {"\u2212": "minus", "+": "plus", "=": "eq", "\u2032": "prime"}


def _translated(
    part: Tree.Element, letter: Callable[[str, str], str], forms: Mapping[str, str]
) -> str:
    """An element in another language: ``letter`` writes a text with its tag."""
    if part.tag in ("mi", "mn", "mo"):
        return letter(part.tag, part.text or "")
    inside = [shown for child in part if (shown := _translated(child, letter, forms))]
    return forms.get(part.tag, "{all}").format(*inside, all=" ".join(inside))


def _office_letter(tag: str, text: str) -> str:
    if text in _SILENT:
        return ""
    # names of several letters and numbers are upright
    plain = tag != "mi" or len(text) > 1
    style = '<m:rPr><m:sty m:val="p"/></m:rPr>' if plain else ""
    return f"<m:r>{style}<m:t>{escape(text)}</m:t></m:r>"


def _typst_letter(tag: str, text: str) -> str:
    if text in _SILENT:
        return "thin" if text == _SILENT[1] else ""
    quoted = '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if tag == "mi":
        return f"italic({quoted})" if len(text) == 1 else f"upright({quoted})"
    return quoted if tag == "mn" else _TYPST_SIGNS.get(text, quoted)
