"""Plain tables for a terminal: numbers as text, columns aligned at the decimal point."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

__all__ = ["WIDTH", "Column", "fixed", "lengths", "short", "significant", "table_lines"]

#: Characters of a line of output.
WIDTH = 80

_GAP = 2
_INDENT = 2
_ANGLE_DECIMALS = 6
_LENGTH_DIGITS = 6
_NOTHING = "-"  # printed for a missing number


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column of text; ``align`` is ``left``, ``right`` or ``point`` (the decimal point).

    ``units``, if given, are printed after the cells, one for each cell.
    """

    header: str
    cells: Sequence[str]
    align: str = "left"
    units: Sequence[str] = ()

    @property
    def lines(self) -> list[str]:
        """The header and the cells, padded to one width."""
        cells = _at_point(self.cells) if self.align == "point" else list(self.cells)
        width = max(map(_width, (self.header, *cells)))
        lines = [_padded(cell, width, self.align != "left") for cell in (self.header, *cells)]
        if not any(self.units):
            return lines
        room = max(map(_width, self.units))
        units = [_padded(unit, room, False) for unit in ("", *self.units)]
        return [f"{line} {unit}" for line, unit in zip(lines, units, strict=True)]


def table_lines(columns: Sequence[Column], width: int = WIDTH) -> list[str]:
    """The lines of a table, header first.

    Columns that do not fit the width follow below, after the first column repeated. If even
    two columns are too wide, the cells of the first column are shortened.
    """
    first, *others = columns
    lines: list[str] = []
    while True:
        widest = max((_width(column.lines[0]) for column in others[:1]), default=0)
        first = _shortened(first, width - _INDENT - _GAP - widest)
        used = _INDENT + _width(first.lines[0])
        count = 0
        for column in others:
            used += _GAP + _width(column.lines[0])
            # at least one column in each block, however wide
            if used > width and count:
                break
            count += 1
        here, others = [first, *others[:count]], others[count:]
        joined = zip(*(column.lines for column in here), strict=True)
        lines += [(" " * _INDENT + (" " * _GAP).join(cells)).rstrip() for cells in joined]
        if not others:
            return lines
        lines.append("")


def fixed(value: float, decimals: int = _ANGLE_DECIMALS) -> str:
    """A number with so many decimals, without a negative zero."""
    if not math.isfinite(value):
        return _NOTHING
    text = f"{value:.{decimals}f}"
    # rounding -0.0000001 gives "-0.000000"
    return text.lstrip("-") if float(text) == 0 else text


def lengths(values: Iterable[float]) -> list[str]:
    """Lengths with common decimals: so many that the largest shows six significant digits."""
    numbers = list(values)
    largest = max((abs(v) for v in numbers if math.isfinite(v)), default=0.0)
    # fixed decimals would show zeros only, or a row of meaningless digits
    if largest and not 1e-6 <= largest < 1e9:
        return [significant(v, _LENGTH_DIGITS) for v in numbers]
    decimals = max(_LENGTH_DIGITS - 1 - _exponent(largest), 0)
    return [fixed(v, decimals) for v in numbers]


def significant(value: float, digits: int = 6, noise: float = 0.0) -> str:
    """A number with so many significant digits; 0 where it is at most ``noise``."""
    if not math.isfinite(value):
        return _NOTHING
    if abs(value) <= noise:
        return "0"
    exponent = _exponent(value)
    if -4 <= exponent < max(digits, 7):
        return f"{value:.{max(digits - 1 - exponent, 0)}f}"
    return f"{value:.{digits - 1}e}"


def short(value: float) -> str:
    """A number with at most ten significant digits, without trailing zeros."""
    return f"{value:.10g}" if math.isfinite(value) else _NOTHING


def _exponent(value: float) -> int:
    """The decimal exponent after rounding to six digits: 2 for 100 and for 99.99999."""
    return int(f"{value:.{_LENGTH_DIGITS - 1}e}".partition("e")[2])


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
        # combining marks take no cell of their own, East Asian characters two
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in "WF" else 1
        for c in text
    )
