"""Two notations for the same equations: plain text for a terminal, LaTeX for a page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from linkwork.core.equations.model import Term
from linkwork.core.expression.tree import Node, NumberNode, latex, number_text, text as writing_text
from linkwork.core.foundation.names import latex_name, pretty

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
