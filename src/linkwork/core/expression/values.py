"""Values of formulas, in doubles, 32 digits and lanes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import Any, cast

import numpy as np

from linkwork.core.expression.derivatives import Functions, evaluate_by
from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode
from linkwork.core.foundation import precise
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.lanes import as_float, finite, first_lanes, is_batched, is_fractional
from linkwork.core.foundation.precise import (
    PI,
    Precise,
    acos,
    asin,
    chosen,
    exp,
    joined,
    log,
    phase,
    sin_cos,
    sqrt,
)
from linkwork.core.foundation.units import AngleUnit

# ----------------------------------------------------------------------
# Functions of formulas on arrays of many designs, with the exceptions of ``math``.


def least(*numbers: Any) -> Any:
    """The minimum, element by element."""
    return reduce(np.minimum, numbers)


def most(*numbers: Any) -> Any:
    """The maximum, element by element."""
    return reduce(np.maximum, numbers)


#: Functions of arrays by their name in formulas; angles in radians.
FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sqrt": np.sqrt, "exp": np.exp, "ln": np.log, "log10": np.log10, "abs": np.fabs,
    "hypot": np.hypot, "sin": np.sin, "cos": np.cos, "tan": np.tan,
    "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2,
    "min": least, "max": most,
}  # fmt: skip

_PARTIAL = ("sqrt", "exp", "ln", "log10", "asin", "acos")


def applied(name: str, arguments: Sequence[float]) -> float:
    """Apply a function to numbers and lanes; angles in radians.

    Raises
    ------
    ValueError, OverflowError
        As in ``math``: outside the domain, or if the value is too large.
    """
    first = first_lanes(arguments)
    assert first is not None
    found = first.apply(FUNCTIONS[name], *arguments)
    if name in _PARTIAL and not found.holds(np.isfinite):
        raise OverflowError if name == "exp" else ValueError
    return cast(float, found)


# ----------------------------------------------------------------------
# Evaluate a formula in plain numbers.


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
        case NumberNode():
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


# ----------------------------------------------------------------------
# Formulas of real numbers to about 32 digits, so that their rounding is that of their result.


_ONE = Precise(1.0)


def radians_of(unit: AngleUnit) -> Precise:
    """Radians per unit."""
    return PI / 180.0 if unit is AngleUnit.DEGREE else _ONE


#: Numbers that were rounded to floats.
_ROUNDED = {
    math.pi: PI,
    math.e: precise.E,
    **{unit.radians: radians_of(unit) for unit in AngleUnit},
}


def precise_value(node: Node, names: Mapping[str, Precise], unit: AngleUnit) -> Precise:
    """The value of a formula that has one; see :func:`~linkwork.core.expression.values.value`."""
    return evaluate_by(_PRECISE, node, names, unit)


_PRECISE: Functions[Precise] = Functions(
    literal=Precise,
    rounded=_ROUNDED.__getitem__,
    plain={
        "sqrt": sqrt, "exp": exp, "ln": log, "log10": lambda x: log(x) / log(Precise(10.0)),
        "abs": abs, "hypot": lambda *sides: sqrt(sum((x * x for x in sides), Precise(0.0))),
        "min": lambda *all_: reduce(lambda x, y: chosen(y.high < x.high, y, x), all_),
        "max": lambda *all_: reduce(lambda x, y: chosen(y.high > x.high, y, x), all_),
    },
    of_angle={
        "sin": lambda x: sin_cos(x)[0], "cos": lambda x: sin_cos(x)[1],
        "tan": lambda x: sin_cos(x)[0] / sin_cos(x)[1],
    },
    to_angle={
        "asin": asin, "acos": acos, "atan": lambda x: phase(joined(_ONE, x)),
        "atan2": lambda y, x: phase(joined(x, y)),
    },
)  # fmt: skip


# ----------------------------------------------------------------------
# Formulas with real values only.


_COMPLEX_ONLY = ("cis",)


def check_real(tree: Node, text: str, noun: str) -> None:
    """Refuse functions with complex values; ``noun`` is what the formula gives: ``an output``.

    Raises
    ------
    ExpressionError
        With the function and its column in ``text``.
    """
    match tree:
        case Call() if tree.function in _COMPLEX_ONLY:
            raise ExpressionError(
                f"column {tree.column}: {tree.function} is complex, {noun} is a real number",
                text,
                tree.column,
            )
        case Call():
            for argument in tree.arguments:
                check_real(argument, text, noun)
        case Binary():
            check_real(tree.left, text, noun)
            check_real(tree.right, text, noun)
        case Negative():
            check_real(tree.operand, text, noun)
        case Name() | NumberNode():
            return
