"""Two notations for the same equations: plain text for a terminal, LaTeX for a page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from linkwork.expression import writing
from linkwork.expression.tree import Node
from linkwork.foundation.names import latex_name, pretty

__all__ = ["Latex", "Notation", "PlainText", "Signed"]

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
        return writing.text(node, lambda n: pretty(n.spelling or n.name)).replace("*", "·")

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""
        shown = self.formula(node)
        return f"({shown})" if " " in shown else shown

    def degrees(self, radians: float) -> str:
        """A fixed angle."""
        return f"{writing.number_text(round(math.degrees(radians), 6))}°"

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
        return writing.latex(node)

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""
        shown = writing.latex(node)
        return rf"\left({shown}\right)" if " + " in shown or " - " in shown else shown

    def degrees(self, radians: float) -> str:
        """A fixed angle."""
        return rf"{writing.number_text(round(math.degrees(radians), 6))}^\circ"

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
