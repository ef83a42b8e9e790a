"""Real numbers with formulas: sums of weighted terms, simplified as they are built.

A term is a formula without a numerical factor. Functions use radians; ``radians`` and ``degrees``
are functions too, because cells contain angles in the file's unit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from linkwork.expression.tree import Binary, Call, Name, Negative, Node, Number
from linkwork.foundation.operand import Arithmetic, Operand

__all__ = ["LinearForm", "call", "cosine", "sine"]

_DEGREE = math.pi / 180.0
_SHORT = 1e-13  # relative: nearer factors are rounded to a short number


class _FormArithmetic(Arithmetic["LinearForm"]):
    """Takes numbers out of products, and common factors out of quotients."""

    def plain(self, number: float) -> LinearForm:
        """A number."""
        return LinearForm(number)

    def add(self, x: LinearForm, y: LinearForm) -> LinearForm:
        """x + y, like terms joined."""
        weights = dict(x.terms)
        for node, weight in y.terms:
            weights[node] = weights.get(node, 0.0) + weight
        kept = tuple((node, weight) for node, weight in weights.items() if weight)
        return LinearForm(x.constant + y.constant, kept)

    def negate(self, x: LinearForm) -> LinearForm:
        """-x."""
        return _weigh(x, -1.0)

    def multiply(self, x: LinearForm, y: LinearForm) -> LinearForm:
        """x y."""
        if y.fixed:
            return _weigh(x, y.constant)
        if x.fixed:
            return _weigh(y, x.constant)
        (left, one), (right, other) = _factored(x), _factored(y)
        node = Binary("^", left, Number(2.0)) if left == right else Binary("*", left, right)
        return _weigh(LinearForm.of(node), one * other)

    def divide(self, x: LinearForm, y: LinearForm) -> LinearForm:
        """x / y."""
        if y.fixed:
            return _weigh(x, 1.0 / y.constant)
        if x.zero:
            return x
        below, weight = _factored(y)
        reduced = [_without(node, below) for node, _ in x.terms]
        if not x.constant and None not in reduced:
            parts = zip(reduced, x.terms, strict=True)
            return sum(
                (_weigh(form, own / weight) for form, (_, own) in parts if form is not None),
                LinearForm(),
            )
        above, own = _factored(x)
        return _weigh(LinearForm.of(Binary("/", above, below)), own / weight)


@dataclass(frozen=True)
class LinearForm(Operand):
    """``Σ weight · term + constant``; terms differ and no weight is 0."""

    arithmetic = _FormArithmetic()
    constant: float = 0.0
    terms: tuple[tuple[Node, float], ...] = ()

    @classmethod
    def of(cls, node: Node) -> LinearForm:
        """A form with one term."""
        return cls(0.0, ((node, 1.0),))

    @classmethod
    def named(cls, name: str) -> LinearForm:
        """A form with the value of a cell, by key."""
        return cls.of(Name(name))

    @property
    def fixed(self) -> bool:
        """Whether it is a constant."""
        return not self.terms

    @property
    def zero(self) -> bool:
        """Whether it is the number 0."""
        return not self.terms and self.constant == 0.0

    @property
    def single(self) -> tuple[Node, float] | None:
        """Its only term with its weight; ``None`` for a sum and for a number."""
        return self.terms[0] if len(self.terms) == 1 and self.constant == 0.0 else None

    @property
    def node(self) -> Node:
        """The formula, a positive term first if there is one."""
        ordered = sorted(self.terms, key=lambda part: part[1] < 0.0)
        parts = [(weight < 0.0, _weighted(node, abs(weight))) for node, weight in ordered]
        if self.constant or not parts:
            constant = (self.constant < 0.0, Number(abs(self.constant)))
            first = bool(parts) and parts[0][0] and not constant[0]
            parts = [constant, *parts] if first else [*parts, constant]
        minus, found = parts[0]
        found = Negative(found) if minus else found
        for minus, part in parts[1:]:
            found = Binary("-" if minus else "+", found, part)
        return found

    def per(self, unit: float) -> LinearForm | None:
        """The form with all numbers divided by a unit, if the results are short numbers."""
        weights = [_short(weight / unit) for _, weight in self.terms]
        constant = _short(self.constant / unit)
        if constant is None or None in weights:
            return None
        nodes = (node for node, _ in self.terms)
        kept = ((n, w) for n, w in zip(nodes, weights, strict=True) if w is not None)
        return LinearForm(constant, tuple(kept))

    @property
    def angle(self) -> Node:
        """The formula of an angle in radians; ``radians(…)`` if it is shorter in degrees."""
        turned = self.per(1.0 / _DEGREE)
        if turned is not None and not self.fixed:
            return Call("degrees", (turned.node,))
        in_degrees = [(n, d) for n, w in self.terms if (d := _short(w / _DEGREE)) is not None]
        if not in_degrees:
            return self.node
        rest = tuple((n, w) for n, w in self.terms if _short(w / _DEGREE) is None)
        constant = _short(self.constant / _DEGREE)
        in_file_unit = LinearForm(constant or 0.0, tuple(in_degrees))
        own = LinearForm.of(Call("radians", (in_file_unit.node,)))
        return (own + LinearForm(self.constant if constant is None else 0.0, rest)).node

    @property
    def in_degrees(self) -> Node:
        """The formula in degrees of an angle in radians."""
        in_file_unit = self.per(_DEGREE)
        return Call("degrees", (self.angle,)) if in_file_unit is None else in_file_unit.node


def _weigh(form: LinearForm, factor: float) -> LinearForm:
    if factor == 0.0:
        return LinearForm()
    scaled = tuple((node, weight * factor) for node, weight in form.terms)
    return LinearForm(form.constant * factor, scaled)


def _weighted(node: Node, weight: float) -> Node:
    return node if weight == 1.0 else Binary("*", Number(weight), node)


def _short(number: float) -> float | None:
    near = float(f"{number:.9g}")
    return near if abs(number - near) <= _SHORT * abs(number) else None


def _factored(form: LinearForm) -> tuple[Node, float]:
    return form.single or (form.node, 1.0)


def _without(node: Node, factor: Node) -> LinearForm | None:
    """A term without a factor; ``None`` if it does not contain the factor."""
    if node == factor:
        return LinearForm(1.0)
    match node:
        case Binary("*"):
            for own, other in ((node.left, node.right), (node.right, node.left)):
                if own == factor:
                    return LinearForm.of(other)
        case Binary("^") if node.left == factor and node.right == Number(2.0):
            return LinearForm.of(factor)
    return None


def call(function: str, *arguments: LinearForm) -> LinearForm:
    """A function of forms."""
    return LinearForm.of(Call(function, tuple(argument.node for argument in arguments)))


def cosine(angle: LinearForm) -> LinearForm:
    """cos of an angle in radians."""
    if angle.fixed:
        return LinearForm(math.cos(angle.constant))
    return LinearForm.of(Call("cos", (angle.angle,)))


def sine(angle: LinearForm) -> LinearForm:
    """sin of an angle in radians."""
    if angle.fixed:
        return LinearForm(math.sin(angle.constant))
    return LinearForm.of(Call("sin", (angle.angle,)))
