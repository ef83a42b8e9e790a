"""Formulas with real values only."""

from __future__ import annotations

from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.foundation.errors import ExpressionError

__all__ = ["check_real"]

_COMPLEX_ONLY = ("cis",)


def check_real(tree: Node, text: str, noun: str) -> None:
    """Refuse functions with complex values; ``noun`` is what the formula gives: ``an output``.

    Raises
    ------
    ExpressionError
        With the function and its column in ``text``.
    """
    match tree:
        case Call() if tree.function in _COMPLEX_ONLY:
            raise ExpressionError(
                f"column {tree.column}: {tree.function} is complex, {noun} is a real number",
                text,
                tree.column,
            )
        case Call():
            for argument in tree.arguments:
                check_real(argument, text, noun)
        case Binary():
            check_real(tree.left, text, noun)
            check_real(tree.right, text, noun)
        case Negative():
            check_real(tree.operand, text, noun)
        case Name() | Number():
            return
