"""Values of formulas, in doubles, 32 digits and lanes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any, cast

import numpy as np

from linkwork.core.expression.derivatives import Functions, evaluate_by
from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode
from linkwork.core.foundation import precise
from linkwork.core.foundation.arrays import EPSILON, Array, BoolArray
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.lanes import (
    Arithmetic,
    Operand,
    as_float,
    finite,
    first_lanes,
    is_batched,
    is_fractional,
)
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


# ----------------------------------------------------------------------
# Enclosures: a formula's values and derivatives over a box, as intervals that contain rounding.
#
# An operand is an interval of values with one interval for each derivative. Every result is widened
# by its rounding, so that the exact value at every point of the box lies within: by a neighbouring
# float where an operation is rounded once, by ``_ULPS`` for functions of a library.


#: Vectorised libraries state errors of up to four units in the last place.
_ULPS = 8.0
_SMALLEST = 5e-324


class _IntervalArithmetic(Arithmetic["Interval"]):
    """Interval arithmetic, rounded outwards."""

    def plain(self, number: float) -> Interval:
        """A number as it is."""
        x = np.asarray(number, dtype=float)
        return Interval(x, x)

    def add(self, x: Interval, y: Interval) -> Interval:
        """x + y."""
        return _outwards(x.low + y.low, x.high + y.high)

    def negate(self, x: Interval) -> Interval:
        """-x."""
        return Interval(-x.high, -x.low)

    def multiply(self, x: Interval, y: Interval) -> Interval:
        """x y, where 0 · ∞ is 0."""
        corners = [a * b for a in (x.low, x.high) for b in (y.low, y.high)]
        corners = [np.where(np.isnan(corner), 0.0, corner) for corner in corners]
        return _outwards(_least(corners), _most(corners)).where(x.known & y.known)

    def divide(self, x: Interval, y: Interval) -> Interval:
        """x / y; unbounded where y may be 0."""
        zero = (y.low <= 0.0) & (y.high >= 0.0)
        inverse = _outwards(1.0 / y.high, 1.0 / y.low)
        low, high = np.where(zero, -np.inf, inverse.low), np.where(zero, np.inf, inverse.high)
        return x * Interval(low, high).where(y.known)

    def power(self, x: Interval, y: Interval) -> Interval:
        """x to a whole power that is at least 0."""
        exponent = int(y.low)
        ends = [x.low**exponent, x.high**exponent]
        low, high = _least(ends), _most(ends)
        if exponent and exponent % 2 == 0:
            low = np.where((x.low < 0.0) & (x.high > 0.0), 0.0, low)
        return widened(low, high)


_INTERVALS = _IntervalArithmetic()


@dataclass(frozen=True)
class Interval(Operand):
    """All numbers from ``low`` to ``high``, arrays of one shape; NaN where nothing is known."""

    arithmetic = _INTERVALS
    low: Array
    high: Array

    @property
    def known(self) -> BoolArray:
        """Where there are values."""
        return ~(np.isnan(self.low) | np.isnan(self.high))

    def where(self, known: BoolArray) -> Interval:
        """NaN elsewhere."""
        return Interval(np.where(known, self.low, np.nan), np.where(known, self.high, np.nan))

    def clipped(self, least: float, most: float) -> Interval:
        """Without numbers that cannot occur."""
        return Interval(np.maximum(self.low, least), np.minimum(self.high, most))


def _least(parts: Sequence[Array]) -> Array:
    return np.asarray(np.minimum.reduce(np.broadcast_arrays(*parts)))


def _most(parts: Sequence[Array]) -> Array:
    return np.asarray(np.maximum.reduce(np.broadcast_arrays(*parts)))


def _outwards(low: Array, high: Array) -> Interval:
    """Widened by one rounding."""
    return Interval(np.nextafter(low, -np.inf), np.nextafter(high, np.inf))


def widened(low: Array, high: Array) -> Interval:
    """Widened by the errors of a library's function."""
    slack = _ULPS * EPSILON
    return Interval(low - slack * np.abs(low) - _SMALLEST, high + slack * np.abs(high) + _SMALLEST)


class _EnclosureArithmetic(Arithmetic["Enclosure"]):
    """Interval arithmetic with the product rule and the chain rule."""

    def plain(self, number: float) -> Enclosure:
        """A number as it is."""
        return Enclosure(_INTERVALS.plain(number), _NO_CHANGE)

    def add(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x + y."""
        return Enclosure(x.v + y.v, x.d + y.d)

    def negate(self, x: Enclosure) -> Enclosure:
        """-x."""
        return Enclosure(-x.v, -x.d)

    def multiply(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x y."""
        return Enclosure(x.v * y.v, x.d * y.v + x.v * y.d)

    def divide(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x / y."""
        inverse = 1.0 / y.v
        return x * y.chain(inverse, -(inverse**2))

    def power(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x to the power y; an exponent that is no whole number needs a positive base."""
        # a constant is no array of places
        number = float(y.v.low) if np.ndim(y.v.low) == 0 and y.v.low == y.v.high else np.nan
        if not number.is_integer():
            return _exp(y * _ln(x))
        whole = int(abs(number))
        found = x.chain(x.v**whole, whole * x.v ** max(whole - 1, 0))
        return found if number >= 0.0 else self.divide(self.plain(1.0), found)

    def absolute(self, x: Enclosure) -> Enclosure:
        """|x|; where x may be 0 the derivative is any between those of both sides."""
        low, high = x.v.low, x.v.high
        size = Interval(np.maximum(0.0, np.maximum(low, -high)), np.maximum(-low, high))
        sign = Interval(np.where(low > 0.0, 1.0, -1.0), np.where(high < 0.0, -1.0, 1.0))
        return x.chain(size.where(~np.isnan(low)), sign)


#: Of constants, (1, 1).
_NO_CHANGE = Interval(np.zeros((1, 1)), np.zeros((1, 1)))
_ENCLOSURES = _EnclosureArithmetic()


@dataclass(frozen=True)
class Enclosure(Operand):
    """Values ``v`` (B,) and derivatives ``d`` (k, B) over boxes."""

    arithmetic = _ENCLOSURES
    v: Interval
    d: Interval

    def chain(self, f: Interval, slope: Interval) -> Enclosure:
        """f(self), given the values of f and of its derivative."""
        return Enclosure(f, self.d * slope)


def _rounded(number: float) -> Enclosure:
    """A number that was rounded once or twice, such as π."""
    x = np.asarray(number, dtype=float)
    slack = 2.0 * EPSILON * np.abs(x)
    return Enclosure(Interval(x - slack, x + slack), _NO_CHANGE)


def _growing(f: Callable[[Array], Array], x: Interval) -> Interval:
    return widened(f(x.low), f(x.high))


def _exp(x: Enclosure) -> Enclosure:
    e = _growing(np.exp, x.v).clipped(0.0, np.inf)
    return x.chain(e, e)


def _ln(x: Enclosure) -> Enclosure:
    positive = x.v.where(x.v.low > 0.0)
    return x.chain(_growing(np.log, positive), 1.0 / positive)


def _log10(x: Enclosure) -> Enclosure:
    return _ln(x) / _ln(_ENCLOSURES.plain(10.0))


def _sqrt(x: Enclosure) -> Enclosure:
    root = _growing(np.sqrt, x.v).clipped(0.0, np.inf).where(x.v.low >= 0.0)
    return x.chain(root, 0.5 / root)


def _wave(f: Callable[[Array], Array], x: Interval, top: float) -> Interval:
    """A sine or cosine, which is 1 at ``top`` and -1 half a turn later."""
    found = _growing(f, Interval(x.low, x.low)), _growing(f, Interval(x.high, x.high))
    low = np.minimum(found[0].low, found[1].low)
    high = np.maximum(found[0].high, found[1].high)
    for place, edge in ((top, 1.0), (top + np.pi, -1.0)):
        turns = [(end - place) / (2.0 * np.pi) for end in (x.low, x.high)]
        slack = [8.0 * EPSILON * (1.0 + np.abs(turn)) for turn in turns]
        met = np.floor(turns[1] + slack[1]) > np.floor(turns[0] - slack[0])
        high = np.where(met & (edge > 0.0), 1.0, high)
        low = np.where(met & (edge < 0.0), -1.0, low)
    known = np.isfinite(x.low) & np.isfinite(x.high)
    return Interval(np.where(known, low, -1.0), np.where(known, high, 1.0)).clipped(-1.0, 1.0)


def _sin(x: Enclosure) -> Enclosure:
    return x.chain(_wave(np.sin, x.v, 0.5 * np.pi), _wave(np.cos, x.v, 0.0))


def _cos(x: Enclosure) -> Enclosure:
    return x.chain(_wave(np.cos, x.v, 0.0), -_wave(np.sin, x.v, 0.5 * np.pi))


def _tan(x: Enclosure) -> Enclosure:
    cosine = _wave(np.cos, x.v, 0.0)
    regular = x.v.where((cosine.low > 0.0) | (cosine.high < 0.0))
    tangent = _growing(np.tan, regular)
    return x.chain(tangent, 1.0 + tangent**2)


def _arc_slope(x: Interval) -> Interval:
    return 1.0 / _sqrt(Enclosure(1.0 - x**2, x)).v


def _asin(x: Enclosure) -> Enclosure:
    return x.chain(_growing(np.arcsin, x.v), _arc_slope(x.v))


def _acos(x: Enclosure) -> Enclosure:
    return x.chain(-_growing(lambda z: -np.arccos(z), x.v), -_arc_slope(x.v))


def _atan(x: Enclosure) -> Enclosure:
    return x.chain(_growing(np.arctan, x.v), 1.0 / (1.0 + x.v**2))


def _atan2(y: Enclosure, x: Enclosure) -> Enclosure:
    corners = [np.arctan2(a, b) for a in (y.v.low, y.v.high) for b in (x.v.low, x.v.high)]
    # no jump by a whole turn within the box
    cut = (y.v.low <= 0.0) & (y.v.high >= 0.0) & (x.v.low <= 0.0)
    angle = widened(_least(corners), _most(corners)).where(~cut)
    return Enclosure(angle, (y.d * x.v - x.d * y.v) / (x.v**2 + y.v**2))


def _hypot(x: Enclosure, y: Enclosure) -> Enclosure:
    return _sqrt(x**2.0 + y**2.0)


def _max(*parts: Enclosure) -> Enclosure:
    """The largest; where more than one may be it, any derivative between theirs."""
    low, high = (_most([getattr(x.v, end) for x in parts]) for end in ("low", "high"))
    below: list[Array] = []
    above: list[Array] = []
    for x in parts:
        # any comparison with NaN fails
        possible = ~(x.v.high < low)
        below.append(np.where(possible, x.d.low, np.inf))
        above.append(np.where(possible, x.d.high, -np.inf))
    return Enclosure(Interval(low, high), Interval(_least(below), _most(above)))


def _min(*parts: Enclosure) -> Enclosure:
    return -_max(*(-x for x in parts))


#: Functions that are evaluated as enclosures.
ENCLOSURES: Functions[Enclosure] = Functions(
    literal=_ENCLOSURES.plain,
    rounded=_rounded,
    plain={
        "sqrt": _sqrt, "exp": _exp, "ln": _ln, "log10": _log10, "abs": abs, "hypot": _hypot,
        "min": _min, "max": _max,
    },
    of_angle={"sin": _sin, "cos": _cos, "tan": _tan},
    to_angle={"asin": _asin, "acos": _acos, "atan": _atan, "atan2": _atan2},
)  # fmt: skip
