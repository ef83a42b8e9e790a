"""MathML notation, which browsers display directly."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

from linkwork.equations.notation import Signed
from linkwork.expression.precedence import ATOM, NEGATIVE, STRENGTH, strength
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.expression.writing import number_text
from linkwork.foundation.names import pretty

__all__ = ["Markup", "MathML"]

_INVISIBLE_TIMES, _APPLY, _MINUS = "\u2062", "\u2061", "\u2212"


@dataclass(frozen=True)
class Markup:
    """A sequence of MathML elements; ``loose``: needs parentheses or grouping in a product."""

    xml: str
    loose: bool = False

    def element(self) -> str:
        """The sequence as a displayed equation."""
        return f'<math display="block">{self.xml}</math>'


class MathML:
    """``<msub><mi>a</mi><mn>2</mn></msub>…``."""

    imaginary = Markup("<mi>i</mi>")

    def name(self, name: str) -> Markup:
        """A variable or dimension."""
        shown = pretty(name)
        stem = shown.rstrip("0123456789'")
        index = shown[len(stem) :]
        primes = index.count("'") * "′"
        index = index.rstrip("'")
        head, _, tail = stem.partition("_")
        base = f"<mi>{escape(head or stem)}</mi>"
        below = [f"<mi>{escape(tail)}</mi>"] if tail and head else []
        below += [f"<mn>{index}</mn>"] if index else []
        if below:
            base = f"<msub>{base}<mrow>{'<mo>,</mo>'.join(below)}</mrow></msub>"
        return Markup(f"<msup>{base}<mo>{primes}</mo></msup>" if primes else base)

    def number(self, text: str) -> Markup:
        """A number as its digits."""
        digits = text.removeprefix("-")
        sign = _operator("-") if digits != text else ""
        return Markup(f"{sign}<mn>{digits}</mn>", loose=True)

    def formula(self, node: Node) -> Markup:
        """A complete formula."""
        match node:
            case Number():
                return self.number(number_text(node.value))
            case Name():
                return self.name(node.spelling or node.name)
            case Negative():
                inside = self._inside(node.operand, NEGATIVE)
                return Markup(f"{_operator('-')}{inside.xml}", loose=True)
            case Call("sqrt"):
                return Markup(f"<msqrt>{self.formula(node.arguments[0]).xml}</msqrt>")
            case Call():
                shown = _operator(",").join(self.formula(a).xml for a in node.arguments)
                return self._apply(f"<mi>{node.function}</mi>", self.fenced(Markup(shown)))
            case Binary("/"):
                above, below = self.formula(node.left), self.formula(node.right)
                return Markup(f"<mfrac>{_row(above)}{_row(below)}</mfrac>")
            case Binary("^"):
                base, power = self._inside(node.left, ATOM), self.formula(node.right)
                return Markup(f"<msup>{_row(base)}{_row(power)}</msup>")
            case Binary():
                own = STRENGTH[node.operator]
                left, right = self._inside(node.left, own), self._inside(node.right, own + 1)
                if node.operator == "*":
                    return self.product([left, right])
                return Markup(f"{left.xml}{_operator(node.operator)}{right.xml}", loose=True)

    def _inside(self, node: Node, least: int) -> Markup:
        shown = self.formula(node)
        return self.fenced(shown) if strength(node) < least else shown

    def node(self, node: Node) -> Markup:
        """A formula as one factor of a product."""
        shown = self.formula(node)
        loose = isinstance(node, Binary) and node.operator in "+-"
        return self.fenced(shown) if loose or isinstance(node, Negative) else Markup(_row(shown))

    def degrees(self, radians: float) -> Markup:
        """A fixed angle."""
        return Markup(f"<mn>{number_text(round(math.degrees(radians), 6))}°</mn>")

    def phasor(self, angle: Sequence[Signed[Markup]]) -> Markup:
        """e to the i times an angle."""
        sign = ""
        if len(angle) == 1 and angle[0].sign < 0:
            sign, angle = _operator("-"), [Signed(1, angle[0].product)]
        return Markup(
            f"<msup><mi>e</mi><mrow>{sign}<mi>i</mi>{self._fitted(angle).xml}</mrow></msup>"
        )

    def function(self, name: str, angle: Sequence[Signed[Markup]]) -> Markup:
        """cos or sin of an angle."""
        return self._apply(f"<mi>{name}</mi>", self._fitted(angle))

    def law(self, name: str, primes: int, argument: Markup) -> Markup:
        """A named function, or a derivative of it."""
        return self._apply(self.name(name + primes * "'").xml, self.fenced(argument))

    def weighted(self, weight: str, name: Markup) -> Markup:
        """A number directly before a name."""
        return Markup(f"<mn>{weight}</mn>{name.xml}", loose=True)

    def product(self, factors: Sequence[Markup]) -> Markup:
        """Factors in a row; 1 if there are none."""
        if not factors:
            return self.number("1")
        shown = (_row(factor) if factor.loose else factor.xml for factor in factors)
        return Markup(_operator(_INVISIBLE_TIMES).join(shown))

    def sum(self, terms: Iterable[Signed[Markup]]) -> Markup:
        """Signed products in a row; 0 if there are none."""
        shown = ""
        for term in terms:
            sign = _operator("-") if term.sign < 0 else _operator("+") if shown else ""
            shown += f"{sign}{term.product.xml}"
        return Markup(shown, loose=True) if shown else self.number("0")

    def fenced(self, inside: Markup) -> Markup:
        """In parentheses."""
        return Markup(f"<mrow><mo>(</mo>{inside.xml}<mo>)</mo></mrow>")

    def equation(self, left: Markup, right: Markup) -> Markup:
        """Both sides of an equation."""
        return Markup(f"{left.xml}{_operator('=')}{right.xml}", loose=True)

    def _fitted(self, angle: Sequence[Signed[Markup]]) -> Markup:
        """An angle as an argument: in parentheses if it has a sign or several terms."""
        shown = self.sum(angle)
        return self.fenced(shown) if len(angle) > 1 or angle[0].sign < 0 else shown

    def _apply(self, function: str, argument: Markup) -> Markup:
        return Markup(f"<mrow>{function}{_operator(_APPLY)}{argument.xml}</mrow>")


def _row(inside: Markup) -> str:
    return f"<mrow>{inside.xml}</mrow>"


def _operator(sign: str) -> str:
    shown = _MINUS if sign == "-" else sign
    return f"<mo>{shown}</mo>"
