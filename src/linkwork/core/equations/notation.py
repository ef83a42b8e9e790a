"""Two notations for the same equations: plain text for a terminal, LaTeX for a page."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

from linkwork.core.equations.model import Term
from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.expression.tree import (
    Binary,
    Call,
    Name,
    Negative,
    Node,
    NumberNode,
    latex,
    names_in,
    number_text,
    text as writing_text,
)
from linkwork.core.expression.values import radians_of, value
from linkwork.core.foundation.errors import ExpressionError, choices
from linkwork.core.foundation.lanes import (
    display_value,
    exponential,
    finite,
    is_structurally_nonzero,
    uniform_value,
)
from linkwork.core.foundation.names import latex_name, pretty
from linkwork.core.foundation.precise import Precise, joined, sin_cos
from linkwork.core.foundation.units import AngleUnit

T = TypeVar("T")
S_co = TypeVar("S_co", covariant=True)


@dataclass(frozen=True)
class Signed(Generic[S_co]):
    """A product with its sign."""

    sign: int
    product: S_co


class Notation(Protocol[T]):
    """The notation of names, phasors, products and sums; an angle is given by its terms."""

    imaginary: T

    def name(self, name: str) -> T:
        """A variable or dimension."""

    def number(self, text: str) -> T:
        """A number as its digits."""

    def node(self, node: Node) -> T:
        """A formula as one factor of a product."""

    def formula(self, node: Node) -> T:
        """A complete formula."""

    def degrees(self, radians: float) -> T:
        """A fixed angle."""

    def phasor(self, angle: Sequence[Signed[T]]) -> T:
        """e to the i times an angle."""

    def function(self, name: str, angle: Sequence[Signed[T]]) -> T:
        """cos or sin of an angle."""

    def law(self, name: str, primes: int, argument: T) -> T:
        """A named function, or a derivative of it."""

    def weighted(self, weight: str, name: T) -> T:
        """A number directly before a name."""

    def product(self, factors: Sequence[T]) -> T:
        """Factors in a row; 1 if there are none."""

    def sum(self, terms: Iterable[Signed[T]]) -> T:
        """Signed products in a row; 0 if there are none."""

    def fenced(self, inside: T) -> T:
        """In parentheses."""

    def equation(self, left: T, right: T) -> T:
        """Both sides of an equation."""


class _Text:
    """The common base of plain text and LaTeX."""

    imaginary = "i"
    times = ""

    def number(self, text: str) -> str:
        """A number as its digits."""
        return text

    def weighted(self, weight: str, name: str) -> str:
        """A number directly before a name."""
        return f"{weight}{name}"

    def product(self, factors: Sequence[str]) -> str:
        """Factors in a row; 1 if there are none."""
        return self.times.join(factors) or "1"

    def sum(self, terms: Iterable[Signed[str]]) -> str:
        """``a - b + c``; 0 if there are none."""
        shown = ""
        for term in terms:
            if shown:
                shown += f" {'-' if term.sign < 0 else '+'} {term.product}"
            else:
                shown = f"-{term.product}" if term.sign < 0 else term.product
        return shown or "0"

    def fenced(self, inside: str) -> str:
        """In parentheses."""
        return f"({inside})"

    def equation(self, left: str, right: str) -> str:
        """Both sides of an equation."""
        return f"{left} = {right}"

    def _is_compound(self, angle: Sequence[Signed[str]]) -> bool:
        return len(angle) > 1 or angle[0].sign < 0 or self.times in angle[0].product

    def _exponent(self, angle: Sequence[Signed[str]]) -> str:
        """i times an angle."""
        if len(angle) == 1 and angle[0].sign < 0 and " " not in angle[0].product:
            return f"-i{angle[0].product}"
        shown = self.sum(angle)
        return f"i({shown})" if self._is_compound(angle) else f"i{shown}"


class PlainText(_Text):
    """``a2·e^(iθ12)``."""

    times = "·"

    def name(self, name: str) -> str:
        """A variable or dimension."""
        return pretty(name)

    def formula(self, node: Node) -> str:
        """A complete formula."""
        return writing_text(node, lambda n: pretty(n.spelling or n.name)).replace("*", "·")

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""
        shown = self.formula(node)
        return f"({shown})" if " " in shown else shown

    def degrees(self, radians: float) -> str:
        """A fixed angle."""
        return f"{number_text(round(math.degrees(radians), 6))}°"

    def phasor(self, angle: Sequence[Signed[str]]) -> str:
        """e to the i times an angle."""
        return f"e^({self._exponent(angle)})"

    def function(self, name: str, angle: Sequence[Signed[str]]) -> str:
        """cos or sin of an angle."""
        shown = self.sum(angle)
        return f"{name}({shown})" if self._is_compound(angle) else f"{name} {shown}"

    def law(self, name: str, primes: int, argument: str) -> str:
        """A named function, or a derivative of it."""
        return f"{pretty(name)}{primes * chr(39)}({argument})"


class Latex(_Text):
    r"""``a_2 e^{i\theta_{12}}``."""

    times = r" \, "

    def name(self, name: str) -> str:
        """A variable or dimension."""
        return latex_name(name)

    def formula(self, node: Node) -> str:
        """A complete formula."""
        return latex(node)

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""
        shown = latex(node)
        return rf"\left({shown}\right)" if " + " in shown or " - " in shown else shown

    def degrees(self, radians: float) -> str:
        """A fixed angle."""
        return rf"{number_text(round(math.degrees(radians), 6))}^\circ"

    def phasor(self, angle: Sequence[Signed[str]]) -> str:
        """e to the i times an angle."""
        return f"e^{{{self._exponent(angle)}}}"

    def function(self, name: str, angle: Sequence[Signed[str]]) -> str:
        """cos or sin of an angle."""
        shown = self.sum(angle)
        return rf"\{name}({shown})" if self._is_compound(angle) else rf"\{name} {shown}"

    def law(self, name: str, primes: int, argument: str) -> str:
        """A named function, or a derivative of it."""
        shown = latex_name(name)
        if primes:
            shown = f"{{{shown}}}{primes * chr(39)}"
        return rf"{shown}\left({argument}\right)"


# ----------------------------------------------------------------------
# Terms of loop equations and their derivatives, written in a notation.


@dataclass(frozen=True)
class TermWriter(Generic[T]):
    """Writes terms and their derivatives; ``names`` maps symbols to displayed names."""

    notation: Notation[T]
    names: Mapping[str, str]

    def angle(self, term: Term, sign: int = 1, with_turn: bool = True) -> list[Signed[T]]:
        """Σ weight θ (+ turn), times sign."""
        parts = []
        for symbol, weight in term.phase:
            w = weight * sign
            factors = [] if abs(w) == 1 else [self.notation.number(f"{abs(w):g}")]
            factors.append(self.notation.name(self.names[symbol]))
            shown = factors[0] if len(factors) == 1 else self.notation.product(factors)
            parts.append(Signed(-1 if w < 0 else 1, shown))
        if with_turn and term.turn:
            turn = term.turn * sign
            parts.append(Signed(-1 if turn < 0 else 1, self.notation.degrees(abs(turn))))
        return parts

    def _factors(self, term: Term, length: bool = True) -> list[T]:
        found = []
        if term.magnitude is not None and term.magnitude != NumberNode(1.0):
            found.append(self.notation.node(term.magnitude))
        if length and term.length is not None:
            found.append(self.notation.name(self.names[term.length]))
        return found

    def _conjugated(self, term: Term, length: bool) -> list[T]:
        """The conjugate of a genuinely complex factor, as numbers."""
        z = (term.value * term.sign).conjugate()
        write = self.notation
        imaginary = write.product([write.number(f"{abs(z.imag):.10g}"), write.imaginary])
        real = Signed(-1 if z.real < 0 else 1, write.number(f"{abs(z.real):.10g}"))
        parts = [real, Signed(-1 if z.imag < 0 else 1, imaginary)]
        found = [write.fenced(write.sum(parts))]
        if length and term.length is not None:
            found.append(self.notation.name(self.names[term.length]))
        return found

    def complex_form(
        self, term: Term, *, length: bool = True, factor_i: float = 0.0, conjugate: bool = False
    ) -> Signed[T]:
        """The term (or its derivative: times i·weight, or without its length) as a phasor.

        A quarter turn is written as the factor i.
        """
        quarter = abs(abs(term.turn) - math.pi / 2) < 1e-12
        sign = term.sign * (-1 if quarter and term.turn < 0 else 1)
        powers_of_i = int(quarter) + (1 if factor_i else 0)
        sign *= -1 if factor_i < 0 else 1
        if powers_of_i == 2:
            sign, powers_of_i = -sign, 0
        if conjugate and powers_of_i:
            sign = -sign
        factors = (
            [self.notation.number(f"{abs(factor_i):g}")] if abs(factor_i) not in (0.0, 1.0) else []
        )
        if powers_of_i:
            factors.append(self.notation.imaginary)
        if conjugate and self._complex_magnitude(term):
            factors += self._conjugated(term, length)
        else:
            factors += self._factors(term, length)
        angle = self.angle(term, -1 if conjugate else 1, with_turn=not quarter)
        if angle:
            factors.append(self.notation.phasor(angle))
        return Signed(sign, self.notation.product(factors))

    def real_form(
        self, term: Term, *, imaginary: bool, length: bool = True, weight: float | None = None
    ) -> list[Signed[T]]:
        """Real or imaginary part of the term, or with ``weight`` of its derivative by an angle."""
        wanted = "sin" if imaginary else "cos"
        sign = term.sign
        factors = []
        if weight is not None:
            # d cos = -sin, d sin = cos
            sign *= (1 if weight > 0 else -1) * (1 if wanted == "sin" else -1)
            wanted = "cos" if wanted == "sin" else "sin"
            factors += [] if abs(weight) == 1 else [self.notation.number(f"{abs(weight):g}")]
        quarter = abs(abs(term.turn) - math.pi / 2) < 1e-12
        if quarter:
            # cos(x ± 90°) = ∓sin x, sin(x ± 90°) = ±cos x
            up = 1 if term.turn > 0 else -1
            sign *= -up if wanted == "cos" else up
            wanted = "sin" if wanted == "cos" else "cos"
        if self._complex_magnitude(term):
            return self._split(term, wanted, sign, factors, length)
        angle = self.angle(term, with_turn=not quarter)
        factors += self._factors(term, length)
        if not angle:
            return [] if wanted == "sin" else [Signed(sign, self.notation.product(factors))]
        factors.append(self.notation.function(wanted, angle))
        return [Signed(sign, self.notation.product(factors))]

    def _complex_magnitude(self, term: Term) -> bool:
        plain = term.value * term.sign
        rotated = plain * complex(math.cos(term.turn), -math.sin(term.turn))
        return abs(rotated.imag) > 1e-12 * abs(rotated)

    def _split(
        self, term: Term, wanted: str, sign: int, factors: list[T], length: bool
    ) -> list[Signed[T]]:
        """(p + iq) e^{ix} has the parts p cos x - q sin x and p sin x + q cos x."""
        z = term.value * term.sign
        if wanted == "cos":
            pairs = ((z.real, "cos", 1), (z.imag, "sin", -1))
        else:
            pairs = ((z.real, "sin", 1), (z.imag, "cos", 1))
        angle = self.angle(term)
        found = []
        for number, function, s in pairs:
            if number == 0 or (not angle and function == "sin"):
                continue
            text = [*factors, self.notation.number(f"{abs(number):.10g}")]
            if length and term.length is not None:
                text.append(self.notation.name(self.names[term.length]))
            if angle:
                text.append(self.notation.function(function, angle))
            found.append(Signed(sign * s * (1 if number > 0 else -1), self.notation.product(text)))
        return found


# ----------------------------------------------------------------------
# Expansion of a complex formula into phasor terms.
#
# A formula such as ``-d1 - i*a1 + (a4 - b4)*e^(i*θ14)`` becomes a sum of monomials: a complex
# constant times at most one variable length times ``exp(i · linear combination of angles)``. The
# place of a name determines whether it is an angle or a length.


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
