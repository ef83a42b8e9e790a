"""Expansion of a complex formula into phasor terms.

A formula such as ``-d1 - i*a1 + (a4 - b4)*e^(i*θ14)`` becomes a sum of monomials: a complex
constant times at most one variable length times ``exp(i · linear combination of angles)``. The
place of a name determines whether it is an angle or a length.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.expression.values import radians_of, value
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.lanes import (
    display_value,
    exponential,
    finite,
    is_structurally_nonzero,
    uniform_value,
)
from linkwork.core.foundation.precise import Precise, joined, sin_cos
from linkwork.core.foundation.units import AngleUnit


@dataclass(frozen=True)
class Monomial:
    """``value · Π factors · exp(i (Σ weight θ))``; ``shown`` is the constant as written."""

    value: Precise
    shown: Node | None = None
    factors: tuple[str, ...] = ()
    phase: tuple[tuple[str, float], ...] = ()

    def times(self, other: Monomial) -> Monomial:
        """The product."""
        weights = dict(self.phase)
        for name, weight in other.phase:
            weights[name] = weights.get(name, 0.0) + weight
        return Monomial(
            self.value * other.value,
            _product(self.shown, other.shown),
            self.factors + other.factors,
            tuple((name, weight) for name, weight in weights.items() if weight),
        )

    @property
    def constant(self) -> bool:
        """Whether no variable occurs."""
        return not self.factors and not self.phase


def _product(left: Node | None, right: Node | None) -> Node | None:
    if left is None or right is None:
        return left if right is None else right
    if isinstance(left, Negative):
        product = _product(left.operand, right)
        return Negative(product) if product is not None else None
    if isinstance(right, Negative):
        product = _product(left, right.operand)
        return Negative(product) if product is not None else None
    return Binary("*", left, right)


@dataclass
class PhasorReader:
    """Expands formulas of known numbers, known points and variables.

    Parameters
    ----------
    numbers : Mapping[str, float]
        Dimensions by canonical name.
    exact : Callable
        The value of a formula of them, given the one that is rounded at every step.
    variables : Callable
        Whether a canonical name may be a variable.
    points : Mapping[str, sum of monomials]
        Points that formulas may refer to.
    """

    numbers: Mapping[str, float]
    exact: Callable[[Node, float], Precise]
    unit: AngleUnit
    variables: Callable[[str], bool]
    points: dict[str, list[Monomial]] = field(default_factory=dict)
    known: tuple[str, ...] = ()
    text: str = ""

    def read(self, node: Node, text: str) -> list[Monomial]:
        """The sum of monomials, with like terms combined.

        Raises
        ------
        ExpressionError
            If the formula does not have this form; with the column.
        """
        self.text = text
        terms = _join_like_terms(self._sum(node))
        values = [m.value.high for m in terms]
        if not all(finite(z.real) and finite(z.imag) for z in values):
            raise self._error(node, "a coefficient here is not a finite number")
        return terms

    def _error(self, node: Node, message: str) -> ExpressionError:
        return ExpressionError(f"column {node.column}: {message}", self.text, node.column)

    def _sum(self, node: Node) -> list[Monomial]:
        match node:
            case NumberNode():
                return [Monomial(Precise(complex(node.value)), None if node.value == 1 else node)]
            case Name():
                return self._name(node)
            case Negative():
                return [_negate(m) for m in self._sum(node.operand)]
            case Binary("+"):
                return self._sum(node.left) + self._sum(node.right)
            case Binary("-"):
                return self._sum(node.left) + [_negate(m) for m in self._sum(node.right)]
            case Binary("*"):
                return self._multiply(node)
            case Binary("/"):
                return self._divide(node)
            case Binary():
                return self._power(node)
            case Call("exp"):
                return self._exponential(node, node.arguments[0])
            case Call("cis"):
                turned = [
                    m.times(Monomial(Precise(1j), Name("i", "i")))
                    for m in self._sum(node.arguments[0])
                ]
                return self._rotation(node, turned, node.arguments[0])
            case Call():
                return self._function(node)

    def _name(self, node: Name) -> list[Monomial]:
        if node.name in self.numbers:
            return [self._known(node, self.numbers[node.name])]
        if node.name in self.points:
            return self.points[node.name]
        if self.variables(node.name):
            return [Monomial(Precise(1.0 + 0j), None, (node.name,))]
        if node.name == "i":
            return [Monomial(Precise(1j), node)]
        if node.name in CONSTANTS:
            return [self._known(node, CONSTANTS[node.name])]
        raise self._error(
            node,
            f'"{node.spelling}" is neither a dimension nor in [guess] '
            f"{choices('names', self.known, node.name)}",
        )

    def _known(self, node: Node, number: float) -> Monomial:
        """A formula of dimensions, whose value is known."""
        return Monomial(joined(self.exact(node, number), Precise(0.0)), node)

    def _multiply(self, node: Binary) -> list[Monomial]:
        left, right = self._sum(node.left), self._sum(node.right)
        # a constant sum in parentheses remains one factor, as written
        if all(m.constant for m in left) and len(left) > 1:
            left = [_whole(left, node.left)]
        if all(m.constant for m in right) and len(right) > 1:
            right = [_whole(right, node.right)]
        product = [a.times(b) for a in left for b in right]
        if len(product) > 1000:
            raise self._error(node, "multiplied out, this product has more than 1000 terms")
        return product

    def _divide(self, node: Binary) -> list[Monomial]:
        right = self._sum(node.right)
        if not all(m.constant for m in right):
            raise self._error(node, "a loop equation cannot be divided by an unknown")
        divisor = _total(right)
        if divisor.high == 0:
            raise self._error(node, "division by zero")
        return [
            Monomial(
                m.value / divisor,
                Binary("/", m.shown or NumberNode(1.0), node.right),
                m.factors,
                m.phase,
            )
            for m in self._sum(node.left)
        ]

    def _power(self, node: Binary) -> list[Monomial]:
        if isinstance(node.left, Name) and node.left.name == "e" and "e" not in self.numbers:
            return self._exponential(node, node.right)
        base, exponent = self._sum(node.left), self._sum(node.right)
        if not all(m.constant for m in (*base, *exponent)):
            raise self._error(
                node,
                "a loop equation cannot contain a power of an unknown: "
                "write products of one length and e^(i*angle), or use [equations]",
            )
        b, p = _total(base).high, _total(exponent).high
        try:
            power = b**p + 0j
        except (ZeroDivisionError, OverflowError):
            raise self._error(node, "this power is not a finite number") from None
        real = b.imag == 0 and p.imag == 0 and power.imag == 0
        return [self._known(node, power.real) if real else Monomial(Precise(power), node)]

    def _exponential(self, node: Node, exponent: Node) -> list[Monomial]:
        terms = _join_like_terms(self._sum(exponent))
        if all(m.constant and not is_structurally_nonzero(m.value.high.imag) for m in terms):
            try:
                return [self._known(node, exponential(_total(terms).high).real)]
            except OverflowError:
                raise self._error(node, "this power is not a finite number") from None
        return self._rotation(node, terms, exponent)

    def _rotation(self, node: Node, terms: list[Monomial], shown: Node) -> list[Monomial]:
        """exp of i times a linear combination of angles."""
        if self.unit is AngleUnit.DEGREE and any(n.name == "pi" for n in names_in(shown)):
            raise self._error(
                node,
                'angles are in degrees here: write 180 instead of pi, or set angle = "rad"',
            )
        weights: dict[str, float] = {}
        turn = Precise(0.0)
        for m in terms:
            if len(m.factors) > 1 or m.phase:
                raise self._error(node, "an exponent takes i times a sum of angles, nothing else")
            if m.value.high.real != 0.0:
                raise self._error(
                    node, "the exponent has a part without i: a rotation is e^(i*angle)"
                )
            if m.factors:
                weight = uniform_value(m.value.high.imag)
                weights[m.factors[0]] = weights.get(m.factors[0], 0.0) + weight
            else:
                turn = turn + m.value.imag * radians_of(self.unit)
        phase = tuple((name, weight) for name, weight in weights.items() if weight)
        sine, cosine = sin_cos(turn)
        direction = joined(cosine, sine)
        if not phase:
            return [Monomial(direction, node)]
        if not is_structurally_nonzero(turn.high):
            return [Monomial(Precise(1.0 + 0j), None, (), phase)]
        angle = display_value(turn.high).real / self.unit.radians
        constant = Binary("^", Name("e", "e"), Binary("*", Name("i", "i"), NumberNode(angle)))
        return [Monomial(direction, constant, (), phase)]

    def _function(self, node: Call) -> list[Monomial]:
        for used in names_in(node):
            if used.name not in self.numbers and self.variables(used.name):
                raise self._error(
                    node,
                    f"a loop equation cannot contain {node.function} of the unknown "
                    f"{used.spelling}: write e^(i*{used.spelling}), or use [equations]",
                )
        number = value(node, self.numbers, self.unit, self.text)
        return [self._known(node, number)]


def _total(terms: list[Monomial]) -> Precise:
    return sum((m.value for m in terms), Precise(0j))


def _negate(m: Monomial) -> Monomial:
    shown = m.shown
    flipped: Node = (
        Negative(NumberNode(1.0) if shown is None else shown)
        if not isinstance(shown, Negative)
        else shown.operand
    )
    return Monomial(-m.value, None if flipped == NumberNode(1.0) else flipped, m.factors, m.phase)


def _whole(terms: list[Monomial], node: Node) -> Monomial:
    """A constant sum, kept as written."""
    return Monomial(_total(terms), node)


def _join_like_terms(terms: list[Monomial]) -> list[Monomial]:
    """Combine like monomials; constants without variables stay separate, as written."""
    found: dict[tuple[object, ...], Monomial] = {}
    for k, m in enumerate(terms):
        key: tuple[object, ...] = (
            (k,) if m.constant else (tuple(sorted(m.factors)), tuple(sorted(m.phase)))
        )
        if key in found:
            old = found[key]
            shown = Binary("+", old.shown or NumberNode(1.0), m.shown or NumberNode(1.0))
            found[key] = Monomial(old.value + m.value, shown, m.factors, m.phase)
        else:
            found[key] = m
    return list(found.values())
