"""Two notations for the same equations: plain text for a terminal, LaTeX for a page."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from linkwork.expression import writing
from linkwork.expression.tree import Node
from linkwork.foundation.names import latex_name, pretty

__all__ = ["Latex", "Notation", "PlainText"]


class Notation(Protocol):
    """How names, phasors and products are written."""

    zero: str
    imaginary: str

    def name(self, name: str) -> str:
        """A variable or dimension."""

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""

    def formula(self, node: Node) -> str:
        """A formula on its own."""

    def degrees(self, radians: float) -> str:
        """A fixed angle."""

    def phasor(self, angle: str) -> str:
        """e to the i times an angle."""

    def function(self, name: str, angle: str) -> str:
        """cos or sin of an angle."""

    def law(self, name: str, primes: int, argument: str) -> str:
        """A named function, or a derivative of it."""

    def product(self, factors: Sequence[str]) -> str:
        """Factors in a row."""


def _compound(angle: str) -> bool:
    return " " in angle or "·" in angle or angle.startswith("-")


class PlainText:
    """``a2·e^(iθ12)``."""

    zero = "0"
    imaginary = "i"

    def name(self, name: str) -> str:
        """A variable or dimension."""
        return pretty(name)

    def formula(self, node: Node) -> str:
        """A formula on its own."""
        return writing.text(node, lambda n: pretty(n.spelling or n.name)).replace("*", "·")

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""
        shown = self.formula(node)
        return f"({shown})" if " " in shown else shown

    def degrees(self, radians: float) -> str:
        """A fixed angle."""
        return f"{writing.number_text(round(math.degrees(radians), 6))}°"

    def phasor(self, angle: str) -> str:
        """e to the i times an angle."""
        if angle.startswith("-") and " " not in angle:
            return f"e^(-i{angle[1:]})"
        return f"e^(i({angle}))" if _compound(angle) else f"e^(i{angle})"

    def function(self, name: str, angle: str) -> str:
        """cos or sin of an angle."""
        return f"{name}({angle})" if _compound(angle) else f"{name} {angle}"

    def law(self, name: str, primes: int, argument: str) -> str:
        """A named function, or a derivative of it."""
        return f"{pretty(name)}{primes * chr(39)}({argument})"

    def product(self, factors: Sequence[str]) -> str:
        """Factors in a row."""
        return "·".join(factors)


class Latex:
    r"""``a_2 e^{i\theta_{12}}``."""

    zero = "0"
    imaginary = "i"

    def name(self, name: str) -> str:
        """A variable or dimension."""
        return latex_name(name)

    def formula(self, node: Node) -> str:
        """A formula on its own."""
        return writing.latex(node)

    def node(self, node: Node) -> str:
        """A formula as one factor of a product."""
        shown = writing.latex(node)
        return rf"\left({shown}\right)" if " + " in shown or " - " in shown else shown

    def degrees(self, radians: float) -> str:
        """A fixed angle."""
        return rf"{writing.number_text(round(math.degrees(radians), 6))}^\circ"

    def phasor(self, angle: str) -> str:
        """e to the i times an angle."""
        if angle.startswith("-") and " " not in angle:
            return f"e^{{-i{angle[1:]}}}"
        return f"e^{{i({angle})}}" if _compound(angle) else f"e^{{i{angle}}}"

    def function(self, name: str, angle: str) -> str:
        """cos or sin of an angle."""
        return rf"\{name}({angle})" if _compound(angle) else rf"\{name} {angle}"

    def law(self, name: str, primes: int, argument: str) -> str:
        """A named function, or a derivative of it."""
        shown = latex_name(name)
        if primes:
            shown = f"{{{shown}}}{primes * chr(39)}"
        return rf"{shown}\left({argument}\right)"

    def product(self, factors: Sequence[str]) -> str:
        """Factors in a row."""
        return r" \, ".join(factors)
