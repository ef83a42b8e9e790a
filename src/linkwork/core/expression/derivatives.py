"""Derivatives of formulas, symbolic and by jets."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.foundation.arrays import AnyArray, Array
from linkwork.core.foundation.lanes import Arithmetic, Operand
from linkwork.core.foundation.units import AngleUnit

# ----------------------------------------------------------------------
# Second-order jets: a value with its first and second derivative along one direction.
#
# ``f(x + h d) = v + h v' + h²/2 v'' + …`` — arithmetic on the triple gives exact derivatives of any
# formula without symbolic differentiation. Entries are arrays of one common shape.


T = TypeVar("T", bound=Operand)


class _JetArithmetic(Arithmetic["Jet"]):
    """Sums, products and powers with the product rule and the chain rule."""

    def plain(self, number: float) -> Jet:
        """A constant as a jet: both derivatives are 0."""
        zero = np.zeros(())
        return Jet(np.asarray(number, dtype=float), zero, zero)

    def add(self, x: Jet, y: Jet) -> Jet:
        """x + y."""
        return Jet(x.v + y.v, x.d1 + y.d1, x.d2 + y.d2)

    def subtract(self, x: Jet, y: Jet) -> Jet:
        """x - y."""
        return Jet(x.v - y.v, x.d1 - y.d1, x.d2 - y.d2)

    def negate(self, x: Jet) -> Jet:
        """-x."""
        return Jet(-x.v, -x.d1, -x.d2)

    def multiply(self, x: Jet, y: Jet) -> Jet:
        """x y."""
        first = x.d1 * y.v + x.v * y.d1
        return Jet(x.v * y.v, first, x.d2 * y.v + 2.0 * x.d1 * y.d1 + x.v * y.d2)

    def divide(self, x: Jet, y: Jet) -> Jet:
        """x / y."""
        r = 1.0 / y.v
        return x * y.chain(r, -(r**2), 2.0 * r**3)

    def power(self, x: Jet, y: Jet) -> Jet:
        """x to the power y; an exponent that is not constant needs a positive base."""
        if np.any(y.d1) or np.any(y.d2):
            return _exp(y * _ln(x))
        p = y.v
        first = np.where(p == 0, 0.0, p * x.v ** np.where(p == 0, 1.0, p - 1.0))
        flat = (p == 0) | (p == 1)
        second = np.where(flat, 0.0, p * (p - 1.0) * x.v ** np.where(flat, 1.0, p - 2.0))
        return x.chain(x.v**p, first, second)

    def absolute(self, x: Jet) -> Jet:
        """|x|; its derivatives are 0 where x is 0."""
        return x.chain(np.abs(x.v), np.sign(x.v), np.zeros_like(x.v))


_JETS = _JetArithmetic()


@dataclass(frozen=True)
class Jet(Operand):
    """A value and its first two derivatives along a direction; arrays of equal shape (…,).

    Real, or x + iy of a point in the plane.
    """

    arithmetic = _JETS
    v: AnyArray
    d1: AnyArray
    d2: AnyArray

    @classmethod
    def constant(cls, value: float) -> Jet:
        """A constant as a jet: both derivatives are 0."""
        return _JETS.plain(value)

    def chain(self, f: Array, f1: Array, f2: Array) -> Jet:
        """The jet of f(self), given f, f' and f'' at the value (Faà di Bruno to order two)."""
        return Jet(f, f1 * self.d1, f1 * self.d2 + f2 * self.d1**2)

    def direction(self) -> Jet:
        """The angle of a vector x + iy [rad]; NaN for one of length 0."""
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = self.d1 / self.v
            # the second derivative of log v; its imaginary part is that of the angle
            bend = self.d2 / self.v - rate**2
        angle = np.where(self.v == 0, np.nan, np.angle(self.v))
        return Jet(angle, rate.imag, bend.imag)


def _exp(x: Jet) -> Jet:
    e = np.exp(x.v)
    return x.chain(e, e, e)


def _ln(x: Jet) -> Jet:
    return x.chain(np.log(x.v), 1.0 / x.v, -1.0 / x.v**2)


def _log10(x: Jet) -> Jet:
    return _ln(x) * (1.0 / math.log(10.0))


def _sqrt(x: Jet) -> Jet:
    r = np.sqrt(x.v)
    return x.chain(r, 0.5 / r, -0.25 / (r * x.v))


def _sin(x: Jet) -> Jet:
    s, c = np.sin(x.v), np.cos(x.v)
    return x.chain(s, c, -s)


def _cos(x: Jet) -> Jet:
    s, c = np.sin(x.v), np.cos(x.v)
    return x.chain(c, -s, -c)


def _tan(x: Jet) -> Jet:
    t = np.tan(x.v)
    return x.chain(t, 1.0 + t**2, 2.0 * t * (1.0 + t**2))


def _asin(x: Jet) -> Jet:
    r = 1.0 / np.sqrt(1.0 - x.v**2)
    return x.chain(np.arcsin(x.v), r, x.v * r**3)


def _acos(x: Jet) -> Jet:
    r = 1.0 / np.sqrt(1.0 - x.v**2)
    return x.chain(np.arccos(x.v), -r, -x.v * r**3)


def _atan(x: Jet) -> Jet:
    r = 1.0 / (1.0 + x.v**2)
    return x.chain(np.arctan(x.v), r, -2.0 * x.v * r**2)


def _atan2(y: Jet, x: Jet) -> Jet:
    # d atan2 = (x dy - y dx)/r²; differentiated once more along the same direction.
    square = x * x + y * y
    first = (x.v * y.d1 - y.v * x.d1) / square.v
    second = (x.v * y.d2 - y.v * x.d2) / square.v - first * square.d1 / square.v
    return Jet(np.arctan2(y.v, x.v), first, second)


def _hypot(x: Jet, y: Jet) -> Jet:
    return _sqrt(x * x + y * y)


def _chosen(least: bool) -> Callable[..., Jet]:
    def choose(*jets: Jet) -> Jet:
        best = jets[0]
        for jet in jets[1:]:
            take = jet.v < best.v if least else jet.v > best.v
            best = Jet(
                np.where(take, jet.v, best.v),
                np.where(take, jet.d1, best.d1),
                np.where(take, jet.d2, best.d2),
            )
        return best

    return choose


_COMPARISONS: dict[str, Callable[..., Array]] = {
    "<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal,
}  # fmt: skip


def _compared(operator: str, left: Jet, right: Jet) -> Jet:
    """1 where the comparison holds and else 0; NaN where it has no operands."""
    holds = np.where(_COMPARISONS[operator](left.v, right.v), 1.0, 0.0)
    zero = np.zeros(())
    return Jet(np.where(np.isnan(left.v + right.v), np.nan, holds), zero, zero)


@dataclass(frozen=True)
class Functions(Generic[T]):
    """How formulas are evaluated in one arithmetic.

    ``literal``: a number as written; ``rounded``: one such as π, which is no float. ``plain``,
    ``of_angle``, ``to_angle``: functions by name; ``compared``: comparisons, if there are any.
    """

    literal: Callable[[float], T]
    rounded: Callable[[float], T]
    plain: Mapping[str, Callable[..., T]]
    of_angle: Mapping[str, Callable[[T], T]]
    to_angle: Mapping[str, Callable[..., T]]
    compared: Callable[[str, T, T], T] | None = None


_FUNCTIONS: Functions[Jet] = Functions(
    literal=Jet.constant,
    rounded=Jet.constant,
    plain={
        "sqrt": _sqrt, "exp": _exp, "ln": _ln, "log10": _log10, "abs": abs, "hypot": _hypot,
        "min": _chosen(least=True), "max": _chosen(least=False),
    },
    of_angle={"sin": _sin, "cos": _cos, "tan": _tan},
    to_angle={"asin": _asin, "acos": _acos, "atan": _atan, "atan2": _atan2},
    compared=_compared,
)  # fmt: skip


def evaluate(node: Node, names: Mapping[str, Jet], unit: AngleUnit) -> Jet:
    """The jet of a formula; all its names must be in ``names`` (checked by the reader).

    Outside a function's domain the entries are NaN, which a solver reports as a status.
    """
    return evaluate_by(_FUNCTIONS, node, names, unit)


def evaluate_by(by: Functions[T], node: Node, names: Mapping[str, T], unit: AngleUnit) -> T:
    """A formula in any arithmetic; see :func:`evaluate`."""
    match node:
        case NumberNode():
            return by.literal(node.value)
        case Name():
            return names[node.name] if node.name in names else by.rounded(CONSTANTS[node.name])
        case Negative():
            return -evaluate_by(by, node.operand, names, unit)
        case Binary():
            left = evaluate_by(by, node.left, names, unit)
            right = evaluate_by(by, node.right, names, unit)
            match node.operator:
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
                case _:
                    assert by.compared is not None  # plain equations do not compare
                    return by.compared(node.operator, left, right)
        case Call():
            arguments = [evaluate_by(by, a, names, unit) for a in node.arguments]
            if node.function in by.of_angle:
                return by.of_angle[node.function](arguments[0] * by.rounded(unit.radians))
            if node.function in by.to_angle:
                return by.to_angle[node.function](*arguments) / by.rounded(unit.radians)
            return by.plain[node.function](*arguments)


# ----------------------------------------------------------------------
# The derivative of a formula as a formula, for display; jets compute the numbers.


_ZERO, _ONE = NumberNode(0.0), NumberNode(1.0)


def derivative(node: Node, name: str, radians: float = 1.0) -> Node:
    """d(node)/d(name), lightly simplified; ``radians`` is the angle unit of the formula.

    Raises
    ------
    ValueError
        For ``min`` and ``max``, which have no derivative in one formula.
    """
    if not _contains(node, name):
        return _ZERO

    def d(part: Node) -> Node:
        return derivative(part, name, radians)

    match node:
        case Name():
            return _ONE
        case Negative():
            return _negative(d(node.operand))
        case Binary("+", left, right):
            return sum_of(d(left), d(right))
        case Binary("-", left, right):
            return sum_of(d(left), _negative(d(right)))
        case Binary("*", left, right):
            return sum_of(product_of(d(left), right), product_of(left, d(right)))
        case Binary("/", left, right):
            top = sum_of(product_of(d(left), right), _negative(product_of(left, d(right))))
            return Binary("/", top, Binary("^", right, NumberNode(2.0)))
        case Binary("<" | "<=" | ">" | ">="):
            return _ZERO
        case Binary():
            return _power(node, name, radians)
        case Call():
            return _chain(node, name, radians)
        case NumberNode():
            return _ZERO


def _contains(node: Node, name: str) -> bool:
    return any(used.name == name for used in names_in(node))


def _power(node: Binary, name: str, radians: float) -> Node:
    base, exponent = node.left, node.right
    if not _contains(exponent, name):
        if isinstance(exponent, NumberNode):
            lower: Node = NumberNode(exponent.value - 1.0)
            reduced = base if lower == _ONE else Binary("^", base, lower)
        else:
            reduced = Binary("^", base, Binary("-", exponent, _ONE))
        return product_of(product_of(exponent, reduced), derivative(base, name, radians))
    # u^v = exp(v ln u)
    inner = product_of(exponent, Call("ln", (base,)))
    if base == Name("e"):
        inner = exponent
    return product_of(node, derivative(inner, name, radians))


def _chain(node: Call, name: str, radians: float) -> Node:
    def d(part: Node) -> Node:
        return derivative(part, name, radians)

    x = node.arguments[0]
    square = Binary("^", x, NumberNode(2.0))
    outer: dict[str, Node] = {
        "sin": Call("cos", (x,)),
        "cos": Negative(Call("sin", (x,))),
        "tan": Binary("+", _ONE, Binary("^", node, NumberNode(2.0))),
        "exp": node,
        "ln": Binary("/", _ONE, x),
        "log10": Binary("/", _ONE, Binary("*", Call("ln", (NumberNode(10.0),)), x)),
        "sqrt": Binary("/", _ONE, Binary("*", NumberNode(2.0), node)),
        "asin": Binary("/", _ONE, Call("sqrt", (Binary("-", _ONE, square),))),
        "acos": Negative(Binary("/", _ONE, Call("sqrt", (Binary("-", _ONE, square),)))),
        "atan": Binary("/", _ONE, Binary("+", _ONE, square)),
        "abs": Binary("/", x, node),
    }
    inner = d(x)
    # the derivative of sin(k x) has the factor k = radians per unit
    if node.function in ("sin", "cos", "tan") and radians != 1.0:
        inner = product_of(NumberNode(radians), inner)
    if node.function in ("asin", "acos", "atan") and radians != 1.0:
        inner = product_of(NumberNode(1.0 / radians), inner)
    if node.function in outer:
        return product_of(outer[node.function], inner)
    if node.function == "hypot":
        y = node.arguments[1]
        top = sum_of(product_of(x, d(x)), product_of(y, d(y)))
        return Binary("/", top, node)
    if node.function == "atan2":
        other = node.arguments[1]
        top = sum_of(product_of(other, d(x)), _negative(product_of(x, d(other))))
        whole = Binary("/", top, Binary("+", square, Binary("^", other, NumberNode(2.0))))
        return whole if radians == 1.0 else product_of(NumberNode(1.0 / radians), whole)
    raise ValueError(f"{node.function} has a derivative that is not a single formula")


def _negative(node: Node) -> Node:
    if node == _ZERO:
        return node
    return node.operand if isinstance(node, Negative) else Negative(node)


def sum_of(left: Node, right: Node) -> Node:
    """left + right, without zeros."""
    if left == _ZERO:
        return right
    if right == _ZERO:
        return left
    if isinstance(right, Negative):
        return Binary("-", left, right.operand)
    return Binary("+", left, right)


def product_of(left: Node, right: Node) -> Node:
    """left · right, without ones, signs first."""
    if _ZERO in (left, right):
        return _ZERO
    if left == _ONE:
        return right
    if right == _ONE:
        return left
    if isinstance(left, Negative):
        return _negative(product_of(left.operand, right))
    if isinstance(right, Negative):
        return _negative(product_of(left, right.operand))
    return Binary("*", left, right)
