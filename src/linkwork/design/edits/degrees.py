"""Find which numbers of formulas are lengths and angles, from how formulas combine them.

A length has degree (1, 0), an angle (0, 1), an area (2, 0), a ratio (0, 0). Sums require equal
degrees, products add them: linear equations for the degrees of all names and literal numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from linkwork.core.expression.grammar import CONSTANTS
from linkwork.core.expression.tree import Binary, Call, Name, Negative, Node, NumberNode, names_in
from linkwork.core.expression.values import value
from linkwork.core.foundation.containers import FrozenDict
from linkwork.core.foundation.errors import ExpressionError, InputError
from linkwork.core.foundation.units import AngleUnit

_ANGLE_OF = ("sin", "cos", "tan", "cis")
_TO_ANGLE = ("asin", "acos", "atan")
_ALIKE = ("abs", "hypot", "min", "max", "atan2")


@dataclass(frozen=True)
class Literal:
    """A literal number, or a constant such as pi, in the formula at a place of the file."""

    where: str
    column: int
    constant: bool = field(default=False, compare=False)


@dataclass(frozen=True)
class Degree:
    """A degree in length and in angle, as far as known, plus multiples of unknown degrees."""

    length: Fraction = Fraction(0)
    angle: Fraction = Fraction(0)
    rest: Mapping[str | Literal, Fraction] = FrozenDict()

    def plus(self, other: Degree, times: Fraction | int = 1) -> Degree:
        rest = dict(self.rest)
        for unknown, factor in other.rest.items():
            rest[unknown] = rest.get(unknown, Fraction(0)) + factor * times
        return Degree(
            self.length + other.length * times,
            self.angle + other.angle * times,
            {unknown: factor for unknown, factor in rest.items() if factor},
        )


PURE, LENGTH, ANGLE = Degree(), Degree(Fraction(1)), Degree(Fraction(0), Fraction(1))


class Degrees:
    """The degrees of names and literal numbers, as far as formulas determine them."""

    def __init__(self) -> None:
        self._known: dict[str | Literal, Degree] = {}
        self._literals: dict[str, list[Literal]] = {}
        self._names: dict[str, None] = {}

    @property
    def names(self) -> list[str]:
        """All names in formulas."""
        return list(self._names)

    def literals(self, where: str) -> list[Literal]:
        """The literal numbers of the formula at a place, in their order."""
        return self._literals.get(where, [])

    def resolved(self, degree: Degree) -> Degree:
        """A degree with all that is known about unknown ones."""
        while (unknown := next((u for u in degree.rest if u in self._known), None)) is not None:
            factor = degree.rest[unknown]
            rest = {u: f for u, f in degree.rest.items() if u != unknown}
            degree = Degree(degree.length, degree.angle, rest).plus(self._known[unknown], factor)
        return degree

    def of(self, unknown: str | Literal) -> Degree | None:
        """The degree of a name or literal number; ``None`` if it is not determined."""
        degree = self.resolved(Degree(rest={unknown: Fraction(1)}))
        return None if degree.rest else degree

    def add(self, where: str, tree: Node, degree: Degree | None = None) -> Degree:
        """Add the formula at a place of the file, with its degree if it is known.

        Raises
        ------
        InputError
            If the formula mixes lengths, angles and plain numbers.
        """
        of_tree = self._of(tree, where)
        return of_tree if degree is None else self.equate(of_tree, degree, where)

    def name(self, name: str) -> Degree:
        """The degree of a name, known or not."""
        self._names[name] = None
        return Degree(rest={name: Fraction(1)})

    def equate(self, one: Degree, other: Degree, where: str) -> Degree:
        """Two degrees are the same; raises like :meth:`add`."""
        gap = self.resolved(one.plus(other, -1))
        if not gap.rest:
            if gap != PURE:
                raise InputError(
                    f"{where} mixes lengths, angles and plain numbers: it cannot be converted"
                )
            return one
        unknown, factor = list(gap.rest.items())[-1]
        self._known[unknown] = PURE.plus(
            Degree(gap.length, gap.angle, {u: f for u, f in gap.rest.items() if u != unknown}),
            -1 / factor,
        )
        return one

    def settle(self) -> None:
        """Make literal numbers that are only factors plain numbers: 2 in ``2*a``."""
        # constants last: pi in pi/2 is the angle
        every = [literal for literals in self._literals.values() for literal in literals]
        for literal in sorted(every, key=lambda one: one.constant):
            degree = self.resolved(Degree(rest={literal: Fraction(1)}))
            if degree.rest:
                self.equate(degree, PURE, "")

    def _literal(self, where: str, column: int, constant: bool = False) -> Degree:
        literal = Literal(where, column, constant)
        self._literals.setdefault(where, []).append(literal)
        return Degree(rest={literal: Fraction(1)})

    def _of(self, node: Node, where: str) -> Degree:
        match node:
            case NumberNode():
                return self._literal(where, node.column)
            case Name("i"):
                return PURE
            case Name(name) if name in CONSTANTS:
                return self._literal(where, node.column, constant=True)
            case Name(name):
                return self.name(name)
            case Negative():
                return self._of(node.operand, where)
            case Binary("^"):
                return self._power(node, where)
            case Binary("*" | "/"):
                sign = 1 if node.operator == "*" else -1
                return self._of(node.left, where).plus(self._of(node.right, where), sign)
            case Binary():
                left = self._of(node.left, where)
                return self.equate(left, self._of(node.right, where), where)
            case Call():
                return self._call(node, where)

    def _power(self, node: Binary, where: str) -> Degree:
        exponent = self._of(node.right, where)
        turned = any(name.name == "i" for name in names_in(node.right))
        if node.left == Name("e") and turned:
            self.equate(exponent, ANGLE, where)  # e^(i*theta)
            return PURE
        self.equate(exponent, PURE, where)
        base = self._of(node.left, where)
        try:
            times = Fraction(value(node.right, {}, AngleUnit.RADIAN)).limit_denominator(1000)
        except ExpressionError:  # the exponent contains names
            self.equate(base, PURE, where)
            return PURE
        return PURE.plus(base, times)

    def _call(self, node: Call, where: str) -> Degree:
        first, *others = (self._of(argument, where) for argument in node.arguments)
        if node.function in _ALIKE:
            for other in others:
                self.equate(first, other, where)
            return ANGLE if node.function == "atan2" else first
        if node.function == "sqrt":
            return PURE.plus(first, Fraction(1, 2))
        self.equate(first, ANGLE if node.function in _ANGLE_OF else PURE, where)
        return ANGLE if node.function in _TO_ANGLE else PURE
