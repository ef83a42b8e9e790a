"""A third notation: MathML, which browsers set without any help."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from html import escape

from linkwork.expression.precedence import ATOM, NEGATIVE, STRENGTH, strength
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.expression.writing import number_text
from linkwork.foundation.names import pretty

__all__ = ["MathML", "math_element"]

_PIECES = re.compile(r"<[^>]+>|[^<]+")
_TOKENS = re.compile(r"\d+(?:\.\d+)?(?:e[-+]?\d+)?|\w+|\S")
_INVISIBLE_TIMES, _APPLY, _MINUS = "\u2062", "\u2061", "\u2212"


def math_element(text: str) -> str:
    """A row of MathML as an element of a page."""
    return f'<math display="block">{_row(text)}</math>'


class MathML:
    """``<msub><mi>a</mi><mn>2</mn></msub>…``: elements without spaces, signs between them plain."""

    zero = "0"
    imaginary = "<mi>i</mi>"

    def name(self, name: str) -> str:
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
        return f"<msup>{base}<mo>{primes}</mo></msup>" if primes else base

    def formula(self, node: Node) -> str:
        """A formula on its own."""
        return self._write(node)

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""
        shown = self._write(node)
        loose = isinstance(node, Binary) and node.operator in "+-"
        return _fence(shown) if loose or isinstance(node, Negative) else _group(shown)

    def degrees(self, radians: float) -> str:
        """A fixed angle."""
        return f"<mn>{number_text(round(math.degrees(radians), 6))}°</mn>"

    def phasor(self, angle: str) -> str:
        """e to the i times an angle."""
        negative = angle.startswith("-") and " " not in angle
        turned = angle[1:] if negative else angle
        inside = _fence(turned) if " " in turned or turned.startswith("-") else _row(turned)
        sign = f"<mo>{_MINUS}</mo>" if negative else ""
        return f"<msup><mi>e</mi><mrow>{sign}<mi>i</mi>{inside}</mrow></msup>"

    def function(self, name: str, angle: str) -> str:
        """cos or sin of an angle."""
        compound = " " in angle or angle.startswith("-")
        inside = _fence(angle) if compound else _row(angle)
        return _group(f"<mi>{name}</mi><mo>{_APPLY}</mo>{inside}")

    def law(self, name: str, primes: int, argument: str) -> str:
        """A named function, or a derivative of it."""
        return _group(f"{self.name(name + primes * chr(39))}<mo>{_APPLY}</mo>{_fence(argument)}")

    def product(self, factors: Sequence[str]) -> str:
        """Factors in a row."""
        return f"<mo>{_INVISIBLE_TIMES}</mo>".join(map(_whole, factors))

    def _write(self, node: Node) -> str:
        match node:
            case Number():
                return number_text(node.value)
            case Name():
                return self.name(node.spelling or node.name)
            case Negative():
                return f"-{self._inside(node.operand, NEGATIVE)}"
            case Call("sqrt"):
                return f"<msqrt>{_row(self._write(node.arguments[0]))}</msqrt>"
            case Call():
                inside = "<mo>,</mo>".join(_row(self._write(a)) for a in node.arguments)
                return _group(f"<mi>{node.function}</mi><mo>{_APPLY}</mo>{_fence(inside)}")
            case Binary("/"):
                above, below = (_row(self._write(part)) for part in (node.left, node.right))
                return f"<mfrac><mrow>{above}</mrow><mrow>{below}</mrow></mfrac>"
            case Binary("^"):
                raised = _row(self._write(node.right))
                return f"<msup>{_group(self._inside(node.left, ATOM))}<mrow>{raised}</mrow></msup>"
            case Binary():
                own = STRENGTH[node.operator]
                left, right = self._inside(node.left, own), self._inside(node.right, own + 1)
                if node.operator == "*":
                    return self.product([left, right])
                return f"{left} {node.operator} {right}"

    def _inside(self, node: Node, least: int) -> str:
        shown = self._write(node)
        return _fence(shown) if strength(node) < least else shown


def _whole(factor: str) -> str:
    """A factor that begins with a sign, or is a sum, as one element."""
    return factor if factor.startswith("<") and " " not in factor else _group(factor)


def _group(text: str) -> str:
    return f"<mrow>{_row(text)}</mrow>"


def _fence(text: str) -> str:
    return f"<mrow><mo>(</mo>{_row(text)}<mo>)</mo></mrow>"


def _row(text: str) -> str:
    """Signs and numbers between elements as elements."""
    shown, depth = [], 0
    for piece in _PIECES.findall(text):
        if piece.startswith("<"):
            depth += -1 if piece.startswith("</") else 1
            shown.append(piece)
        else:
            shown.append(piece if depth else "".join(map(_token, _TOKENS.findall(piece))))
    return "".join(shown)


def _token(token: str) -> str:
    if token[0].isdigit():
        return f"<mn>{token}</mn>"
    if token[0].isalpha():
        return f"<mi>{escape(token)}</mi>"
    return f"<mo>{_MINUS if token == '-' else escape(token)}</mo>"
