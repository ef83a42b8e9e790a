"""Plain tables for a terminal: numbers as text, columns aligned at the decimal point."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

from linkwork.results.listing.column import Column

__all__ = ["WIDTH", "table_lines"]

#: Characters of a line of output.
WIDTH = 80

_GAP = 2
_INDENT = 2


def table_lines(columns: Sequence[Column], width: int = WIDTH) -> list[str]:
    """The lines of a table, header first.

    Columns that do not fit the width follow below, after the first column repeated. If even
    two columns are too wide, the cells of the first column are shortened. No columns, no lines.
    """
    if not columns:
        return []
    first, *others = columns
    lines: list[str] = []
    while True:
        widest = max((_width(_lines(column)[0]) for column in others[:1]), default=0)
        first = _shortened(first, width - _INDENT - _GAP - widest)
        used = _INDENT + _width(_lines(first)[0])
        count = 0
        for column in others:
            used += _GAP + _width(_lines(column)[0])
            # at least one column in each block, of any width
            if used > width and count:
                break
            count += 1
        here, others = [first, *others[:count]], others[count:]
        joined = zip(*map(_lines, here), strict=True)
        lines += [(" " * _INDENT + (" " * _GAP).join(cells)).rstrip() for cells in joined]
        if not others:
            return lines
        lines.append("")


def _lines(column: Column) -> list[str]:
    """The header and the cells, padded to one width."""
    cells = _at_point(column.cells) if column.align == "point" else list(column.cells)
    width = max(map(_width, (column.header, *cells)))
    lines = [_padded(cell, width, column.align != "left") for cell in (column.header, *cells)]
    if not any(column.units):
        return lines
    room = max(map(_width, column.units))
    units = [_padded(unit, room, False) for unit in ("", *column.units)]
    return [f"{line} {unit}" for line, unit in zip(lines, units, strict=True)]


def _at_point(cells: Sequence[str]) -> list[str]:
    """Cells padded on both sides so that decimal points align."""
    wholes = [cell.partition(".")[0] for cell in cells]
    parts = [cell[len(whole) :] for cell, whole in zip(cells, wholes, strict=True)]
    left = max(map(len, wholes), default=0)
    right = max(map(len, parts), default=0)
    return [f"{w:>{left}}{p:<{right}}" for w, p in zip(wholes, parts, strict=True)]


def _shortened(column: Column, room: int) -> Column:
    cells = [_cut(cell, max(room, 8)) for cell in column.cells]
    return Column(header=column.header, cells=cells, align=column.align)


def _cut(text: str, room: int) -> str:
    """The text with its middle replaced by … if it is too long."""
    if _width(text) <= room:
        return text
    head = (room - 1) // 2
    return f"{text[:head]}…{text[len(text) - (room - 1 - head) :]}"


def _padded(text: str, width: int, right: bool) -> str:
    space = " " * (width - _width(text))
    return space + text if right else text + space


def _width(text: str) -> int:
    """The number of terminal cells that the text occupies."""
    return sum(
        # combining marks take no cell, East Asian characters two
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1
        for c in text
    )
