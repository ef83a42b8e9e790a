"""The precedence of operators, which determines the parentheses."""

from __future__ import annotations

from linkwork.expression.tree import Binary, Negative, Node, Number

__all__ = ["ATOM", "COMPARISONS", "NEGATIVE", "STRENGTH", "strength"]

COMPARISONS = ("<", "<=", ">", ">=")
STRENGTH = {**dict.fromkeys(COMPARISONS, 0), "+": 1, "-": 1, "*": 2, "/": 2, "^": 4}
NEGATIVE = 3
ATOM = 5


def strength(node: Node) -> int:
    """The precedence of a formula's outermost operation; negative numbers count as signed."""
    match node:
        case Binary():
            return STRENGTH[node.operator]
        case Negative():
            return NEGATIVE
        case Number() if node.value < 0.0:
            return NEGATIVE
        case _:
            return ATOM
