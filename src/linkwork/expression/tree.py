"""The tree of a formula."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field, replace

__all__ = [
    "Binary",
    "Call",
    "Name",
    "Negative",
    "Node",
    "Number",
    "comparisons_in",
    "constants_in",
    "names_in",
    "with_comparisons",
]


@dataclass(frozen=True)
class Number:
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


Node = Number | Name | Negative | Binary | Call


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
        case Number():
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


def with_comparisons(node: Node, values: Mapping[Node, float]) -> Node:
    """The formula with some of its comparisons replaced by numbers."""
    if not values:
        return node
    if node in values:
        return Number(values[node])
    match node:
        case Negative():
            return replace(node, operand=with_comparisons(node.operand, values))
        case Binary():
            left = with_comparisons(node.left, values)
            return replace(node, left=left, right=with_comparisons(node.right, values))
        case Call():
            inner = tuple(with_comparisons(argument, values) for argument in node.arguments)
            return replace(node, arguments=inner)
        case _:
            return node
