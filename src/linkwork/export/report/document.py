"""Documents: sections of paragraphs, facts, equations, tables and figures, numbered."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from linkwork.drawing import Chart, Scene, Sheet
from linkwork.foundation.names import pretty
from linkwork.results.listing.column import Column

__all__ = [
    "Block", "Document", "Equation", "Facts", "Figure", "Listing", "Note", "Paragraph", "Section",
    "Table", "printed", "shown_name", "split_columns",
]  # fmt: skip

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
class Paragraph:
    """A paragraph of text."""

    text: str


@dataclass(frozen=True, kw_only=True)
class Note:
    """A small heading before the following blocks."""

    text: str


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


@dataclass(frozen=True, kw_only=True)
class Listing:
    """A text shown as it is written."""

    text: str


Block = Paragraph | Note | Facts | Equation | Table | Figure | Listing


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

    @classmethod
    def numbered(
        cls, title: str, byline: tuple[tuple[str, str], ...], sections: Iterable[Section]
    ) -> Document:
        """The document with numbers for its equations, tables and figures."""
        counts: dict[type, int] = {}

        def number(block: Block) -> Block:
            if isinstance(block, Paragraph):
                return Paragraph(text=_sentence(block.text))
            if isinstance(block, Facts):
                pairs = (
                    (label, text if label in block.quoted else _sentence(text))
                    for label, text in block.pairs
                )
                return replace(block, pairs=tuple(pairs))
            if not isinstance(block, Equation | Table | Figure):
                return block
            own = counts[type(block)] = counts.get(type(block), 0) + 1
            if isinstance(block, Equation):
                return replace(block, number=own)
            return replace(block, number=own, caption=_sentence(block.caption))

        listed = tuple(
            replace(section, blocks=tuple(map(number, section.blocks))) for section in sections
        )
        return cls(title=title, byline=byline, sections=listed)


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
    own, point, rate = name.partition(".")
    return f"{pretty(own)}{point}{rate}"


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
