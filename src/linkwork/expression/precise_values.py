"""Formulas of real numbers to about 32 digits, so that their rounding is that of their result."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce

from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.foundation import precise
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.precise import (
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

__all__ = ["precise_value", "radians_of"]

_CONSTANTS = {"pi": PI, "e": precise.E}
_ONE = Precise(1.0)


def radians_of(unit: AngleUnit) -> Precise:
    """Radians per unit."""
    return PI / 180.0 if unit is AngleUnit.DEGREE else _ONE


def precise_value(node: Node, names: Mapping[str, Precise], unit: AngleUnit) -> Precise:
    """The value of a formula that has one; see :func:`~linkwork.expression.values.value`."""
    match node:
        case Number():
            return Precise(node.value)
        case Name():
            return names[node.name] if node.name in names else _CONSTANTS[node.name]
        case Negative():
            return -precise_value(node.operand, names, unit)
        case Binary():
            left, right = (precise_value(side, names, unit) for side in (node.left, node.right))
            return _OPERATORS[node.operator](left, right)
        case Call():
            given = [precise_value(argument, names, unit) for argument in node.arguments]
            if node.function in ("sin", "cos", "tan"):
                given = [given[0] * radians_of(unit)]
            found = _FUNCTIONS[node.function](*given)
            return found / radians_of(unit) if node.function in _TO_ANGLE else found


def _power(x: Precise, y: Precise) -> Precise:
    if isinstance(y.high, float) and y.high.is_integer() and not y.low and abs(y.high) <= 64.0:
        found = reduce(lambda total, _: total * x, range(abs(int(y.high))), _ONE)
        return found if y.high >= 0.0 else _ONE / found
    return exp(y * log(x))


_OPERATORS: dict[str, Callable[[Precise, Precise], Precise]] = {
    "+": lambda x, y: x + y, "-": lambda x, y: x - y, "*": lambda x, y: x * y,
    "/": lambda x, y: x / y, "^": _power,
}  # fmt: skip
_TO_ANGLE = ("asin", "acos", "atan", "atan2")
_FUNCTIONS: dict[str, Callable[..., Precise]] = {
    "sqrt": sqrt, "exp": exp, "ln": log, "log10": lambda x: log(x) / log(Precise(10.0)),
    "abs": abs, "hypot": lambda *sides: sqrt(sum((x * x for x in sides), Precise(0.0))),
    "sin": lambda x: sin_cos(x)[0], "cos": lambda x: sin_cos(x)[1],
    "tan": lambda x: sin_cos(x)[0] / sin_cos(x)[1],
    "asin": asin, "acos": acos, "atan": lambda x: phase(joined(_ONE, x)),
    "atan2": lambda y, x: phase(joined(x, y)),
    "min": lambda *all_: reduce(lambda x, y: chosen(y.high < x.high, y, x), all_),
    "max": lambda *all_: reduce(lambda x, y: chosen(y.high > x.high, y, x), all_),
}  # fmt: skip
