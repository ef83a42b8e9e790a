"""The precedence of operators, which decides where parentheses are needed."""

from __future__ import annotations

from linkwork.expression.tree import Binary, Negative, Node, Number

__all__ = ["ATOM", "NEGATIVE", "STRENGTH", "strength"]

STRENGTH = {"+": 1, "-": 1, "*": 2, "/": 2, "^": 4}
NEGATIVE = 3
ATOM = 5


def strength(node: Node) -> int:
    """The strength of what a formula does last; a negative number is written with a sign."""
    match node:
        case Binary():
            return STRENGTH[node.operator]
        case Negative():
            return NEGATIVE
        case Number() if node.value < 0.0:
            return NEGATIVE
        case _:
            return ATOM
