"""Evaluate a formula in plain numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from linkwork.expression.grammar import CONSTANTS
from linkwork.expression.lane_functions import applied
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.elementwise import as_float, finite, is_fractional
from linkwork.foundation.errors import ExpressionError, choices
from linkwork.foundation.lanes import is_batched

__all__ = ["OF_ANGLE", "TO_ANGLE", "value"]

_PLAIN: dict[str, Callable[..., float]] = {
    "sqrt": math.sqrt, "exp": math.exp, "ln": math.log, "log10": math.log10,
    "abs": abs, "hypot": math.hypot, "min": min, "max": max,
}  # fmt: skip
OF_ANGLE: dict[str, Callable[[float], float]] = {"sin": math.sin, "cos": math.cos, "tan": math.tan}
TO_ANGLE: dict[str, Callable[..., float]] = {
    "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2,
}  # fmt: skip


def value(node: Node, names: Mapping[str, float], unit: AngleUnit, text: str = "") -> float:
    """The real value of a formula.

    Parameters
    ----------
    node : Node
        The parsed formula.
    names : Mapping[str, float]
        Values by canonical name.
    unit : AngleUnit
        Unit of the arguments of sin, cos, tan and of the results of asin, acos, atan, atan2.
    text : str
        The formula as written, for messages.

    Raises
    ------
    ExpressionError
        For an unknown name, a value outside a function's domain, a division by zero,
        an overflow, or the imaginary unit.
    """
    try:
        result = _value(node, names, unit, text)
    except OverflowError:
        raise ExpressionError("the value is too large", text, 1) from None
    if not finite(result):
        raise ExpressionError("the value is too large", text, 1)
    return result


def _value(node: Node, names: Mapping[str, float], unit: AngleUnit, text: str) -> float:
    match node:
        case Number():
            return node.value
        case Name():
            return _named(node, names, text)
        case Negative():
            return -_value(node.operand, names, unit, text)
        case Binary():
            left = _value(node.left, names, unit, text)
            right = _value(node.right, names, unit, text)
            return _combined(node, left, right, text)
        case Call():
            arguments = [_value(a, names, unit, text) for a in node.arguments]
            return _applied(node, arguments, unit, text)


def _named(node: Name, names: Mapping[str, float], text: str) -> float:
    if node.name in names:
        return names[node.name]
    if node.name in CONSTANTS:
        return CONSTANTS[node.name]
    if node.name == "i":
        message = "a real number cannot contain the imaginary unit i"
    else:
        message = f'"{node.spelling}" is not defined {choices("dimensions", names, node.name)}'
    raise ExpressionError(f"column {node.column}: {message}", text, node.column)


def _combined(node: Binary, left: float, right: float, text: str) -> float:
    match node.operator:
        case "+":
            return left + right
        case "-":
            return left - right
        case "*":
            return left * right
        case "/" if right == 0.0:
            message = "division by zero"
        case "/":
            return left / right
        case _ if (left < 0) & is_fractional(right):
            message = f"{left:g}^{right:g} is not a real number"
        case _ if (left == 0) & (right < 0):
            message = "division by zero"
        case _:
            return as_float(left**right)
    raise ExpressionError(f"column {node.column}: {message}", text, node.column)


def _applied(node: Call, arguments: list[float], unit: AngleUnit, text: str) -> float:
    name = node.function
    lanes = any(map(is_batched, arguments))
    try:
        if name in OF_ANGLE:
            angle = arguments[0] * unit.radians
            return applied(name, [angle]) if lanes else OF_ANGLE[name](angle)
        if name in TO_ANGLE:
            found = applied(name, arguments) if lanes else TO_ANGLE[name](*arguments)
            return found / unit.radians
        if name in _PLAIN:
            return applied(name, arguments) if lanes else float(_PLAIN[name](*arguments))
    except ValueError:
        shown = ", ".join(f"{a:g}" for a in arguments)
        message = f"{name}({shown}) is not a real number"
    else:
        message = f"{name} is not allowed in a real number"
    raise ExpressionError(f"column {node.column}: {message}", text, node.column)
