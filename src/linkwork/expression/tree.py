"""The tree of a formula."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

__all__ = ["Binary", "Call", "Name", "Negative", "Node", "Number", "names_in"]


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
