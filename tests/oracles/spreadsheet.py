"""A spreadsheet that calculates: reads an .xlsx file and evaluates its formulas on demand.

Written from the rules of spreadsheets, not from Linkwork's writer: a sign binds more tightly than
``^``, which goes from left to right; a defined name without ``$`` moves with the cell that asks.
"""

from __future__ import annotations

import math
import operator
import re
import sys
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
sys.setrecursionlimit(20_000)  # a formula asks for those that it uses
_CELL = re.compile(r"(\$?)([A-Z]+)(\$?)(\d+)")


def _parts(cell: str) -> tuple[str, str, str, str]:
    """The marks of what is fixed, each before the column and the row of a cell."""
    found = _CELL.fullmatch(cell)
    assert found is not None, cell
    return found[1], found[2], found[3], found[4]


class CellError(Exception):
    """An error value such as #N/A; it spreads to the formulas that use it."""


def _numbers(*given: Any) -> list[float]:
    """The numbers among arguments; texts and empty cells of areas do not count."""
    found = []
    for one in given:
        for entry in one.flat if isinstance(one, np.ndarray) else [one]:
            if isinstance(entry, CellError):
                raise entry
            if isinstance(entry, int | float):
                found.append(float(entry))
    return found


def _matrix(area: Any) -> Any:
    _numbers(area)
    return np.array([[0.0 if e is None else e for e in row] for row in area], dtype=float)


def _difference_squares(a: Any, b: Any) -> float:
    pairs = zip(a.flat, b.flat, strict=True)
    numbers = [pair for pair in pairs if len(_numbers(*pair)) == 2]
    return float(sum((x - y) ** 2 for x, y in numbers))


def _count_if(area: Any, wanted: str) -> int:
    begin, star, _ = wanted.partition("*")
    texts = [e for e in area.flat if isinstance(e, str)]
    return sum(t.startswith(begin) if star else t == wanted for t in texts)


def _inverse(area: Any) -> Any:
    try:
        return np.linalg.inv(_matrix(area))
    except np.linalg.LinAlgError:
        raise CellError("#NUM!") from None


_FUNCTIONS: dict[str, Any] = {
    "COS": math.cos, "SIN": math.sin, "TAN": math.tan, "ASIN": math.asin, "ACOS": math.acos,
    "ATAN": math.atan, "ATAN2": lambda x, y: math.atan2(y, x), "RADIANS": math.radians,
    "DEGREES": math.degrees, "SQRT": math.sqrt, "EXP": math.exp, "LN": math.log,
    "LOG10": math.log10, "ABS": abs, "PI": lambda: math.pi,
    "MIN": lambda *given: min(_numbers(*given)), "MAX": lambda *given: max(_numbers(*given)),
    "SUM": lambda *given: sum(_numbers(*given)),
    "COUNT": lambda *given: sum(isinstance(e, int | float) for e in given),
    "SUMSQ": lambda *given: sum(x**2 for x in _numbers(*given)),
    "SUMXMY2": _difference_squares, "MINVERSE": _inverse,
    "MMULT": lambda a, b: np.matmul(_matrix(a), _matrix(b)),
    "SUMPRODUCT": lambda a, b: float((_matrix(a) * _matrix(b)).sum()),
    "INDEX": lambda area, n: area.flat[int(n) - 1], "AND": lambda *given: all(given),
    "COUNTIF": _count_if,
}  # fmt: skip
_OPERATIONS: dict[str, Any] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv,
    "^": operator.pow,
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
            found = self.signed()
            return found if isinstance(found, CellError) else -found
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
            return self.call(text, given)
        return self.named(text)

    def call(self, function: str, given: list[Any]) -> Any:
        match function:
            case "NA":
                return CellError("#N/A")
            case "ISNUMBER":
                return isinstance(given[0], int | float)
            case "IFERROR":
                return given[1] if isinstance(given[0], CellError) else given[0]
            case "IF" if not isinstance(given[0], CellError):
                return given[1] if given[0] else given[2]
        for argument in given:
            if isinstance(argument, CellError) and function != "COUNT":
                return argument
        try:
            found = _FUNCTIONS[function](*given)
        except CellError as error:
            return error
        except (ValueError, OverflowError, ZeroDivisionError):
            return CellError("#NUM!")
        return found

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
        rows = [
            [self.book[sheet, f"{get_column_letter(column)}{row}"] for column in columns]
            for row in range(int(top), int(bottom) + 1)
        ]
        return np.array(rows, dtype=object)


def _combined(sign: str, left: Any, right: Any) -> Any:
    for side in (left, right):
        if isinstance(side, CellError):
            return side
    left, right = (0.0 if side is None else side for side in (left, right))
    if sign in ("<", "<=", ">", ">=", "=", "<>"):
        return _compared(sign, left, right)
    if isinstance(left, str) or isinstance(right, str):
        return CellError("#VALUE!")
    left, right = (_matrix(s) if isinstance(s, np.ndarray) else s for s in (left, right))
    try:
        return _OPERATIONS[sign](left, right)
    except (ZeroDivisionError, OverflowError):
        return CellError("#DIV/0!")


def _compared(sign: str, left: Any, right: Any) -> bool:
    """Texts are larger than all numbers, and equal without regard to capitals."""
    mine, other = (
        (isinstance(side, str), side.casefold() if isinstance(side, str) else side)
        for side in (left, right)
    )
    return {
        "<": mine < other, "<=": mine <= other, ">": mine > other, ">=": mine >= other,
        "=": mine == other, "<>": mine != other,
    }[sign]  # fmt: skip
