"""Formulas as trees, and their text."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass, field, replace

from linkwork.core.foundation.names import latex_name, pretty

# ----------------------------------------------------------------------
# The tree of a formula.


@dataclass(frozen=True)
class NumberNode:
    """A literal number."""

    value: float
    column: int = field(default=1, compare=False)


@dataclass(frozen=True)
class Name:
    """A name in its canonical form; ``spelling`` is as written."""

    name: str
    spelling: str = field(default="", compare=False)
    column: int = field(default=1, compare=False)


@dataclass(frozen=True)
class Negative:
    """A negated expression."""

    operand: Node
    column: int = field(default=1, compare=False)


@dataclass(frozen=True)
class Binary:
    """``left operator right`` with one of ``+ - * / ^``, in some formulas ``< <= > >=``."""

    operator: str
    left: Node
    right: Node
    column: int = field(default=1, compare=False)


@dataclass(frozen=True)
class Call:
    """A function applied to arguments."""

    function: str
    arguments: tuple[Node, ...]
    column: int = field(default=1, compare=False)


Node = NumberNode | Name | Negative | Binary | Call


def names_in(node: Node) -> Iterator[Name]:
    """All names in reading order, repetitions included."""
    match node:
        case Name():
            yield node
        case Negative():
            yield from names_in(node.operand)
        case Binary():
            yield from names_in(node.left)
            yield from names_in(node.right)
        case Call():
            for argument in node.arguments:
                yield from names_in(argument)
        case NumberNode():
            return


def comparisons_in(node: Node) -> Iterator[Binary]:
    """All comparisons, inner ones first."""
    match node:
        case Negative():
            yield from comparisons_in(node.operand)
        case Binary():
            yield from comparisons_in(node.left)
            yield from comparisons_in(node.right)
            if node.operator in ("<", "<=", ">", ">="):
                yield node
        case Call():
            for argument in node.arguments:
                yield from comparisons_in(argument)
        case _:
            return


def constants_in(node: Node, known: Container[str]) -> Iterator[Node]:
    """The largest parts without comparisons whose names are all ``known``."""
    if not any(comparisons_in(node)) and all(name.name in known for name in names_in(node)):
        yield node
        return
    match node:
        case Negative():
            yield from constants_in(node.operand, known)
        case Binary():
            yield from constants_in(node.left, known)
            yield from constants_in(node.right, known)
        case Call():
            for argument in node.arguments:
                yield from constants_in(argument, known)
        case _:
            return


def _choice(call: Call) -> tuple[Binary, Node, Node] | None:
    """The comparison that a kink of a function follows, and its values where it holds or not."""
    zero, quarter = NumberNode(0.0), Call("atan2", (NumberNode(1.0), NumberNode(0.0)))
    match call.function, call.arguments:
        case "abs", (x,):
            return Binary(">=", x, zero), x, Negative(x)
        case "atan2", (y, x):  # each continues the angle beyond ± half a turn
            above = Binary("+", Call("atan2", (Negative(x), y)), quarter)
            below = Binary("-", Call("atan2", (x, Negative(y))), quarter)
            return Binary(">=", y, zero), above, below
        case "max" | "min", (*several, last):
            first = several[0] if len(several) == 1 else Call(call.function, tuple(several))
            operator = ">=" if call.function == "max" else "<="
            return Binary(operator, first, last), first, last
    return None


def switches_in(node: Node) -> Iterator[Binary]:
    """The comparisons at which a formula jumps or has a kink, inner ones first."""
    match node:
        case Negative():
            yield from switches_in(node.operand)
        case Binary():
            yield from switches_in(node.left)
            yield from switches_in(node.right)
            if node.operator in ("<", "<=", ">", ">="):
                yield node
        case Call():
            choice = _choice(node)
            for argument in (choice[0].left, choice[0].right) if choice else node.arguments:
                yield from switches_in(argument)
            if choice:
                if node.function == "atan2":
                    yield from switches_in(node.arguments[1])
                yield choice[0]


def with_switches(node: Node, values: Mapping[Node, float]) -> Node:
    """The formula with some of its comparisons replaced by numbers, and kinks by their pieces."""
    if not values:
        return node
    if node in values:
        return NumberNode(values[node])
    match node:
        case Negative():
            return replace(node, operand=with_switches(node.operand, values))
        case Binary():
            left = with_switches(node.left, values)
            return replace(node, left=left, right=with_switches(node.right, values))
        case Call():
            choice = _choice(node)
            if choice and choice[0] in values:
                return with_switches(choice[1] if values[choice[0]] else choice[2], values)
            inner = tuple(with_switches(argument, values) for argument in node.arguments)
            return replace(node, arguments=inner)
        case _:
            return node


# ----------------------------------------------------------------------
# The precedence of operators, which determines the parentheses.


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
        case NumberNode() if node.value < 0.0:
            return NEGATIVE
        case _:
            return ATOM


# ----------------------------------------------------------------------
# Print a formula as plain text or as LaTeX.


def number_text(value: float) -> str:
    """A short number without trailing zeros, exact to 12 digits."""
    shown = f"{value:.12g}"
    return shown[:-2] if shown.endswith(".0") else shown


def _spelled(node: Name) -> str:
    return pretty(node.spelling or node.name)


def text(node: Node, name: Callable[[Name], str] = _spelled) -> str:
    """Plain text that reads back to the same tree."""
    match node:
        case NumberNode():
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
        case NumberNode():
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
