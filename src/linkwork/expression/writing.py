"""Print a formula as plain text or as LaTeX."""

from __future__ import annotations

from collections.abc import Callable

from linkwork.expression.precedence import ATOM, NEGATIVE, STRENGTH, strength
from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.foundation.names import latex_name, pretty

__all__ = ["latex", "number_text", "text"]


def number_text(value: float) -> str:
    """A short number without trailing zeros, exact to 12 digits."""
    shown = f"{value:.12g}"
    return shown[:-2] if shown.endswith(".0") else shown


def _spelled(node: Name) -> str:
    return pretty(node.spelling or node.name)


def text(node: Node, name: Callable[[Name], str] = _spelled) -> str:
    """Plain text that reads back to the same tree."""
    match node:
        case Number():
            return number_text(node.value)
        case Name():
            return name(node)
        case Negative():
            return "-" + _inside(node.operand, NEGATIVE, name)
        case Call():
            return f"{node.function}({', '.join(text(a, name) for a in node.arguments)})"
        case Binary():
            own = STRENGTH[node.operator]
            left = _inside(node.left, own + (node.operator == "^"), name)
            right = _inside(node.right, own + (node.operator != "^"), name)
            space = " " if node.operator in "+-" else ""
            return f"{left}{space}{node.operator}{space}{right}"


def _inside(node: Node, least: int, name: Callable[[Name], str]) -> str:
    shown = text(node, name)
    return f"({shown})" if strength(node) < least else shown


def latex(node: Node) -> str:
    """The formula for LaTeX's mathematics."""
    match node:
        case Number():
            return number_text(node.value)
        case Name():
            return latex_name(node.name)
        case Negative():
            return "-" + _latex_inside(node.operand, 2)
        case Call("sqrt"):
            return rf"\sqrt{{{latex(node.arguments[0])}}}"
        case Call("abs"):
            return rf"\left|{latex(node.arguments[0])}\right|"
        case Call():
            known = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "log10": "log_{10}"}
            shown = known.get(node.function, node.function)
            head = (
                rf"\operatorname{{{shown}}}" if shown in ("atan2", "hypot", "cis") else "\\" + shown
            )
            arguments = ", ".join(map(latex, node.arguments))
            return rf"{head}\left({arguments}\right)"
        case Binary("/"):
            return rf"\frac{{{latex(node.left)}}}{{{latex(node.right)}}}"
        case Binary("^"):
            return f"{_latex_inside(node.left, ATOM)}^{{{latex(node.right)}}}"
        case Binary():
            own = STRENGTH[node.operator]
            sign = r" \, " if node.operator == "*" else f" {node.operator} "
            return f"{_latex_inside(node.left, own)}{sign}{_latex_inside(node.right, own + 1)}"


def _latex_inside(node: Node, least: int) -> str:
    shown = latex(node)
    return rf"\left({shown}\right)" if strength(node) < least else shown
