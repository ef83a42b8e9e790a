"""Formulas in spreadsheet notation, and their values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from linkwork.expression.grammar import CONSTANTS
from linkwork.expression.lane_functions import FUNCTIONS
from linkwork.expression.precedence import ATOM, COMPARISONS, STRENGTH, strength
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.foundation.angles import AngleUnit

__all__ = ["CellFormula", "cell_number"]

_OF_ANGLE = ("sin", "cos", "tan")
_TO_ANGLE = ("asin", "acos", "atan", "atan2")
_CONVERSIONS: dict[str, Callable[..., Any]] = {"radians": np.radians, "degrees": np.degrees}


@dataclass(frozen=True)
class CellFormula:
    """A formula with its angle unit.

    Parameters
    ----------
    node : Node
        May call ``radians`` and ``degrees``.
    unit : AngleUnit
        Unit of the arguments of sin, cos, tan and of the results of asin, acos, atan, atan2.
    """

    node: Node
    unit: AngleUnit = AngleUnit.RADIAN

    def text(self, cells: Mapping[str, str]) -> str:
        """The formula in spreadsheet notation without equals sign; ``cells`` by name."""
        return _Writer(cells, self.unit is AngleUnit.DEGREE).text(self.node)

    def value(self, names: Mapping[str, Any]) -> Any:
        """The value, element by element; NaN if undefined."""
        with np.errstate(all="ignore"):
            return _value(self.node, names, self.unit.radians)


@dataclass(frozen=True)
class _Writer:
    """Spreadsheet precedence: a sign binds tighter than ``^``, which is left-associative."""

    cells: Mapping[str, str]
    degrees: bool

    def text(self, node: Node) -> str:
        match node:
            case Number():
                return cell_number(node.value)
            case Name():
                return self._name(node)
            case Negative():
                # in a spreadsheet -a^2 is (-a)^2
                least = ATOM if _begins_with_power(node.operand) else STRENGTH["*"]
                return "-" + self._inside(node.operand, least)
            case Call():
                return self._call(node.function, [self.text(part) for part in node.arguments])
            case Binary() if node.operator in COMPARISONS:
                # a comparison alone would be TRUE, not 1
                left, right = self.text(node.left), self.text(node.right)
                return f"IF({left}{node.operator}{right},1,0)"
            case Binary("^"):
                left, right = (self._inside(part, ATOM) for part in (node.left, node.right))
                return f"{left}^{right}"
            case Binary():
                least = STRENGTH[node.operator]
                left = self._inside(node.left, least)
                # a - (b - c) keeps its parentheses, (a - b) - c needs none
                return f"{left}{node.operator}{self._inside(node.right, least + 1)}"

    def _name(self, node: Name) -> str:
        if node.name in self.cells:
            return self.cells[node.name]
        return {"pi": "PI()", "e": "EXP(1)"}[node.name]

    def _call(self, function: str, given: list[str]) -> str:
        listed = ",".join(given)
        if function == "hypot":
            # spreadsheets have no hypot
            return f"SQRT(({given[0]})^2+({given[1]})^2)"
        if function == "atan2":  # spreadsheets take x first
            listed = f"{given[1]},{given[0]}"
        if function in _OF_ANGLE and self.degrees:
            listed = f"RADIANS({listed})"
        shown = f"{function.upper()}({listed})"
        return f"DEGREES({shown})" if function in _TO_ANGLE and self.degrees else shown

    def _inside(self, node: Node, least: int) -> str:
        shown = self.text(node)
        return f"({shown})" if strength(node) < least else shown


def _begins_with_power(node: Node) -> bool:
    """Whether a sign before the formula would be included in a power."""
    while isinstance(node, Binary) and node.operator != "^":
        node = node.left
    return isinstance(node, Binary)


def cell_number(value: float) -> str:
    """A number in spreadsheet notation."""
    shown = repr(float(value))
    return (shown[:-2] if shown.endswith(".0") else shown).replace("e", "E")


def _value(node: Node, names: Mapping[str, Any], radians: float) -> Any:
    match node:
        case Number():
            return node.value
        case Name():
            return names[node.name] if node.name in names else CONSTANTS[node.name]
        case Negative():
            return -_value(node.operand, names, radians)
        case Binary():
            left = np.asarray(_value(node.left, names, radians), dtype=float)
            right = np.asarray(_value(node.right, names, radians), dtype=float)
            return _OPERATIONS[node.operator](left, right)
        case Call():
            given = [_value(part, names, radians) for part in node.arguments]
            if node.function in _CONVERSIONS:
                return _CONVERSIONS[node.function](*given)
            if node.function in _OF_ANGLE:
                given = [given[0] * radians]
            found = FUNCTIONS[node.function](*given)
            return found / radians if node.function in _TO_ANGLE else found


_OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "^": np.power,
    "<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal,
}  # fmt: skip
