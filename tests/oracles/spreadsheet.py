"""A spreadsheet that calculates: reads an .xlsx file and evaluates its formulas on demand.

Written from the rules of spreadsheets, not from Linkwork's writer: a sign binds more tightly than
``^``, which goes from left to right; a defined name without ``$`` moves with the cell that asks.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
from openpyxl.utils import column_index_from_string, get_column_letter

_TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+\.?\d*(?:E[+-]?\d+)?)|(?P<text>\"[^\"]*\")"
    r"|(?P<cell>(?:[A-Za-z]+!)?\$?[A-Z]{1,3}\$?\d+(?::\$?[A-Z]{1,3}\$?\d+)?(?![\w.(]))"
    r"|(?P<name>[^\W\d][\w.]*)|(?P<sign><=|>=|<>|[-+*/^(){};,<>=]))"
)
_CELL = re.compile(r"(\$?)([A-Z]+)(\$?)(\d+)")


def _parts(cell: str) -> tuple[str, str, str, str]:
    """The marks of what is fixed, each before the column and the row of a cell."""
    found = _CELL.fullmatch(cell)
    assert found is not None, cell
    return found[1], found[2], found[3], found[4]


_FUNCTIONS: dict[str, Any] = {
    "COS": math.cos, "SIN": math.sin, "TAN": math.tan, "ASIN": math.asin, "ACOS": math.acos,
    "ATAN": math.atan, "ATAN2": lambda x, y: math.atan2(y, x), "RADIANS": math.radians,
    "DEGREES": math.degrees, "SQRT": math.sqrt, "EXP": math.exp, "LN": math.log,
    "LOG10": math.log10, "ABS": abs, "PI": lambda: math.pi, "MIN": min, "MAX": max,
    "SUMSQ": lambda area: float((area**2).sum()), "MINVERSE": np.linalg.inv, "MMULT": np.matmul,
    "SUMPRODUCT": lambda a, b: float((a * b).sum()),
    "ISNUMBER": lambda x: isinstance(x, int | float),
    "INDEX": lambda area, n: float(area.flat[int(n) - 1]), "NA": lambda: math.nan,
    "IF": lambda condition, yes, no: yes if condition else no,
}  # fmt: skip
_LEVELS = [("<", ">", "=", "<=", ">=", "<>"), ("+", "-"), ("*", "/"), ("^",)]


class Spreadsheet:
    """The cells of a workbook; ``sheet["Cycle", "C7"]`` is calculated from the yellow cells."""

    def __init__(self, path: Path) -> None:
        self.book = openpyxl.load_workbook(path)
        self.names = {n.casefold(): d.attr_text for n, d in self.book.defined_names.items()}
        self._known: dict[tuple[str, str], Any] = {}

    def set(self, name: str, value: float) -> None:
        """Type a number into the cell of a name."""
        sheet, cell = self.names[name.casefold()].replace("$", "").split("!")
        self.book[sheet][cell].value = value
        self._known.clear()

    def __getitem__(self, place: tuple[str, str]) -> Any:
        if place not in self._known:
            sheet, cell = place
            written = self.book[sheet][cell].value
            formula = isinstance(written, str) and written.startswith("=")
            row = int(_parts(cell)[3])
            self._known[place] = (
                _Formula(self, sheet, row, written[1:]).value() if formula else written
            )
        return self._known[place]

    def column(self, sheet: str, title: str) -> list[Any]:
        """All cells below a heading of row 5, the units left out."""
        cells = self.book[sheet]
        column = next(c.column_letter for c in cells[5] if c.value == title)
        return [self[sheet, f"{column}{row}"] for row in range(7, cells.max_row + 1)]


def calculated(text: str) -> Any:
    """A formula without cells."""
    return _Formula(None, "", 1, text).value()


class _Formula:
    def __init__(self, book: Any, sheet: str, row: int, text: str) -> None:
        self.book, self.sheet, self.row = book, sheet, row
        self.tokens: list[tuple[str, str]] = []
        at = 0
        while at < len(text):
            found = _TOKEN.match(text, at)
            assert found is not None, text[at:]
            assert found.lastgroup is not None
            self.tokens.append((found.lastgroup, found[found.lastgroup]))
            at = found.end()
        self.at = 0

    def value(self) -> Any:
        found = self.level(0)
        assert self.at == len(self.tokens), self.tokens[self.at :]
        return found

    def take(self, *signs: str) -> str | None:
        if self.at < len(self.tokens):
            kind, text = self.tokens[self.at]
            if kind == "sign" and text in signs:
                self.at += 1
                return text
        return None

    def level(self, depth: int) -> Any:
        if depth == len(_LEVELS):
            return self.signed()
        found = self.level(depth + 1)
        while (sign := self.take(*_LEVELS[depth])) is not None:
            found = _combined(sign, found, self.level(depth + 1))
        return found

    def signed(self) -> Any:
        if self.take("-"):
            return -self.signed()
        return self.signed() if self.take("+") else self.atom()

    def atom(self) -> Any:
        if self.take("("):
            found = self.level(0)
            assert self.take(")")
            return found
        if self.take("{"):
            return self.array()
        kind, text = self.tokens[self.at]
        self.at += 1
        if kind == "number":
            return float(text)
        if kind == "text":
            return text[1:-1]
        if kind == "cell":
            return self.cells(text)
        if self.take("("):
            given = []
            while not self.take(")"):
                given.append(self.level(0))
                self.take(",")
            return _FUNCTIONS[text](*given)
        return self.named(text)

    def array(self) -> Any:
        rows: list[list[float]] = [[]]
        while not self.take("}"):
            rows[-1].append(self.signed())
            if self.take(";"):
                rows.append([])
            self.take(",")
        return np.array(rows)

    def named(self, name: str) -> Any:
        sheet, cell = self.book.names[name.casefold()].split("!")
        fixed_column, letters, fixed_row, number = _parts(cell)
        assert fixed_column == "$", cell
        row = int(number) if fixed_row else int(number) + self.row - 1
        return self.book[sheet, f"{letters}{row}"]

    def cells(self, text: str) -> Any:
        own, mark, area = text.rpartition("!")
        sheet = own if mark else self.sheet
        first, _, last = area.replace("$", "").partition(":")
        if not last:
            return self.book[sheet, first]
        (_, left, _, top), (_, right, _, bottom) = (_parts(corner) for corner in (first, last))
        columns = range(column_index_from_string(left), column_index_from_string(right) + 1)
        return np.array(
            [
                [self.book[sheet, f"{get_column_letter(column)}{row}"] for column in columns]
                for row in range(int(top), int(bottom) + 1)
            ],
            dtype=float,
        )


def _combined(sign: str, left: Any, right: Any) -> Any:
    match sign:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case "/":
            return left / right
        case "^":
            return left**right
        case "<":
            return left < right
        case _:
            raise NotImplementedError(sign)
